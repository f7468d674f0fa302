//! Something in a sum that is no block.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Coulomb { mu: Gamma(9.0, 0.03) } + Normal(0.0, 1.0);
    drag ~ Coulomb { mu = 0.3 } + ;
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
        let _ = event.slide(&drag)?;
    }
}

fn main() {}
