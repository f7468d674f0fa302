//! A case: what is hidden, and what a user would have of it.

use serde::{Deserialize, Serialize};

use super::effects::Class;
use super::scatter::Scatter;

/// What places and times are counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Coordinate {
    /// Distance along the slope from the track's first point \[m\].
    Arclength,
    /// Time since the release \[s\].
    Time,
}

/// A stretch of the run, in place or time and in time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// What `from` and `to` are counted in.
    pub coordinate: Coordinate,
    /// Its beginning \[m\] or \[s\].
    pub from: f64,
    /// Its end \[m\] or \[s\].
    pub to: f64,
    /// When the (first) mass is at its beginning \[s\].
    pub time_from: f64,
    /// When the (first) mass is at its end \[s\].
    pub time_to: f64,
}

/// What is hidden in a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// The effect's name in the catalogue; `none`; or another for what the
    /// catalogue does not have.
    pub effect: &'static str,
    /// What the effect belongs to.
    pub class: Class,
    /// Where it acts; nothing where that is everywhere.
    pub interval: Option<Interval>,
    /// Its size, in `unit`.
    pub size: f64,
    /// The size's unit; `1` for a number without one.
    pub unit: &'static str,
    /// What the errors are like.
    pub scatter: Scatter,
    /// The instrument's standard deviation \[m/s\], as drawn.
    pub noise_sd: f64,
    /// Root mean square of the errors in the recordings \[m/s\].
    pub noise_rms: f64,
    /// By how much the log likelihood of the truth exceeds the greatest that
    /// the baseline reaches, with independent normal errors or, of
    /// [`Errors::Real`](super::Errors::Real), with errors as they were drawn:
    /// about the most that a diagnosis can gain, and next to nothing where
    /// the recording does not show the effect.
    pub gain: f64,
}

/// One recording as a user would have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// A name for its event folder, which tells nothing.
    pub folder: String,
    /// The files of that folder, by name.
    pub files: Vec<(&'static str, String)>,
}

/// A case of the challenge.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Its name, which tells nothing.
    pub name: String,
    /// What is hidden.
    pub truth: Truth,
    /// One recording, or several that share the effect and the track.
    pub recordings: Vec<Recording>,
}

/// How many recordings a case has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mix {
    /// One.
    #[default]
    One,
    /// Two, from different starts on the same track: what is physical they
    /// share, in size and place; starts and clocks each has its own.
    Two,
}

impl Mix {
    /// The number.
    pub fn recordings(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two => 2,
        }
    }
}
