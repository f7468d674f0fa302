//! A clock that does not start with the mass.

use super::{Class, Effect, Kind, Scene, Void};
use crate::seed::Rng;

/// Sized by how much later than its stamp a value was taken.
pub(super) const KIND: Kind = Kind {
    name: "clock-offset",
    class: Class::Measurement,
    range: (0.5, 1.5),
    signed: true,
    unit: "s",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Clock {
    /// How much later each recording's values were taken \[s\].
    by: [f64; 2],
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Clock { by: [scene.size, scene.other] }))
}

impl Effect for Clock {
    fn late(&self, which: usize) -> f64 {
        self.by[which % 2]
    }
}
