//! One name for two things.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    centre ~ Normal(0.3, 0.1);
    let scale = 2.0 * centre;
    centre ~ Normal(scale, 0.1);
    scale ~ Normal(0.3, 0.1);
    friction ~ Coulomb { mu = centre * scale };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
