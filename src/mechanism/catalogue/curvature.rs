//! Bends of the ground that press on the mass or relieve it.

use super::{Rate, everywhere};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Bends of the ground that press on the mass or relieve it.
#[derive(Debug, Clone, Copy)]
pub struct Curvature {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for Curvature {
    fn name(&self) -> &'static str {
        "curvature"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("the load of the bends on the friction")
    }

    fn says(&self) -> &'static str {
        "In its bends the ground presses on the mass or relieves it, and the friction changes with that load."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        vec![Unknown::amplitude("share", "1", AnyPrior::LogNormal(0.0, 0.3))]
    }

    fn contained_in(&self) -> &'static [&'static str] {
        &["curvature"]
    }

    fn formula(&self) -> String {
        "- mu share kappa u^2".to_owned()
    }
}

impl Missing for Curvature {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { pressed: values[0], ..Rate::default() };
        everywhere(&self.extent, rate)
    }
}
