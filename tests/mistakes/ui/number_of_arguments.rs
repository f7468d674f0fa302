//! Distributions with too few or too many arguments.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Coulomb { mu: Gamma(9.0) };
    errors ~ Iid { sigma2: Exponential(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ Normal(flow.velocity(), errors, 1.0);
    }
}

fn main() {}
