//! Friction that falls with speed: mu (r + (1 - r) exp(-u/u0)).

use rand::RngExt;

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by 1 - r, the share of mu that fast motion loses.
pub(super) const KIND: Kind = Kind {
    name: "velocity-weakening",
    class: Class::Physics,
    range: (0.3, 0.7),
    signed: false,
    unit: "1",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Weakening {
    lost: f64,
    /// The speed over which mu falls \[m/s\].
    speed: f64,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let speed = rng.random_range(4.0..15.0);
    Some(Box::new(Weakening { lost: scene.size, speed }))
}

impl Effect for Weakening {
    fn mu(&self, mu: f64, at: &Moment) -> f64 {
        mu * (1.0 - self.lost * (1.0 - (-at.u / self.speed).exp()))
    }
}
