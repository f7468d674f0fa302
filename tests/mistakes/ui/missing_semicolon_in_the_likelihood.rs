//! Statements without an end before and between `~` lines.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?
        event.velocity ~ flow.velocity() + errors;
        event.position ~ flow.position() + errors
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
