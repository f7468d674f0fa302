//! A sensor whose zero drifts steadily.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Run;
use crate::seed::Rng;

/// Sized by the drift over the recording.
pub(super) const KIND: Kind = Kind {
    name: "sensor-drift",
    class: Class::Measurement,
    range: (1.0, 4.0),
    signed: true,
    unit: "m/s",
    coulomb_only: false,
    void: Void::OnInclineUnderCoulomb,
    make,
};

#[derive(Debug)]
struct Drift {
    /// \[m/s2\].
    rate: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Drift { rate: scene.size / scene.duration }))
}

impl Effect for Drift {
    fn read(&self, run: &Run, t: f64, _: usize) -> f64 {
        run.speed(t) + self.rate * t
    }
}
