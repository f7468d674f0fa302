//! A log as it was read, whatever file it came in.

use std::path::PathBuf;

use super::clock::{DAY, Moment};
use crate::error::{Error, Result};
use crate::io::quoted;

/// A row of a log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fix {
    /// Its line in the file, or its number where it has no lines.
    pub(super) row: u64,
    /// Seconds since the log's first row.
    pub(super) time: f64,
    /// Where it is, as its log's [`Frame`] says.
    pub(super) place: (f64, f64),
    /// Height \[m\], of whatever kind the log has.
    pub(super) height: Option<f64>,
    /// Speed of the log's kind \[m/s\].
    pub(super) speed: Option<f64>,
    pub(super) satellites: Option<f64>,
}

/// What the speeds of a log are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SpeedKind {
    /// The length of a velocity to the north, the east and down: along the
    /// slope.
    Whole,
    /// A column of speeds, taken as those along the slope.
    Along,
    /// Over ground: horizontal.
    Ground,
    /// The log has none: worked out from its positions, horizontal.
    Positions,
    /// None, of a front: where it is at which time is the recording.
    Front,
}

/// What the two numbers of a place are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Frame {
    /// Longitude and latitude \[degrees\].
    Degrees,
    /// x (east) and y (north) \[m\].
    Metres,
    /// The horizontal distance along the path from its beginning \[m\], and
    /// nothing.
    Along,
}

/// A log.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Log {
    /// Its file.
    pub(super) path: PathBuf,
    pub(super) fixes: Vec<Fix>,
    pub(super) frame: Frame,
    pub(super) kind: SpeedKind,
    /// The first row on the log's own clock.
    pub(super) begin: Moment,
    /// Whether it is of a simulation, and measured by nobody.
    pub(super) is_simulated: bool,
    /// What was taken from the file, in sentences.
    pub(super) said: Vec<String>,
    /// What there is to doubt about it, in sentences.
    pub(super) doubts: Vec<String>,
}

impl Log {
    pub(super) fn is_geographic(&self) -> bool {
        self.frame == Frame::Degrees
    }

    pub(super) fn is_front(&self) -> bool {
        self.kind == SpeedKind::Front
    }

    /// What it is called in sentences.
    pub(super) fn word(&self) -> &'static str {
        match (self.is_front(), self.is_simulated) {
            (true, _) => "front",
            (false, true) => "simulation",
            (false, false) => "log",
        }
    }

    /// The moment that a user names, in seconds since the log's first row: a
    /// number of such seconds, or a clock's time where the log has one.
    pub(super) fn moment(&self, name: &str, text: &str) -> Result<f64> {
        let wrong = |expected: &str| {
            Error::input(format!(
                "{name}: found {}; expected {expected}",
                quoted(text)
            ))
        };
        let Some(moment) = super::clock::moment(text, 1.0) else {
            return Err(wrong(
                "seconds since the log's first row, such as 71.5, or a time \
                 of its clock, such as 07:51:22.5",
            ));
        };
        if !moment.is_clock {
            return Ok(moment.seconds);
        }
        if !self.begin.is_clock {
            return Err(wrong(
                "seconds since the log's first row, whose times are numbers \
                 and no clock's: subtract its first time",
            ));
        }
        let since = moment.seconds - self.begin.seconds;
        match (moment.is_dated(), self.begin.is_dated()) {
            (true, true) => Ok(since),
            (true, false) => Err(wrong(
                "a time without a date, since the log has none, such as \
                 07:51:22.5",
            )),
            (false, _) => Ok(self.nearest(since - self.begin.ahead)),
        }
    }

    /// The time of a clock without a date, in seconds since the log's first row
    /// but for whole days: of the day that is nearest to the log.
    fn nearest(&self, since: f64) -> f64 {
        let last = self.fixes.last().map_or(0.0, |fix| fix.time);
        let after = since.rem_euclid(DAY);
        let before = after - DAY;
        if after - last.max(0.0) <= -before { after } else { before }
    }
}
