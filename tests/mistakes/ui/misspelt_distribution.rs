//! Names that are no distribution.
use couloir::noise::Student;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    centre ~ normal(0.3, 0.1);
    friction ~ Coulomb { mu: Gama(centre, 0.03) };
    errors ~ Student { sigma2: StudnetT(3.0, 0.0, 1.0), nu: Weibull(3.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
