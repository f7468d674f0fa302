//! An import once everything is worked out, for what is told of it.

use super::front::{mean_speeds, speed_at_start};
use super::ground::Ground;
use super::line::{Beside, Line};
use super::log::SpeedKind;
use super::moving::Moving;

/// A recording once everything is worked out.
#[derive(Debug)]
pub(super) struct Case {
    /// The event's name.
    pub(super) name: String,
    /// The recording, and the rows of it that are taken.
    pub(super) moving: Moving,
    /// The speed above which it moves \[m/s\].
    pub(super) threshold: f64,
    /// The path.
    pub(super) line: Line,
    /// Whether a file gave it.
    pub(super) is_given: bool,
    /// Where the rows that are taken lie beside the path.
    pub(super) beside: Vec<Beside>,
    /// The terrain under them, where there is a terrain model \[m\].
    pub(super) terrain: Option<Vec<Option<f64>>>,
    /// The track, of all recordings.
    pub(super) ground: Ground,
    /// Where along the path the track begins \[m\].
    pub(super) origin: f64,
    /// Whether there are several recordings.
    pub(super) several: bool,
    /// When t = 0 is on the clock that they share \[s\].
    pub(super) start: Option<f64>,
    /// The speeds of the rows that are taken, along the slope \[m/s\].
    pub(super) recorded: Vec<f64>,
}

impl Case {
    /// Where the rows that are taken lie on the track: horizontal distances
    /// from its first point \[m\].
    pub(super) fn distances(&self) -> Vec<f64> {
        self.beside.iter().map(|b| b.along - self.origin).collect()
    }

    /// Where the first and the last of them lie \[m\].
    pub(super) fn ends(&self) -> (f64, f64) {
        let at = |b: Option<&Beside>| b.map_or(0.0, |b| b.along - self.origin);
        (at(self.beside.first()), at(self.beside.last()))
    }

    /// Distances of the rows that are taken along the slope, from the first
    /// \[m\].
    pub(super) fn travelled(&self) -> Vec<f64> {
        let (first, _) = self.ends();
        let all = self.distances().into_iter();
        all.map(|x| match x < first {
            true => -self.ground.along(x, first),
            false => self.ground.along(first, x),
        })
        .collect()
    }

    /// The heights of the log over the terrain model, where both are \[m\].
    pub(super) fn heights_over_terrain(&self) -> Vec<f64> {
        let terrain = self.terrain.iter().flatten();
        let both = self.moving.rows().iter().zip(terrain);
        both.filter_map(|(fix, z)| Some(fix.height? - (*z)?)).collect()
    }

    /// The speeds of the rows that are taken, along the slope: those of a
    /// front are the means since the row before.
    pub(super) fn along_slope(&self) -> Vec<f64> {
        let phase = self.moving.phase;
        let taken = &self.moving.speeds[phase.first..=phase.last];
        match self.moving.log.kind {
            SpeedKind::Whole | SpeedKind::Along => taken.to_vec(),
            SpeedKind::Front => {
                let (times, way) = (self.moving.times(), self.travelled());
                let start = speed_at_start(&times, &way);
                let means = mean_speeds(&times, &way);
                [start].into_iter().chain(means).collect()
            }
            SpeedKind::Ground | SpeedKind::Positions => taken
                .iter()
                .zip(self.distances())
                .map(|(speed, x)| speed / self.ground.cosine(x))
                .collect(),
        }
    }
}
