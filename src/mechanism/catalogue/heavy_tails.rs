//! Errors among which large ones are common.

use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Errors among which large ones are common.
#[derive(Debug, Clone, Copy)]
pub struct HeavyTails;

impl Candidate for HeavyTails {
    fn name(&self) -> &'static str {
        "heavy-tails"
    }

    fn family(&self) -> Family {
        Family::Errors
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::many("outliers among the errors")
    }

    fn says(&self) -> &'static str {
        "Some values are far off: large errors are more common than a normal distribution has them."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        vec![Unknown::amplitude("tail", "1", AnyPrior::Uniform(0.0, 0.5))]
    }

    fn contained_in(&self) -> &'static [&'static str] {
        &["student"]
    }

    fn formula(&self) -> String {
        "noise ~ Student(1/tail)".to_owned()
    }
}

impl Missing for HeavyTails {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let mut change = Change::default();
        change.noise.tail = values[0];
        change
    }
}
