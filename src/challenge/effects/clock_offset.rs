//! A clock that does not start with the mass.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::motion::Run;
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
    late: [f64; 2],
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Clock { late: [scene.size, scene.other] }))
}

impl Effect for Clock {
    fn read(&self, run: &Run, t: f64, which: usize) -> f64 {
        run.speed(t + self.late[which % 2])
    }
}
