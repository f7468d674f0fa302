//! A first calibration: how much dry friction slowed a car that coasted
//! uphill? The 69 speeds are a real recording that the library carries.

use couloir::prelude::*;

// 2. The model: what is unknown, and how the speeds come about.
model! {
    /// Dry friction alone, independent errors.
    struct Dry { event: Event }

    friction ~ Coulomb { mu: Gamma(2.0, 0.02) };
    errors ~ Iid { sigma2: InverseGamma(2.0, 0.02) };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() -> Result<()> {
    // 1. The data: an event is a track, a release and what was recorded.
    let event = couloir::io::coastdown(&Laws::default())?.event;

    // 3. The inference: a backend explores the posterior from a seed.
    let model = Dry::new(event);
    let posterior = Posterior::new(&model)?;
    let backend = MetropolisHastings::default();
    let found = infer(&backend, &posterior, Seed::new(1), &Quiet)?;

    // 4. The result. Errors of 1.2 m/s are a lot for an instrument that shows
    // hundredths: something besides dry friction slowed the car.
    println!("{found}");
    Ok(())
}
