//! Errors that are larger in one part of the recording than in another.

use super::variant;
use crate::mechanism::Extent;
use crate::mechanism::{
    Candidate, Change, Covariate, Family, Missing, Noun, Unknown,
};
use crate::physics::forces::Axis;
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Errors whose spread grows or falls along time or speed.
#[derive(Debug, Clone, Copy)]
pub struct UnequalVariance {
    /// What its prior is scaled to.
    pub extent: Extent,
    /// Time or speed.
    pub axis: Axis,
}

impl Candidate for UnequalVariance {
    fn name(&self) -> &'static str {
        "unequal-variance"
    }

    fn label(&self) -> String {
        variant(self)
    }

    fn family(&self) -> Family {
        Family::Errors
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::many("errors of unequal size")
    }

    fn says(&self) -> &'static str {
        match self.axis {
            Axis::Time => {
                "The errors are larger in one part of the recording than in \
                 another."
            }
            _ => "The errors are larger, or smaller, where values are large.",
        }
    }

    fn unknowns(&self) -> Vec<Unknown> {
        vec![Unknown::amplitude("rise", "1", AnyPrior::Normal(0.0, 1.0))]
    }

    fn coordinate(&self) -> Option<Axis> {
        Some(self.axis)
    }

    fn formula(&self) -> String {
        let x = match self.axis {
            Axis::Time => "t/duration",
            _ => "value/quartile",
        };
        format!("ln sd + rise ({x} - 1/2)")
    }
}

impl Missing for UnequalVariance {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let mut change = Change::default();
        change.noise.spread = values[0];
        change.spread_along = match self.axis {
            Axis::Time => Covariate::Time(self.extent.duration),
            _ => Covariate::Value(self.extent.speed),
        };
        change
    }
}
