//! rustc: only declared laws slide.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    mu ~ Gamma(9.0, 0.03);
    likelihood {
        let friction = Coulomb { mu };
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
