//! A mass that is already moving at t = 0.

use super::SPEED;
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A mass that is already moving at t = 0.
#[derive(Debug, Clone, Copy)]
pub struct InitialVelocity {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for InitialVelocity {
    fn name(&self) -> &'static str {
        "initial-velocity"
    }

    fn family(&self) -> Family {
        Family::Start
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("a start that was already moving")
    }

    fn says(&self) -> &'static str {
        "At t = 0 the mass had another speed than the event says."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        // A mass said to be moving may have been slower, too.
        let prior = match self.extent.start_speed {
            0.0 => AnyPrior::HalfNormal(SPEED),
            _ => AnyPrior::Normal(0.0, SPEED),
        };
        vec![Unknown::amplitude("speed", "m/s", prior)]
    }

    fn formula(&self) -> String {
        "u(0) + speed".to_owned()
    }
}

impl Missing for InitialVelocity {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        Change { start_speed: values[0], ..Change::default() }
    }
}
