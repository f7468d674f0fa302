//! Friction that changes steadily with distance or time, linearly or towards
//! a last value.

use rand::RngExt;

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::moments::Moment;
use crate::seed::Rng;

/// Sized by the change of mu from the start to the end of the recording.
pub(super) const KIND: Kind = Kind {
    name: "friction-hardening",
    class: Class::Physics,
    range: (0.1, 0.25),
    signed: true,
    unit: "1",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Hardening {
    change: f64,
    in_time: bool,
    from: f64,
    /// From the start to the end of the recording \[m\] or \[s\].
    span: f64,
    /// The length over which it saturates, as a share of the span.
    saturates: Option<f64>,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let in_time = rng.random_bool(0.5);
    let saturating = rng.random_bool(0.5);
    let share = rng.random_range(0.15..0.4);
    let (from, span) = if in_time {
        (0.0, scene.duration)
    } else {
        (scene.top, scene.to - scene.top)
    };
    Some(Box::new(Hardening {
        change: scene.size,
        in_time,
        from,
        span,
        saturates: saturating.then_some(share),
    }))
}

impl Effect for Hardening {
    fn mu(&self, mu: f64, at: &Moment) -> f64 {
        let x = if self.in_time { at.t } else { at.s };
        let part = (x - self.from) / self.span;
        let grown = match self.saturates {
            Some(share) => {
                (1.0 - (-part / share).exp()) / (1.0 - (-1.0 / share).exp())
            }
            None => part,
        };
        mu + self.change * grown
    }
}
