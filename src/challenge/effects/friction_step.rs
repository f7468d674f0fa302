//! Friction that differs beyond a place or after a time.

use rand::RngExt;

use super::{Class, Effect, Kind, Scene, Stretch, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

pub(super) const KIND: Kind = Kind {
    name: "friction-step",
    class: Class::Physics,
    range: (0.1, 0.25),
    signed: true,
    unit: "1",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Step {
    change: f64,
    /// Place \[m\] or time \[s\] from which it acts.
    from: f64,
    in_time: bool,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let in_time = rng.random_bool(0.5);
    let part = rng.random_range(0.15..0.85);
    let from = if in_time {
        part * scene.duration
    } else {
        scene.from + part * (scene.to - scene.from)
    };
    Some(Box::new(Step { change: scene.size, from, in_time }))
}

impl Effect for Step {
    fn mu(&self, mu: f64, at: &Moment) -> f64 {
        let x = if self.in_time { at.time } else { at.place };
        if x >= self.from { mu + self.change } else { mu }
    }

    fn borders(&self) -> (Vec<f64>, Vec<f64>) {
        if self.in_time {
            (Vec::new(), vec![self.from])
        } else {
            (vec![self.from], Vec::new())
        }
    }

    fn stretch(&self) -> Stretch {
        if self.in_time {
            Stretch::Time(self.from, f64::INFINITY)
        } else {
            Stretch::Place(self.from, f64::INFINITY)
        }
    }
}
