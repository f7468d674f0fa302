//! Several events, each with a friction of its own, drawn from a common
//! distribution: what is learned of one slope informs the others, and the
//! next avalanche is predicted from `centre` and `spread`. Synthetic data.

use couloir::prelude::*;

// 2. The model: one law for each event, its mu from a common distribution.
model! {
    struct Slopes { events: Vec<Event> }

    centre ~ Normal(0.3, 0.1);
    spread ~ Gamma(4.0, 0.01);
    friction[i in 0..events.len()] ~ Coulomb { mu: Normal(centre, spread) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 2.0) };

    likelihood {
        for (event, friction) in events.iter().zip(&friction) {
            let flow = event.slide(friction)?;
            event.velocity ~ flow.velocity() + errors;
        }
    }
}

fn main() -> Result<()> {
    // 1. The data: synthetic, six slopes with centre 0.32 and spread 0.04.
    let mu = [0.34, 0.27, 0.37, 0.31, 0.32, 0.29];
    let times: Vec<f64> = (1..=8).map(f64::from).collect();
    let plans = [28.0, 31.0, 33.0, 35.0, 38.0, 41.0].map(|degrees| {
        Event::on(Track::incline(degrees, 1000.0)?)
            .velocity(Series::velocity(times.clone(), vec![0.0; 8])?)
            .build()
    });
    let plans = plans.into_iter().collect::<Result<Vec<_>>>()?;
    let truth = [&[0.32, 0.04], &mu[..], &[1.0]].concat();
    let seen = simulate(&Slopes::new(plans.clone()), &truth, Seed::new(2))?;
    let events = plans
        .iter()
        .zip(seen)
        .map(|(plan, series)| plan.with_recording(series))
        .collect::<Result<Vec<_>>>()?;

    // 3. The inference.
    let model = Slopes::new(events);
    let posterior = Posterior::new(&model)?;
    let backend = MetropolisHastings::default();
    let found = infer(&backend, &posterior, Seed::new(1), &Quiet)?;

    // 4. The result.
    println!("true: centre 0.32, spread 0.04, mu {mu:?}\n\n{found}");
    Ok(())
}
