//! rustc: a list with one value, without its brackets.
use couloir::noise::Ar;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Ar { phi = 0.5, sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
