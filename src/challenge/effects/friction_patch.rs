//! Friction that differs between two places.

use super::{Class, Effect, Kind, Scene, Stretch, Void, inside};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

pub(super) const KIND: Kind = Kind {
    name: "friction-patch",
    class: Class::Physics,
    range: (0.1, 0.25),
    signed: true,
    unit: "1",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Patch {
    change: f64,
    from: f64,
    to: f64,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let (from, to) = scene.stretch(30.0, 100.0, rng)?;
    Some(Box::new(Patch { change: scene.size, from, to }))
}

impl Effect for Patch {
    fn mu(&self, mu: f64, at: &Moment) -> f64 {
        let within = inside(at.place, self.from, self.to);
        if within { mu + self.change } else { mu }
    }

    fn borders(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![self.from, self.to], Vec::new())
    }

    fn stretch(&self) -> Stretch {
        Stretch::Place(self.from, self.to)
    }
}
