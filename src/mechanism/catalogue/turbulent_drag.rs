//! A drag in u^2 that the model lacks.

use super::{FORCE, Rate, everywhere};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A drag in u^2 that the model lacks.
#[derive(Debug, Clone, Copy)]
pub struct TurbulentDrag {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for TurbulentDrag {
    fn name(&self) -> &'static str {
        "turbulent-drag"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("drag that grows with the square of the speed")
    }

    fn says(&self) -> &'static str {
        "A drag that grows with the square of the speed is missing."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let scale = FORCE / self.extent.speed.powi(2);
        vec![Unknown::amplitude("drag", "1/m", AnyPrior::HalfNormal(scale))]
    }

    fn contained_in(&self) -> &'static [&'static str] {
        &["turbulent", "voellmy", "pcm"]
    }

    fn formula(&self) -> String {
        "- drag u^2".to_owned()
    }
}

impl Missing for TurbulentDrag {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { quadratic: values[0], ..Rate::default() };
        everywhere(&self.extent, rate)
    }
}
