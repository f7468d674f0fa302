//! Names used before they are declared.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Coulomb { mu: Normal(centre, spread) };
    centre ~ Normal(0.3, 0.1);
    let spread = 0.1 * width;
    width ~ Normal(width, 0.1);
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
