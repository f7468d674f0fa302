//! Snow that the mass takes up along a stretch and sets in motion.

use super::{FORCE, Rate, along_place, between};
use crate::mechanism::Extent;
use crate::mechanism::{
    Candidate, Change, Family, Missing, Noun, Reach, Unknown,
};
use crate::physics::forces::Axis;
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Snow that the mass takes up along a stretch and sets in motion.
#[derive(Debug, Clone, Copy)]
pub struct Entrainment {
    /// What its priors are scaled to.
    pub extent: Extent,
}

impl Candidate for Entrainment {
    fn name(&self) -> &'static str {
        "entrainment"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("entrainment of snow along a stretch")
    }

    fn says(&self) -> &'static str {
        "Along a stretch the mass takes up snow at rest, which slows it down."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let scale = FORCE / self.extent.speed.powi(2);
        let amplitude = AnyPrior::HalfNormal(scale);
        along_place(
            &self.extent,
            Unknown::amplitude("growth", "1/m", amplitude),
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
        "- growth u^2 from `from` over `length`".to_owned()
    }
}

impl Missing for Entrainment {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { growth: values[0], ..Rate::default() };
        let edges = [values[1], values[1] + values[2]];
        between(&self.extent, rate, Axis::Place, edges)
    }
}
