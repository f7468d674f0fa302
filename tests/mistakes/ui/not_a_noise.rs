//! rustc: a last summand that is no noise.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + friction;
        event.velocity ~ Normal(flow.runout()?, 1.0);
        event.velocity ~ errors.sigma2 + errors;
    }
}

fn main() {}
