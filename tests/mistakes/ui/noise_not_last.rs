//! Sums without a noise at their end.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration { event: Event }

    centre ~ Normal(0.3, 0.1);
    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ errors + flow.velocity();
        event.velocity ~ flow.velocity() + centre;
        event.velocity ~ flow.velocity() + Normal(0.0, 1.0);
    }
}

fn main() {}
