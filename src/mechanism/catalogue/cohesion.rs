//! A constant force that holds the mass back.

use super::{FORCE, Rate, everywhere};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A constant force that holds the mass back.
#[derive(Debug, Clone, Copy)]
pub struct Cohesion {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for Cohesion {
    fn name(&self) -> &'static str {
        "cohesion"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("a constant resistance")
    }

    fn says(&self) -> &'static str {
        "A constant force holds the mass back, whatever load and speed."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        vec![Unknown::amplitude("force", "m/s2", AnyPrior::HalfNormal(FORCE))]
    }

    fn contained_in(&self) -> &'static [&'static str] {
        &["cohesion"]
    }

    fn formula(&self) -> String {
        "- force".to_owned()
    }
}

impl Missing for Cohesion {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { constant: values[0], ..Rate::default() };
        everywhere(&self.extent, rate)
    }
}
