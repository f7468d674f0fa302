//! A struct with a type parameter.
use couloir::model;
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;

model! {
    pub struct Calibration<T> { event: T }

    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
