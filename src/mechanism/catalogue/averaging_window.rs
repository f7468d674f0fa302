//! Values that are means over a window of time.

use super::variant;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Values that are means over a window of time.
#[derive(Debug, Clone, Copy)]
pub struct AveragingWindow {
    /// Whether a window that reaches before the release begins there; else
    /// the mass counts as at rest before it.
    pub begins: bool,
}

impl Candidate for AveragingWindow {
    fn name(&self) -> &'static str {
        "averaging-window"
    }

    fn label(&self) -> String {
        variant(self)
    }

    fn family(&self) -> Family {
        Family::Measurement
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::many("values that are means over a while")
    }

    fn says(&self) -> &'static str {
        "Each value is the mean over a while, not the value of that moment."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        vec![Unknown::amplitude("window", "s", AnyPrior::HalfNormal(1.0))]
    }

    fn form(&self) -> Option<&'static str> {
        Some(if self.begins { "from the release" } else { "whole" })
    }

    fn formula(&self) -> String {
        "mean of the last `window` seconds".to_owned()
    }
}

impl Missing for AveragingWindow {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let window_begins = self.begins;
        Change { window: values[0], window_begins, ..Change::default() }
    }
}
