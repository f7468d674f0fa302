//! A resistance that depends on nothing.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

pub(super) const KIND: Kind = Kind {
    name: "cohesion",
    class: Class::Physics,
    range: (0.5, 2.0),
    signed: false,
    unit: "m/s2",
    coulomb_only: false,
    void: Void::OnInclineUnderCoulomb,
    make,
};

#[derive(Debug)]
struct Cohesion {
    /// Its specific force \[m/s2\].
    force: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Cohesion { force: scene.size }))
}

impl Effect for Cohesion {
    fn brake(&self, _: &Moment) -> f64 {
        self.force
    }
}
