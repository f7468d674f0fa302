//! rustc: a list with one prior, without its brackets.
use couloir::noise::Ar;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Ar {
        phi: Uniform(-1.0, 1.0),
        sigma2: InverseGamma(3.0, 20.0),
    };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
