//! Many mistakes, all reported.
use couloir::noise::Iid;
use couloir::physics::friction::Coulomb;
use couloir::{Event, model};

model! {
    pub struct Calibration<T> { event: T }

    centre ~ Normall(0.3, 0.1);
    friction = Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0) }
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() - errors;
    }
}

/// No errors follow from those above.
fn use_it(event: Event) -> impl couloir::Model {
    Calibration::new(event)
}

fn main() {}
