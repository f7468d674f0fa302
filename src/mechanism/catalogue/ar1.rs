//! Errors that are correlated in time.

use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Errors that are correlated in time.
#[derive(Debug, Clone, Copy)]
pub struct Ar1;

impl Candidate for Ar1 {
    fn name(&self) -> &'static str {
        "ar1"
    }

    fn family(&self) -> Family {
        Family::Errors
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::many("errors correlated in time")
    }

    fn says(&self) -> &'static str {
        "The errors of neighbouring values are alike: the noise is correlated in time."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        vec![Unknown::amplitude("phi", "1", AnyPrior::Uniform(0.0, 1.0))]
    }

    fn contained_in(&self) -> &'static [&'static str] {
        &["ar"]
    }

    fn formula(&self) -> String {
        "noise ~ AR(1)".to_owned()
    }
}

impl Missing for Ar1 {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let mut change = Change::default();
        change.noise.phi = values[0];
        change
    }
}
