//! Normal load by the centripetal force: g cos(theta) + c kappa u2.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by c, near 1: how much of the bend the mass follows.
pub(super) const KIND: Kind = Kind {
    name: "curvature",
    class: Class::Physics,
    range: (0.8, 1.2),
    signed: false,
    unit: "1",
    coulomb_only: false,
    void: Void::WithoutBends,
    make,
};

/// Over how many metres either side angles are smoothed.
const HALF: f64 = 10.0;

#[derive(Debug)]
struct Curvature {
    factor: f64,
    /// kappa \[1/m\] at every metre from the track's beginning.
    kappa: Vec<f64>,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    let metres = scene.ground.length() as usize + 2;
    let kappa =
        (0..metres).map(|s| scene.ground.curvature(s as f64, HALF)).collect();
    Some(Box::new(Curvature { factor: scene.size, kappa }))
}

impl Effect for Curvature {
    fn load(&self, at: &Moment) -> f64 {
        let s = at.s.clamp(0.0, (self.kappa.len() - 2) as f64);
        let (i, part) = (s as usize, s.fract());
        let (a, b) = (self.kappa[i], self.kappa[i + 1]);
        self.factor * (a + part * (b - a)) * at.u * at.u
    }
}
