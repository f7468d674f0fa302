//! A force in a window of time, as by mass that comes from behind.

use super::{Class, Effect, Kind, Scene, Stretch, Void, inside};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by the specific force, positive along the motion.
pub(super) const KIND: Kind = Kind {
    name: "surge",
    class: Class::Physics,
    range: (0.5, 2.0),
    signed: true,
    unit: "m/s2",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Surge {
    /// Specific force \[m/s2\].
    force: f64,
    from: f64,
    to: f64,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let (from, to) = scene.window(1.5, 5.0, rng)?;
    Some(Box::new(Surge { force: scene.size, from, to }))
}

impl Effect for Surge {
    fn brake(&self, at: &Moment) -> f64 {
        let within = inside(at.time, self.from, self.to);
        if within { -self.force } else { 0.0 }
    }

    fn borders(&self) -> (Vec<f64>, Vec<f64>) {
        (Vec::new(), vec![self.from, self.to])
    }

    fn stretch(&self) -> Stretch {
        Stretch::Time(self.from, self.to)
    }
}
