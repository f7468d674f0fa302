//! Dry friction that falls with the speed.

use super::{FRICTION, Rate, Shape, everywhere};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Dry friction that falls with the speed.
#[derive(Debug, Clone, Copy)]
pub struct VelocityWeakening {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for VelocityWeakening {
    fn name(&self) -> &'static str {
        "velocity-weakening"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("dry friction that falls with speed")
    }

    fn says(&self) -> &'static str {
        "The dry friction falls as the mass gets faster."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let centre = (0.5 * self.extent.speed).ln();
        vec![
            Unknown::amplitude(
                "delta_mu",
                "1",
                AnyPrior::HalfNormal(FRICTION),
            ),
            Unknown::other("speed", "m/s", AnyPrior::LogNormal(centre, 0.7)),
        ]
    }

    fn contained_in(&self) -> &'static [&'static str] {
        &["velocity-weakening"]
    }

    fn formula(&self) -> String {
        "+ delta_mu (1 - exp(-u/speed)) g cos(theta)".to_owned()
    }
}

impl Missing for VelocityWeakening {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { mu: -values[0], ..Rate::default() };
        let mut change = everywhere(&self.extent, rate);
        for term in &mut change.forces.terms {
            term.shape = Shape::WithSpeed(values[1]);
        }
        change
    }
}
