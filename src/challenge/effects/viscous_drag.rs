//! A drag that grows with the speed.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by the force at the upper quartile of the speeds.
pub(super) const KIND: Kind = Kind {
    name: "viscous-drag",
    class: Class::Physics,
    range: (0.5, 2.0),
    signed: false,
    unit: "m/s2",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Drag {
    /// r = rate u \[1/s\].
    rate: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Drag { rate: scene.size / scene.upper }))
}

impl Effect for Drag {
    fn brake(&self, at: &Moment) -> f64 {
        self.rate * at.u
    }
}
