//! Dry friction that differs beyond a place or after a time.

use super::{FRICTION, Rate, between, or, variant};
use crate::mechanism::Extent;
use crate::mechanism::{
    Candidate, Change, Family, Missing, Noun, Reach, Unknown,
};
use crate::physics::forces::Axis;
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Dry friction that differs beyond a place or after a time.
#[derive(Debug, Clone, Copy)]
pub struct FrictionStep {
    /// What its priors are scaled to.
    pub extent: Extent,
    /// Place or time.
    pub axis: Axis,
}

impl Candidate for FrictionStep {
    fn name(&self) -> &'static str {
        "friction-step"
    }

    fn label(&self) -> String {
        variant(self)
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, amplitude: f64) -> Noun {
        let how = or(amplitude, ["higher", "lower", "different"]);
        let step = match self.axis {
            Axis::Time => "from a moment on",
            _ => "beyond a place",
        };
        Noun::one(format!("friction that is {how} {step}"))
    }

    fn says(&self) -> &'static str {
        match self.axis {
            Axis::Time => {
                "From a moment on the dry friction is higher or lower than \
                 before."
            }
            _ => {
                "Beyond a place the dry friction is higher or lower than \
                 before it."
            }
        }
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let Extent { begin, run, since, duration, .. } = self.extent;
        let amplitude = AnyPrior::Normal(0.0, FRICTION);
        let edge = match self.axis {
            Axis::Time => [since, since + duration],
            _ => [begin, begin + run],
        };
        vec![
            Unknown::amplitude("delta_mu", "1", amplitude),
            Unknown::edge("from", self.axis, edge),
        ]
    }

    fn coordinate(&self) -> Option<Axis> {
        Some(self.axis)
    }

    fn reach(&self, values: &[f64]) -> Option<Reach> {
        let (axis, from) = (self.axis, values[1]);
        Some(Reach { axis, from, to: f64::INFINITY })
    }

    fn formula(&self) -> String {
        let x = if self.axis == Axis::Time { "t" } else { "s" };
        format!("- delta_mu g cos(theta) where {x} > from")
    }
}

impl Missing for FrictionStep {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { mu: values[0], ..Rate::default() };
        let edges = [values[1], Real::new(f64::INFINITY)];
        between(&self.extent, rate, self.axis, edges)
    }
}
