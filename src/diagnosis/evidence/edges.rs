//! Borders along a run, between which a confined mechanism acts.

use crate::mechanism::{Role, Unknown};
use crate::prior::AnyPrior;

/// How near its ends, as a share of what is possible, an edge is at the most.
const NEAR: f64 = 1e-3;
/// How far, on the line, the next places are at the most.
const APART: f64 = 1.5;

/// The edges of one amplitude: one from which on it acts, or a stretch.
#[derive(Debug)]
pub(super) struct Edges<'a> {
    from: &'a AnyPrior,
    length: Option<&'a AnyPrior>,
    begin: f64,
    end: f64,
    shortest: f64,
    borders: usize,
}

impl<'a> Edges<'a> {
    /// Those of an amplitude that is the first of some unknowns; `None` where
    /// it is not confined. There are two borders for each shortest stretch,
    /// but so many at the most.
    pub(super) fn of(along: &'a [Unknown], most: usize) -> Option<Self> {
        let (from, length) = match along {
            [_, from] => (from, None),
            [_, from, length] => (from, Some(length)),
            _ => return None,
        };
        let Role::Edge(_) = from.role else { return None };
        let begin = from.prior.quantile(0.0)?;
        let (end, shortest) = match length.map(|length| length.role) {
            None => (from.prior.quantile(1.0)?, 0.0),
            Some(Role::Length { until }) => {
                (until, length?.prior.quantile(0.0)?)
            }
            Some(_) => return None,
        };
        let enough = 2.0 * (end - begin) / shortest;
        let borders = enough.clamp(2.0, most as f64) as usize;
        let length = length.map(|length| &length.prior);
        let from = &from.prior;
        Some(Self { from, length, begin, end, shortest, borders })
    }

    /// How many coordinates there are.
    pub(super) fn count(&self) -> usize {
        1 + usize::from(self.length.is_some())
    }

    /// How many borders there are before the end.
    pub(super) fn borders(&self) -> usize {
        self.borders
    }

    fn border(&self, i: f64) -> f64 {
        let span = self.end - self.begin;
        self.begin + i / self.borders as f64 * span
    }

    /// The place on the line of what begins at a border and lasts to the end.
    pub(super) fn onwards(&self, i: usize) -> Vec<f64> {
        let from = self.from(self.border(i as f64));
        let length = self.length.map(to_the_end);
        std::iter::once(from).chain(length).collect()
    }

    /// The place on the line of what is between two borders, and how far the
    /// next ones are if they lie so many borders apart.
    pub(super) fn place(
        &self,
        from: usize,
        to: usize,
        apart: usize,
    ) -> (Vec<f64>, Vec<f64>) {
        let step = 0.5 * apart as f64;
        let [middle, below, above] =
            [0.0, -step, step].map(|off| self.border(from as f64 + off));
        let until = [0.0, -step, step].map(|off| {
            let at = self.border(to as f64 + off);
            self.length(middle, at - middle)
        });
        let mut line = vec![self.from(middle)];
        let mut spacing = vec![self.from(above) - self.from(below)];
        if let [Some(length), Some(shorter), Some(longer)] = until {
            line.push(length);
            spacing.push(longer - shorter);
        }
        spacing.iter_mut().for_each(|x| *x = x.clamp(1e-3, APART));
        (line, spacing)
    }

    /// A beginning on the line.
    fn from(&self, at: f64) -> f64 {
        let p = (at - self.begin) / (self.end - self.begin);
        on_line(self.from, p.clamp(NEAR, 1.0 - NEAR))
    }

    /// A length on the line, of a stretch that begins at a place.
    fn length(&self, from: f64, length: f64) -> Option<f64> {
        let longest = (self.end - from).max(2.0 * self.shortest);
        let p = (length - self.shortest) / (longest - self.shortest);
        self.length.map(|prior| on_line(prior, p.clamp(NEAR, 1.0 - NEAR)))
    }
}

/// The place on the line of a length that lasts nearly to the end.
pub(super) fn to_the_end(length: &AnyPrior) -> f64 {
    on_line(length, 1.0 - NEAR)
}

/// The place on the real line of a prior's quantile.
pub(crate) fn on_line(prior: &AnyPrior, p: f64) -> f64 {
    let line = prior.line_of(prior.quantile(p).unwrap_or(0.0));
    if line.is_finite() { line } else { 0.0 }
}
