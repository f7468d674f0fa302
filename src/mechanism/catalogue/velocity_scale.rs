//! A sensor whose scale is off.

use super::or;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A sensor whose scale is off.
#[derive(Debug, Clone, Copy)]
pub struct VelocityScale;

impl Candidate for VelocityScale {
    fn name(&self) -> &'static str {
        "velocity-scale"
    }

    fn family(&self) -> Family {
        Family::Measurement
    }

    fn noun(&self, amplitude: f64) -> Noun {
        Noun::many(or(
            amplitude,
            [
                "readings too large by a constant factor",
                "readings too small by a constant factor",
                "readings off by a constant factor",
            ],
        ))
    }

    fn says(&self) -> &'static str {
        "The sensor shows all values too large or too small by the same share."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        vec![Unknown::amplitude("excess", "1", AnyPrior::Normal(0.0, 0.1))]
    }

    fn formula(&self) -> String {
        "(1 + excess) value".to_owned()
    }
}

impl Missing for VelocityScale {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        Change { scale: values[0], ..Change::default() }
    }
}
