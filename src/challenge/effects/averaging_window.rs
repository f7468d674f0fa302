//! Values that are means over the last seconds, taken for speeds of one
//! instant. Before the release the mass was at rest, and the mean says so.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Run;
use crate::seed::Rng;

pub(super) const KIND: Kind = Kind {
    name: "averaging-window",
    class: Class::Measurement,
    range: (1.0, 2.5),
    signed: false,
    unit: "s",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Window {
    /// Its length \[s\].
    seconds: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Window { seconds: scene.size }))
}

impl Effect for Window {
    fn read(&self, run: &Run, t: f64, _: usize) -> f64 {
        if self.seconds == 0.0 {
            return run.speed(t);
        }
        let before = run.place((t - self.seconds).max(0.0));
        (run.place(t) - before) / self.seconds
    }
}
