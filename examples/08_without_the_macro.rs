//! What `model!` writes, written by hand: one struct and one generic method.
//! Both are the same model, to the last bit.

use couloir::prelude::*;
use couloir::prior::{Gamma, InverseGamma};

// 2. The model, twice.
model! {
    struct Macro { event: Event }

    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 2.0) };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

struct Hand {
    event: Event,
}

impl Program for Hand {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mu = Label::new("mu", "1");
        let mu = run.scalar(mu, Gamma::new(9.0, 0.03))?;
        let sigma2 = Label::new("sigma2", "value2");
        let sigma2 = run.scalar(sigma2, InverseGamma::new(3.0, 2.0))?;
        let friction = run.declare(Coulomb { mu });
        let errors = run.declare(Iid { sigma2 });
        let flow = self.event.slide(&friction)?;
        run.observe(&self.event.velocity, flow.velocity(), &errors)
    }
}

fn main() -> Result<()> {
    // 1. The data: synthetic, mu = 0.3 and errors of 1 m/s.
    let times = (1..=15).map(f64::from).collect();
    let series = Series::velocity(times, vec![0.0; 15])?;
    let track = Track::incline(35.0, 1000.0)?;
    let plan = Event::on(track).velocity(series).build()?;
    let seen = simulate(&Macro::new(plan.clone()), &[0.3, 1.0], Seed::new(4))?;
    let event = plan.with_recording(seen[0].clone())?;

    // 3. The inference, of either.
    let explore = |model: &dyn Model| {
        let posterior = Posterior::new(model)?;
        let backend = MetropolisHastings::default();
        infer(&backend, &posterior, Seed::new(1), &Quiet)
    };
    let by_macro = explore(&Macro::new(event.clone()))?;
    let by_hand = explore(&Hand { event })?;

    // 4. The result.
    println!("{by_hand}\nthe same draws: {}", by_macro.draws == by_hand.draws);
    Ok(())
}
