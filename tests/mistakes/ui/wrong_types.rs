//! rustc: values that are no numbers.
use couloir::noise::Ar;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    centre ~ Normal("0.3", 0.1);
    z[2.0] ~ Normal(0.0, 1.0);
    friction ~ Coulomb { mu = centre + z[0] };
    errors ~ Ar { phi: Uniform(-1.0, 1.0), sigma2 = true };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
