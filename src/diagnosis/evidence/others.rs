//! The coordinates beside those of one amplitude.

use std::ops::Range;

use crate::mechanism::Unknown;

/// Where all other coordinates begin, on the line.
pub(super) struct Others {
    pub(super) before: Vec<f64>,
    after: Vec<f64>,
}

impl Others {
    /// Those beside a mechanism's unknowns in a range, its others at the
    /// middle of the line.
    pub(super) fn of(
        unknowns: &[Unknown],
        along: &Range<usize>,
        before: &[f64],
        after: &[f64],
    ) -> Self {
        let earlier = vec![0.0; along.start];
        let later = vec![0.0; unknowns.len() - along.end];
        Self {
            before: [before, &earlier].concat(),
            after: [&later, after].concat(),
        }
    }

    pub(super) fn with(&self, place: &[f64]) -> Vec<f64> {
        [&self.before, place, &self.after].concat()
    }
}
