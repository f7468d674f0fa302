//! A drag that grows with the square of the speed, as in air.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by the force at the upper quartile of the speeds.
pub(super) const KIND: Kind = Kind {
    name: "turbulent-drag",
    class: Class::Physics,
    range: (0.5, 2.0),
    signed: false,
    unit: "m/s2",
    coulomb_only: true,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Drag {
    /// r = per_metre u2 \[1/m\].
    per_metre: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Drag { per_metre: scene.size / scene.upper.powi(2) }))
}

impl Effect for Drag {
    fn brake(&self, at: &Moment) -> f64 {
        self.per_metre * at.u * at.u
    }
}
