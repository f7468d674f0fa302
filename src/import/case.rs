//! An import once everything is worked out, for what is told of it.

use super::crs::Place;
use super::ground::Ground;
use super::line::{Beside, Line};
use super::log::{Fix, Log};
use super::phase::Phase;

/// An import once everything is worked out.
#[derive(Debug)]
pub(super) struct Case {
    /// The event's name.
    pub(super) name: String,
    pub(super) log: Log,
    /// The log's places \[m\].
    pub(super) places: Vec<Place>,
    /// The log's speeds, of its own kind \[m/s\].
    pub(super) speeds: Vec<f64>,
    /// Horizontal speeds by the log's positions \[m/s\].
    pub(super) level: Vec<f64>,
    /// The speed above which it moves \[m/s\].
    pub(super) threshold: f64,
    /// The rows that are taken.
    pub(super) phase: Phase,
    /// Other stretches above the threshold.
    pub(super) others: Vec<Phase>,
    /// The path.
    pub(super) line: Line,
    /// Whether a file gave it.
    pub(super) is_given: bool,
    /// Where the rows that are taken lie beside the path.
    pub(super) beside: Vec<Beside>,
    /// The terrain under them, where there is a terrain model \[m\].
    pub(super) terrain: Option<Vec<Option<f64>>>,
    pub(super) ground: Ground,
    /// The speeds of the rows that are taken, along the slope \[m/s\].
    pub(super) recorded: Vec<f64>,
    /// What was done, in sentences.
    pub(super) said: Vec<String>,
}

impl Case {
    /// The rows that are taken.
    pub(super) fn rows(&self) -> &[Fix] {
        self.log.fixes.get(self.phase.first..=self.phase.last).unwrap_or(&[])
    }

    /// Seconds from the log's first row to t = 0.
    pub(super) fn begin(&self) -> f64 {
        self.rows().first().map_or(0.0, |fix| fix.time)
    }

    /// The times of the rows that are taken, from the first \[s\].
    pub(super) fn times(&self) -> Vec<f64> {
        let begin = self.begin();
        self.rows().iter().map(|fix| fix.time - begin).collect()
    }

    /// Horizontal distances along the path from the first row \[m\].
    pub(super) fn distances(&self) -> Vec<f64> {
        let first = self.beside.first().map_or(0.0, |b| b.along);
        self.beside.iter().map(|b| b.along - first).collect()
    }

    /// The heights of the log over the terrain model, where both are \[m\].
    pub(super) fn heights_over_terrain(&self) -> Vec<f64> {
        let terrain = self.terrain.iter().flatten();
        let both = self.rows().iter().zip(terrain);
        both.filter_map(|(fix, z)| Some(fix.height? - (*z)?)).collect()
    }
}
