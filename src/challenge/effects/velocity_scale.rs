//! Speeds that are all too large or too small by the same factor.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Run;
use crate::seed::Rng;

/// Sized by the factor less 1.
pub(super) const KIND: Kind = Kind {
    name: "velocity-scale",
    class: Class::Measurement,
    range: (0.05, 0.2),
    signed: true,
    unit: "1",
    coulomb_only: false,
    void: Void::OnInclineUnderCoulomb,
    make,
};

#[derive(Debug)]
struct Scale {
    excess: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Scale { excess: scene.size }))
}

impl Effect for Scale {
    fn read(&self, run: &Run, t: f64, _: usize) -> f64 {
        (1.0 + self.excess) * run.speed(t)
    }
}
