//! Right sides that say nothing of the data.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity();
        event.velocity ~ flow.velocity() - errors;
        flow.runout()? ~ ;
        ~ flow.velocity() + errors;
    }
}

fn main() {}
