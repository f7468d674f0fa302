//! A release at another place than the event says.

use super::{DISTANCE, or};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A release at another place than the event says.
#[derive(Debug, Clone, Copy)]
pub struct ReleasePosition {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for ReleasePosition {
    fn name(&self) -> &'static str {
        "release-position"
    }

    fn family(&self) -> Family {
        Family::Start
    }

    fn noun(&self, amplitude: f64) -> Noun {
        Noun::one(or(
            amplitude,
            [
                "a release farther down",
                "a release farther up",
                "a release at another place",
            ],
        ))
    }

    fn says(&self) -> &'static str {
        "The mass started at another place than the event says."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let prior = match self.extent.behind {
            behind if behind >= 2.0 * DISTANCE => {
                AnyPrior::Normal(0.0, DISTANCE)
            }
            behind if behind > 0.0 => {
                AnyPrior::Uniform(-behind, 2.0 * DISTANCE)
            }
            _ => AnyPrior::HalfNormal(DISTANCE),
        };
        vec![Unknown::amplitude("shift", "m", prior)]
    }

    fn formula(&self) -> String {
        "s(0) + shift".to_owned()
    }
}

impl Missing for ReleasePosition {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        Change { start_place: values[0], ..Change::default() }
    }
}
