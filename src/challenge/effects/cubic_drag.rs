//! A drag that grows with the third power of the speed.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by the force at the upper quartile of the speeds.
pub(super) const KIND: Kind = Kind {
    name: "cubic-drag",
    class: Class::Outside,
    range: (0.5, 2.0),
    signed: false,
    unit: "m/s2",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Drag {
    /// r = factor u3 \[s/m2\].
    factor: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Drag { factor: scene.size / scene.upper.powi(3) }))
}

impl Effect for Drag {
    fn brake(&self, at: &Moment) -> f64 {
        self.factor * at.u.powi(3)
    }
}
