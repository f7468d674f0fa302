//! Which rows of a recording are the avalanche, and how fast it is in them.

use super::crs::{Crs, Place};
use super::line::Line;
use super::log::{Fix, Frame, Log, SpeedKind};
use super::options::Options;
use super::phase::{Phase, REST, between, stretches, widened};
use super::plane;
use super::smooth::fit;
use crate::error::{Error, Result};
use crate::io::place;

/// The fewest rows that an event is made of.
const FEWEST: usize = 6;

/// Positions within this time of one give its speed \[s\].
const SPEED_HALF: f64 = 0.5;

/// A recording on the plane, with the rows of it that are taken.
#[derive(Debug)]
pub(super) struct Moving {
    pub(super) log: Log,
    /// The log's places \[m\].
    pub(super) places: Vec<Place>,
    /// The log's speeds, of its own kind \[m/s\].
    pub(super) speeds: Vec<f64>,
    /// Horizontal speeds by the log's positions \[m/s\].
    pub(super) level: Vec<f64>,
    /// The rows that are taken.
    pub(super) phase: Phase,
    /// Other stretches above the threshold.
    pub(super) others: Vec<Phase>,
    /// What was done, in sentences.
    pub(super) said: Vec<String>,
}

impl Moving {
    /// Finds the rows of a log that are taken. `path` is the one that a file
    /// gives.
    pub(super) fn of(
        options: &Options,
        log: Log,
        crs: Option<&Crs>,
        path: Option<&Line>,
    ) -> Result<Self> {
        let places = plane::places(&log, crs, path)?;
        let mut said = log.said.clone();
        said.push(told_places(&log, crs));
        let level = by_positions(&log, &places);
        let speeds = speeds(&log, &level, &mut said);
        let (phase, others) = moving(options, &log, &speeds, &mut said)?;
        Ok(Self { log, places, speeds, level, phase, others, said })
    }

    /// The rows that are taken.
    pub(super) fn rows(&self) -> &[Fix] {
        self.log.fixes.get(self.phase.first..=self.phase.last).unwrap_or(&[])
    }

    /// Their places \[m\].
    pub(super) fn taken(&self) -> &[Place] {
        self.places.get(self.phase.first..=self.phase.last).unwrap_or(&[])
    }

    /// Seconds from the log's first row to the first that is taken.
    pub(super) fn begin(&self) -> f64 {
        self.rows().first().map_or(0.0, |fix| fix.time)
    }

    /// Seconds from the log's first row to the last that is taken.
    pub(super) fn end(&self) -> f64 {
        self.rows().last().map_or(0.0, |fix| fix.time)
    }

    /// The times of the rows that are taken, from the first \[s\].
    pub(super) fn times(&self) -> Vec<f64> {
        let begin = self.begin();
        self.rows().iter().map(|fix| fix.time - begin).collect()
    }
}

fn told_places(log: &Log, crs: Option<&Crs>) -> String {
    match (log.frame, crs) {
        (Frame::Degrees, Some(crs)) => {
            format!("Longitudes and latitudes were brought to {}.", crs.name)
        }
        (Frame::Along, _) => {
            "The distances were taken as horizontal ones along the path, from \
             its first point."
                .to_owned()
        }
        _ => format!(
            "The {}'s x and y were taken as metres on the projection of \
             terrain and path.",
            log.word()
        ),
    }
}

/// Horizontal speeds by positions: the slope of a line fitted to those near
/// in time, and at least to those before and after.
fn by_positions(log: &Log, places: &[Place]) -> Vec<f64> {
    let times: Vec<f64> = log.fixes.iter().map(|fix| fix.time).collect();
    let over_time = |of: fn(&Place) -> f64| -> Vec<(f64, f64)> {
        times.iter().copied().zip(places.iter().map(of)).collect()
    };
    let (x, y) = (over_time(|p| p.0), over_time(|p| p.1));
    let speed = |i: usize| {
        let before = times[i] - times[i.saturating_sub(1)];
        let after = times[(i + 1).min(times.len() - 1)] - times[i];
        let half = SPEED_HALF.max(1.5 * before.max(after));
        let (x, y) = (fit(&x, times[i], half)?, fit(&y, times[i], half)?);
        Some(x.slope.hypot(y.slope))
    };
    (0..times.len()).map(|i| speed(i).unwrap_or(f64::NAN)).collect()
}

/// The speeds of the log's own kind.
fn speeds(log: &Log, level: &[f64], said: &mut Vec<String>) -> Vec<f64> {
    let own = || {
        let own = log.fixes.iter().zip(level);
        own.map(|(fix, l)| fix.speed.unwrap_or(*l)).collect()
    };
    let (says, speeds) = match log.kind {
        SpeedKind::Front => (
            "The recording is distances along the slope since t = 0, which \
             are as independent as the positions are. The mean speeds \
             between positions (Heredia et al. 2020, equation 13) stand \
             beside them where the times are even.",
            level.to_vec(),
        ),
        SpeedKind::Positions => (
            "The log has no speeds: they were worked out from its positions \
             and divided by the cosine of the track's slope.",
            level.to_vec(),
        ),
        SpeedKind::Whole => (
            "Speeds are the receiver's own: the length of its velocity to \
             the north, to the east and down.",
            own(),
        ),
        SpeedKind::Along if log.is_simulated => (
            "Speeds are the simulation's own, taken as those along the slope.",
            own(),
        ),
        SpeedKind::Along => (
            "Speeds are the receiver's own, taken as those along the slope.",
            own(),
        ),
        SpeedKind::Ground => (
            "Speeds are the receiver's own over ground, divided by the \
             cosine of the track's slope.",
            own(),
        ),
    };
    said.push(says.to_owned());
    speeds
}

/// The rows that are taken, and other stretches above the threshold.
fn moving(
    options: &Options,
    log: &Log,
    speeds: &[f64],
    said: &mut Vec<String>,
) -> Result<(Phase, Vec<Phase>)> {
    let times: Vec<f64> = log.fixes.iter().map(|fix| fix.time).collect();
    let at = |name: &str, text: &Option<String>| {
        text.as_deref().map(|text| log.moment(name, text)).transpose()
    };
    let (from, to) = (at("--from", &options.from)?, at("--to", &options.to)?);
    if let Some((from, to)) = from.zip(to).filter(|(from, to)| from >= to) {
        return Err(Error::input(format!(
            "--from: is {from:.2} s after the first row of {}, and --to is \
             {to:.2} s; expected a beginning before the end: change one of \
             them",
            place(&log.path)
        )));
    }
    let found = stretches(&times, speeds, options.threshold);
    let is_asked = from.or(to).is_some();
    let (phase, others) = if is_asked {
        (between(&times, from, to), Vec::new())
    } else {
        let others = found.as_ref().map(|f| f.others.clone());
        let wide = |f| widened(&times, f, options.margin);
        (found.map(|f| wide(f.longest)), others.unwrap_or_default())
    };
    let rows = phase.map_or(0, |phase| phase.last - phase.first + 1);
    let Some(phase) = phase.filter(|_| rows >= FEWEST) else {
        return Err(too_few(options, log, speeds, rows));
    };
    said.push(told_phase(options, log, &times, phase, is_asked));
    Ok((phase, others))
}

fn too_few(
    options: &Options,
    log: &Log,
    speeds: &[f64],
    rows: usize,
) -> Error {
    let top = speeds.iter().copied().fold(0.0, f64::max);
    let end = log.fixes.last().map_or(0.0, |fix| fix.time);
    let mend = match options.from.is_some() || options.to.is_some() {
        true => "change --from and --to".to_owned(),
        false => format!(
            "change --threshold ({} m/s), or give --from and --to",
            options.threshold
        ),
    };
    Error::input(format!(
        "{}: {rows} rows are in the part that would be taken; expected at \
         least {FEWEST}: the {} lasts {end:.1} s and its top speed is \
         {top:.2} m/s; {mend}",
        place(&log.path),
        log.word(),
    ))
}

fn told_phase(
    options: &Options,
    log: &Log,
    times: &[f64],
    phase: Phase,
    is_asked: bool,
) -> String {
    let (from, to) = (times[phase.first], times[phase.last]);
    let rows = phase.last - phase.first;
    let cut = format!(
        "The event is the {} from {from:.2} to {to:.2} s after its first row: \
         {rows} values over {:.2} s, and the speed at t = 0",
        log.word(),
        to - from
    );
    match (is_asked, options.margin) {
        (true, _) => format!("{cut}, as --from and --to say."),
        (false, margin) => {
            let more = match margin {
                0.0 => String::new(),
                margin => format!(", and {margin} s before and after"),
            };
            format!(
                "{cut}. This is the longest stretch above {} m/s, with the \
                 row before it{more}; rests of less than {REST} s within it \
                 are kept.",
                options.threshold
            )
        }
    }
}
