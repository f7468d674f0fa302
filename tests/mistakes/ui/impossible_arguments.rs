//! Arguments that no such distribution has.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    a ~ Normal(0, 1.0);
    b ~ Normal(a, 0.0);
    c ~ Uniform(1.0, -1.0);
    friction ~ Coulomb { mu: Gamma(-9.0, c) };
    errors ~ Iid { sigma2: InverseGamma(b, -20) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
