//! A force that comes and goes along the track, as over waves of old debris.

use std::f64::consts::TAU;

use rand::RngExt;

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by the amplitude.
pub(super) const KIND: Kind = Kind {
    name: "periodic-force",
    class: Class::Outside,
    range: (0.75, 2.0),
    signed: false,
    unit: "m/s2",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Waves {
    /// Its amplitude \[m/s2\].
    force: f64,
    /// From crest to crest \[m\].
    length: f64,
    phase: f64,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let length = rng.random_range(60.0..200.0);
    let phase = rng.random_range(0.0..TAU);
    Some(Box::new(Waves { force: scene.size, length, phase }))
}

impl Effect for Waves {
    fn brake(&self, at: &Moment) -> f64 {
        self.force * (TAU * at.s / self.length + self.phase).sin()
    }
}
