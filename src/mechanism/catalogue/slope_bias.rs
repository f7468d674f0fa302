//! A track whose angle is off.

use super::ANGLE;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A track whose angle is off.
#[derive(Debug, Clone, Copy)]
pub struct SlopeBias;

impl Candidate for SlopeBias {
    fn name(&self) -> &'static str {
        "slope-bias"
    }

    fn family(&self) -> Family {
        Family::Measurement
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("a track whose slope is off")
    }

    fn says(&self) -> &'static str {
        "The ground is steeper or flatter than the track says, by the same angle everywhere."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        vec![Unknown::amplitude("angle", "deg", AnyPrior::Normal(0.0, ANGLE))]
    }

    fn formula(&self) -> String {
        "theta + angle".to_owned()
    }
}

impl Missing for SlopeBias {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let mut change = Change::default();
        change.forces.tilt = values[0] * 1.0_f64.to_radians();
        change
    }
}
