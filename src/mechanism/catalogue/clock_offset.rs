//! A recording whose clock is ahead or behind.

use super::or;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A recording whose clock is ahead or behind.
#[derive(Debug, Clone, Copy)]
pub struct ClockOffset;

impl Candidate for ClockOffset {
    fn name(&self) -> &'static str {
        "clock-offset"
    }

    fn family(&self) -> Family {
        Family::Measurement
    }

    fn noun(&self, amplitude: f64) -> Noun {
        Noun::one(or(
            amplitude,
            [
                "a clock that is ahead",
                "a clock that is behind",
                "a clock that is off",
            ],
        ))
    }

    fn says(&self) -> &'static str {
        "The clock of the recording and the start of the motion do not agree."
    }

    /// Every recording is started by itself.
    fn is_each_events_own(&self) -> bool {
        true
    }

    fn unknowns(&self) -> Vec<Unknown> {
        vec![Unknown::amplitude("ahead", "s", AnyPrior::Normal(0.0, 1.0))]
    }

    fn formula(&self) -> String {
        "value(t - ahead)".to_owned()
    }
}

impl Missing for ClockOffset {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        Change { clock: values[0], ..Change::default() }
    }
}
