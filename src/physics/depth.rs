//! The flow depth: one number, or a row of them along the track or in time.

use crate::error::{Error, Result};

/// By what share a depth that is taken as constant changes at most on its
/// stretch. The error of the motion is of second order in it: with these
/// steps speeds are right to some mm/s (`tests/physics/depth.rs`).
const STEP: f64 = 0.02;
/// The most stretches beside the rows themselves: a depth that goes up and
/// down without end is taken in larger steps.
const MOST: f64 = 20_000.0;

/// The mean flow depth \[m\].
#[derive(Debug, Clone, PartialEq)]
pub enum Depth {
    /// The same everywhere and always.
    Even(f64),
    /// Over the horizontal distance of the track \[m\].
    Along(DepthRows),
    /// Over the time since the release \[s\].
    During(DepthRows),
}

impl From<f64> for Depth {
    fn from(depth: f64) -> Self {
        Self::Even(depth)
    }
}

/// Flow depths at places or times: linear between them, and constant beyond
/// the first and the last.
///
/// ```
/// use couloir::physics::DepthRows;
/// let rows = DepthRows::new(vec![0.0, 100.0], vec![1.0, 3.0])?;
/// assert_eq!([-5.0, 50.0, 200.0].map(|x| rows.at(x)), [1.0, 2.0, 3.0]);
/// # Ok::<(), couloir::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DepthRows {
    at: Vec<f64>,
    depths: Vec<f64>,
}

impl DepthRows {
    /// Places \[m\] or times \[s\], increasing, and a depth \[m\] for each.
    ///
    /// # Errors
    /// No row, unequal numbers, a place or time that does not increase, or a
    /// depth that is not more than 0.
    pub fn new(at: Vec<f64>, depths: Vec<f64>) -> Result<Self> {
        if at.is_empty() || at.len() != depths.len() {
            return Err(Error::input(format!(
                "flow depths need a place or a time each, and one at least; \
                 found {} and {}",
                depths.len(),
                at.len()
            )));
        }
        let bad = |x: &f64| !x.is_finite();
        if at.iter().any(bad) || at.windows(2).any(|w| w[1] <= w[0]) {
            return Err(Error::input(
                "places or times of flow depths have to be finite and to \
                 increase",
            ));
        }
        match depths.iter().find(|h| !(**h > 0.0 && h.is_finite())) {
            Some(depth) => Err(Error::input(format!(
                "a flow depth is {depth}; expected metres, more than 0"
            ))),
            None => Ok(Self { at, depths }),
        }
    }

    /// The depth at a place or a time \[m\].
    pub fn at(&self, x: f64) -> f64 {
        let after = self.at.partition_point(|row| *row <= x);
        let last = self.at.len() - 1;
        if after == 0 || after > last {
            return self.depths[after.min(last)];
        }
        let (from, to) = (self.at[after - 1], self.at[after]);
        let (low, high) = (self.depths[after - 1], self.depths[after]);
        low + (high - low) * ((x - from) / (to - from))
    }

    /// Between which places or times the depth is nearly constant: the rows,
    /// and so many even steps between them.
    pub(super) fn cuts(&self) -> Vec<f64> {
        let change = |w: &[f64]| (w[1] / w[0]).ln().abs();
        let all: f64 = self.depths.windows(2).map(change).sum();
        let step = STEP.max(all / MOST);
        let mut cuts = vec![self.at[0]];
        for (x, depths) in self.at.windows(2).zip(self.depths.windows(2)) {
            let count = (change(depths) / step).ceil().max(1.0) as usize;
            // Even in the logarithm: the same share in each.
            let ratio = (depths[1] / depths[0]).powf(1.0 / count as f64);
            let rise = depths[1] - depths[0];
            let mut depth = depths[0];
            for _ in 1..count {
                depth *= ratio;
                let part = (depth - depths[0]) / rise;
                cuts.push(x[0] + (x[1] - x[0]) * part);
            }
            cuts.push(x[1]);
        }
        cuts
    }

    /// The depth whose drag is the mean of that on a stretch without a row
    /// inside. Drag goes by 1/h, of which the mean is ln(b/a)/(b - a) where h
    /// goes from a to b.
    pub(super) fn mean(&self, from: f64, to: f64) -> f64 {
        let (a, b) = (self.at(from), self.at(to));
        let change = (b - a) / a;
        if change.abs() < 1e-6 {
            return 0.5 * (a + b);
        }
        a * change / change.ln_1p()
    }

    /// The same in steps.
    pub(crate) fn steps(&self) -> DepthSteps {
        let cuts = self.cuts();
        let last = self.at.len() - 1;
        let between = cuts.windows(2).map(|w| self.mean(w[0], w[1]));
        let mut depths = vec![self.depths[0]];
        depths.extend(between);
        depths.push(self.depths[last]);
        DepthSteps { until: cuts, depths }
    }
}

/// A depth that changes in steps of time.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthSteps {
    /// When each step but the last ends \[s\].
    until: Vec<f64>,
    depths: Vec<f64>,
}

impl DepthSteps {
    /// The depth from a time on \[m\]; times nearer than `near` are the same.
    pub(super) fn at(&self, time: f64, near: f64) -> f64 {
        self.depths[self.index(time, near)]
    }

    /// When it changes next \[s\].
    pub(super) fn next(&self, time: f64, near: f64) -> Option<f64> {
        self.until.get(self.index(time, near)).copied()
    }

    /// When it changes last \[s\].
    pub(super) fn last(&self) -> f64 {
        self.until.last().copied().unwrap_or(0.0)
    }

    fn index(&self, time: f64, near: f64) -> usize {
        self.until.partition_point(|until| *until <= time + near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> DepthRows {
        DepthRows::new(vec![1.0, 3.0, 4.0], vec![2.0, 1.0, 1.0]).unwrap()
    }

    #[test]
    fn steps_are_as_deep_as_the_rows_and_drag_as_much() {
        let steps = rows().steps();
        // ln 2 in steps of at most 2 %, and one where nothing changes.
        assert_eq!(steps.until.len(), 1 + 35 + 1);
        assert_eq!((steps.at(0.0, 0.0), steps.at(9.0, 0.0)), (2.0, 1.0));
        for (k, w) in steps.until.windows(2).enumerate() {
            let depth = steps.depths[k + 1];
            let (a, b) = (rows().at(w[0]), rows().at(w[1]));
            assert!(depth <= a && depth >= b && a - b < 0.0201 * a);
        }
        // The integral of dx/h from 1 to 3 s is 2 ln 2.
        let spans = steps.until.windows(2).zip(&steps.depths[1..]);
        let drag: f64 = spans.map(|(w, h)| (w[1] - w[0]) / h).sum();
        assert!((drag - 2.0 * 2f64.ln() - 1.0).abs() < 1e-12, "{drag}");
        assert_eq!(steps.next(0.0, 1e-9), Some(1.0));
        assert_eq!(steps.next(4.0, 1e-9), None);
        assert_eq!(steps.last(), 4.0);
    }

    #[test]
    fn endless_changes_are_taken_in_larger_steps() {
        let at = (0..2000).map(f64::from).collect();
        let depths = (0..2000).map(|i| [1e-3, 1e3][i % 2]).collect();
        let cuts = DepthRows::new(at, depths).unwrap().cuts();
        assert!(cuts.len() < 25_000, "{}", cuts.len());
        assert!(cuts.windows(2).all(|w| w[1] > w[0]));
    }

    #[test]
    fn rows_that_cannot_be_are_refused() {
        let refused = |at: &[f64], depths: &[f64]| {
            DepthRows::new(at.to_vec(), depths.to_vec()).is_err()
        };
        assert!(refused(&[], &[]));
        assert!(refused(&[0.0], &[1.0, 2.0]));
        assert!(refused(&[0.0, 0.0], &[1.0, 2.0]));
        assert!(refused(&[0.0, f64::NAN], &[1.0, 2.0]));
        assert!(refused(&[0.0, 1.0], &[1.0, 0.0]));
    }
}
