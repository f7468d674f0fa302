//! The mass moved already at t = 0, though its file says it was at rest.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Start;
use crate::seed::Rng;

pub(super) const KIND: Kind = Kind {
    name: "initial-velocity",
    class: Class::Start,
    range: (2.0, 8.0),
    signed: false,
    unit: "m/s",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Moving {
    /// The speed at t = 0 of each recording's mass \[m/s\].
    speeds: [f64; 2],
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Moving { speeds: [scene.size, scene.other] }))
}

impl Effect for Moving {
    fn start(&self, stated: Start, which: usize) -> Start {
        let speed = stated.speed + self.speeds[which % 2];
        Start { speed, ..stated }
    }
}
