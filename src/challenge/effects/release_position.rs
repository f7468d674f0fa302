//! The mass started above or below the place that its file gives.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Start;
use crate::seed::Rng;

/// Sized by the distance along the slope, positive downhill.
pub(super) const KIND: Kind = Kind {
    name: "release-position",
    class: Class::Start,
    range: (10.0, 40.0),
    signed: true,
    unit: "m",
    coulomb_only: false,
    void: Void::OnIncline,
    make,
};

#[derive(Debug)]
struct Moved {
    /// How far down the slope each mass was \[m\].
    by: [f64; 2],
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Moved { by: [scene.size, scene.other] }))
}

impl Effect for Moved {
    fn start(&self, stated: Start, which: usize) -> Start {
        let place = stated.place + self.by[which % 2];
        Start { place, ..stated }
    }
}
