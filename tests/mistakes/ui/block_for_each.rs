//! A block for each event, without an index.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction[2] ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction[0])?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
