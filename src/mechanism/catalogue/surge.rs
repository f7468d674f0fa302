//! A force during a window of time.

use super::{FORCE, Rate, between, or, stretch};
use crate::mechanism::Extent;
use crate::mechanism::{
    Candidate, Change, Family, Missing, Noun, Reach, Unknown,
};
use crate::physics::forces::Axis;
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A force during a window of time.
#[derive(Debug, Clone, Copy)]
pub struct Surge {
    /// What its priors are scaled to.
    pub extent: Extent,
}

impl Candidate for Surge {
    fn name(&self) -> &'static str {
        "surge"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, amplitude: f64) -> Noun {
        let what = or(amplitude, ["a push", "a brake", "a force"]);
        Noun::one(format!("{what} that lasts a while"))
    }

    fn says(&self) -> &'static str {
        "For a while the whole mass is pushed or braked, wherever it is."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let amplitude = AnyPrior::Normal(0.0, FORCE);
        let Extent { since, duration, step, .. } = self.extent;
        let (names, shortest) = (["from", "lasts"], step.min(0.5 * duration));
        let [from, lasts] =
            stretch(names, Axis::Time, [since, since + duration], shortest);
        vec![Unknown::amplitude("force", "m/s2", amplitude), from, lasts]
    }

    fn coordinate(&self) -> Option<Axis> {
        Some(Axis::Time)
    }

    fn reach(&self, values: &[f64]) -> Option<Reach> {
        let (from, to) = (values[1], values[1] + values[2]);
        Some(Reach { axis: Axis::Time, from, to })
    }

    fn formula(&self) -> String {
        "+ force from t = `from` for `lasts`".to_owned()
    }
}

impl Missing for Surge {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { constant: -values[0], ..Rate::default() };
        let edges = [values[1], values[1] + values[2]];
        between(&self.extent, rate, Axis::Time, edges)
    }
}
