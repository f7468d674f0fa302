//! rustc: a list with priors, or with values, for a number.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Coulomb { mu: [Gamma(9.0, 0.03)] };
    errors ~ Iid { sigma2 = [1.0, 2.0] };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
