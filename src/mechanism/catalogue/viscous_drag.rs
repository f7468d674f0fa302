//! A drag in u that the model lacks.

use super::{FORCE, Rate, everywhere};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A drag in u that the model lacks.
#[derive(Debug, Clone, Copy)]
pub struct ViscousDrag {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for ViscousDrag {
    fn name(&self) -> &'static str {
        "viscous-drag"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("drag in proportion to the speed")
    }

    fn says(&self) -> &'static str {
        "A drag that grows in proportion to the speed is missing."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let scale = FORCE / self.extent.speed;
        vec![Unknown::amplitude("drag", "1/s", AnyPrior::HalfNormal(scale))]
    }

    fn contained_in(&self) -> &'static [&'static str] {
        &["viscous"]
    }

    fn formula(&self) -> String {
        "- drag u".to_owned()
    }
}

impl Missing for ViscousDrag {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { linear: values[0], ..Rate::default() };
        everywhere(&self.extent, rate)
    }
}
