//! Are the errors independent, or does one follow from the one before? The
//! paper's question, on a synthetic series with a known answer.

use couloir::prelude::*;

// 2. The models: M0 and M1 of Heredia et al. (2020).
model! {
    struct Independent { event: Event }

    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

model! {
    struct Correlated { event: Event }

    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Ar { phi: [Uniform(-1.0, 1.0)], sigma2: InverseGamma(3.0, 20.0) };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() -> Result<()> {
    // 1. The data: synthetic, made with errors that are correlated.
    let track = Track::from_points(&[0.0, 250.0, 900.0], &[600.0, 400.0, 0.0]);
    let times: Vec<f64> = (1..=40).map(|i| 0.75 * f64::from(i)).collect();
    let plan = Event::on(track?)
        .depth(2.19)
        .velocity(Series::velocity(times, vec![0.0; 40])?)
        .build()?;
    let truth = [0.32, 496.0, 0.65, 8.07];
    let seen = simulate(&Correlated::new(plan.clone()), &truth, Seed::new(5))?;
    let event = plan.with_recording(seen[0].clone())?;

    // 3. The inference: sequential Monte Carlo, with the evidence.
    let explore = |model: &dyn Model| {
        let posterior = Posterior::new(model)?;
        infer(&Smc::default(), &posterior, Seed::new(1), &Quiet)
    };
    let independent = explore(&Independent::new(event.clone()))?;
    let correlated = explore(&Correlated::new(event))?;

    // 4. The result: what ignores the correlation is too sure of mu and xi.
    println!("true: mu 0.32, xi 496, phi 0.65, sigma2 8.07\n");
    println!("independent\n{independent}\nAR(1)\n{correlated}");
    Ok(())
}
