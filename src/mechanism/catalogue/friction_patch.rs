//! Dry friction that differs between two places.

use super::{FRICTION, Rate, along_place, between, or};
use crate::mechanism::Extent;
use crate::mechanism::{
    Candidate, Change, Family, Missing, Noun, Reach, Unknown,
};
use crate::physics::forces::Axis;
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Dry friction that differs between two places.
#[derive(Debug, Clone, Copy)]
pub struct FrictionPatch {
    /// What its priors are scaled to.
    pub extent: Extent,
}

impl Candidate for FrictionPatch {
    fn name(&self) -> &'static str {
        "friction-patch"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, amplitude: f64) -> Noun {
        let how = or(amplitude, ["higher", "lower", "other"]);
        Noun::one(format!("a patch of {how} friction"))
    }

    fn says(&self) -> &'static str {
        "Between two places the dry friction is higher or lower than elsewhere."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let amplitude = AnyPrior::Normal(0.0, FRICTION);
        along_place(
            &self.extent,
            Unknown::amplitude("delta_mu", "1", amplitude),
        )
    }

    fn coordinate(&self) -> Option<Axis> {
        Some(Axis::Place)
    }

    fn reach(&self, values: &[f64]) -> Option<Reach> {
        let (from, to) = (values[1], values[1] + values[2]);
        Some(Reach { axis: Axis::Place, from, to })
    }

    fn formula(&self) -> String {
        "- delta_mu g cos(theta) from `from` over `length`".to_owned()
    }
}

impl Missing for FrictionPatch {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { mu: values[0], ..Rate::default() };
        let edges = [values[1], values[1] + values[2]];
        between(&self.extent, rate, Axis::Place, edges)
    }
}
