//! Mass taken up along a stretch: dm/ds = e m. Set in motion from rest, it
//! brakes by e u2.

use super::{Class, Effect, Kind, Scene, Stretch, Void, inside};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by the force at the upper quartile of the speeds.
pub(super) const KIND: Kind = Kind {
    name: "entrainment",
    class: Class::Physics,
    range: (0.5, 2.0),
    signed: false,
    unit: "m/s2",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Entrainment {
    /// e \[1/m\].
    growth: f64,
    from: f64,
    to: f64,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let (from, to) = scene.stretch(30.0, 150.0, rng)?;
    let growth = scene.size / scene.upper.powi(2);
    Some(Box::new(Entrainment { growth, from, to }))
}

impl Effect for Entrainment {
    fn brake(&self, at: &Moment) -> f64 {
        let within = inside(at.place, self.from, self.to);
        if within { self.growth * at.u * at.u } else { 0.0 }
    }

    fn borders(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![self.from, self.to], Vec::new())
    }

    fn stretch(&self) -> Stretch {
        Stretch::Place(self.from, self.to)
    }
}
