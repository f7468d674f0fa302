//! Friction that rises exponentially near the end of the run.

use rand::RngExt;

use super::{Class, Effect, Kind, Scene, Stretch, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by the change of mu at the end of the recording.
pub(super) const KIND: Kind = Kind {
    name: "late-friction",
    class: Class::Outside,
    range: (0.2, 0.5),
    signed: false,
    unit: "1",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Late {
    change: f64,
    /// The end of the recording \[m\].
    end: f64,
    /// Over which distance it grows by e \[m\].
    length: f64,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let length = rng.random_range(20.0..60.0);
    let (change, end) = (scene.size, scene.to);
    Some(Box::new(Late { change, end, length }))
}

impl Effect for Late {
    fn mu(&self, mu: f64, at: &Moment) -> f64 {
        let past = ((at.s - self.end) / self.length).min(1.0);
        mu + self.change * past.exp()
    }

    /// Two lengths, where it is more than a seventh of what it will be.
    fn stretch(&self) -> Stretch {
        Stretch::Place(self.end - 2.0 * self.length, f64::INFINITY)
    }
}
