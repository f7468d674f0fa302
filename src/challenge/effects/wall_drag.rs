//! A gully whose walls brake: a drag in u that comes and goes smoothly along
//! a stretch.

use std::f64::consts::PI;

use super::{Class, Effect, Kind, Scene, Stretch, Void, inside};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by the force in the narrowest place at the upper quartile of the
/// speeds.
pub(super) const KIND: Kind = Kind {
    name: "wall-drag",
    class: Class::Outside,
    range: (1.0, 3.0),
    signed: false,
    unit: "m/s2",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Walls {
    /// Drag in the narrowest place \[1/s\].
    rate: f64,
    from: f64,
    to: f64,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let (from, to) = scene.stretch(60.0, 200.0, rng)?;
    let rate = scene.size / scene.upper;
    Some(Box::new(Walls { rate, from, to }))
}

impl Effect for Walls {
    fn brake(&self, at: &Moment) -> f64 {
        if !inside(at.place, self.from, self.to) {
            return 0.0;
        }
        let part = (at.s - self.from) / (self.to - self.from);
        self.rate * at.u * (PI * part).sin().powi(2)
    }

    fn borders(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![self.from, self.to], Vec::new())
    }

    fn stretch(&self) -> Stretch {
        Stretch::Place(self.from, self.to)
    }
}
