//! The pressure of a released mass that collapses.

use super::{FORCE, Rate, everywhere, or};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::physics::forces::{Axis, Range, Shape};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// The pressure within a released mass, which pushes its front and holds its
/// tail until it has collapsed: a force that decays with time.
///
/// In the equations of shallow flow it is g cos(theta) dh/ds, h the depth
/// (Savage and Hutter 1989); a released slab of depth h and length l spreads
/// within about l/sqrt(g h).
#[derive(Debug, Clone, Copy)]
pub struct Spreading {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for Spreading {
    fn name(&self) -> &'static str {
        "spreading"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, amplitude: f64) -> Noun {
        Noun::one(or(
            amplitude,
            [
                "a pressure that pushes the mass while it spreads",
                "a pressure that holds the mass back while it spreads",
                "the pressure of a mass that spreads",
            ],
        ))
    }

    fn says(&self) -> &'static str {
        "The pressure of the released mass pushes it on, or holds it back, \
         until it has spread."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let Extent { step, duration, .. } = self.extent;
        let shortest = step.min(0.5 * duration);
        vec![
            Unknown::amplitude("push", "m/s2", AnyPrior::Normal(0.0, FORCE)),
            Unknown::other("time", "s", AnyPrior::Uniform(shortest, duration)),
        ]
    }

    fn formula(&self) -> String {
        "+ push exp(-t/time)".to_owned()
    }
}

impl Missing for Spreading {
    /// push exp(-t/time) is push less what saturates at it; after the last
    /// value it stays as it is.
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let [push, time] = [values[0], values[1]];
        let of = |constant| Rate { constant, ..Rate::default() };
        let mut change = everywhere(&self.extent, of(push));
        let Extent { since, duration, .. } = self.extent;
        let range = Range { begin: since, span: duration };
        for term in &mut change.forces.terms {
            term.shape = Shape::Saturating(Axis::Time, range, time);
        }
        change.and(&everywhere(&self.extent, of(-push)))
    }
}
