//! Two avalanches, one law: what is physical they share, what belongs to the
//! instrument each has for itself. The recordings are synthetic.

use couloir::prelude::*;

// 2. The model: one friction law, two noises.
model! {
    struct Shared { steep: Event, gentle: Event }

    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    camera ~ Iid { sigma2: InverseGamma(3.0, 2.0) };
    radar ~ Iid { sigma2: InverseGamma(3.0, 2.0) };

    likelihood {
        let fast = steep.slide(&friction)?;
        steep.velocity ~ fast.velocity() + camera;
        let slow = gentle.slide(&friction)?;
        gentle.velocity ~ slow.velocity() + radar;
    }
}

/// An event on a constant slope, to be recorded twice a second.
fn planned(name: &str, degrees: f64) -> Result<Event> {
    let times: Vec<f64> = (1..=40).map(|i| 0.5 * f64::from(i)).collect();
    Event::on(Track::incline(degrees, 1500.0)?)
        .named(name)
        .depth(1.5)
        .velocity(Series::velocity(times, vec![0.0; 40])?)
        .build()
}

fn main() -> Result<()> {
    // 1. The data: synthetic, from one mu and one xi.
    let plans = [planned("steep", 38.0)?, planned("gentle", 25.0)?];
    let [steep, gentle] = plans;
    let planned = Shared::new(steep.clone(), gentle.clone());
    let truth = [0.25, 1500.0, 1.0, 0.25];
    let seen = simulate(&planned, &truth, Seed::new(3))?;
    let steep = steep.with_recording(seen[0].clone())?;
    let gentle = gentle.with_recording(seen[1].clone())?;

    // 3. The inference.
    let model = Shared::new(steep, gentle);
    let posterior = Posterior::new(&model)?;
    let backend = MetropolisHastings::default();
    let found = infer(&backend, &posterior, Seed::new(1), &Quiet)?;

    // 4. The result: one slope alone cannot tell mu from xi, two can.
    println!("true: mu 0.25, xi 1500, sigma2 1.0 and 0.25\n\n{found}");
    Ok(())
}
