//! A value behind `:`, a prior behind `=`.
use couloir::noise::Ar;
use couloir::physics::friction::Voellmy;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Voellmy { mu: 0.3, xi = Gamma(2.5, 400.0) };
    errors ~ Ar { phi: [0.5, 0.1], sigma2 };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
