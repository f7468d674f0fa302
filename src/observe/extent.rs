//! How large an event is, from its first recording.

use super::event::Event;
use super::series::{Quantity, path_length};
use crate::mechanism::Extent;

impl Event {
    /// The extent of its first recording.
    pub fn extent(&self) -> Extent {
        let Some(series) = self.recordings().next() else {
            return self.extent_of(&[], 1.0, true);
        };
        let times = series.times();
        // The mean over a window is one of speeds.
        let averages =
            series.quantity() == Quantity::Velocity && series.window() == 0.0;
        let speeds = self.speeds();
        let mut extent =
            self.extent_of(&speeds, series.grid().step(), averages);
        extent.duration = times.last().copied().unwrap_or(1.0).max(1e-3);
        extent.run = match series.quantity() {
            Quantity::Position => self.reach(series),
            _ => path_length(self.release_speed(), times, &speeds),
        }
        .max(1e-3);
        extent.bends = self.bends_until(extent.run);
        extent.rate_unit = series.quantity().rate_unit();
        extent
    }

    /// The speeds that its first recording shows \[m/s\].
    fn speeds(&self) -> Vec<f64> {
        let Some(series) = self.recordings().next() else { return Vec::new() };
        let times = series.times();
        match series.quantity() {
            Quantity::Velocity => series.values().to_vec(),
            Quantity::Position => rates(times, series.values()),
            Quantity::Acceleration => {
                sums(self.release_speed(), times, series.values())
            }
        }
    }

    fn extent_of(&self, speeds: &[f64], step: f64, averages: bool) -> Extent {
        let pieces = self.track().pieces();
        Extent {
            begin: self.track().origin() + self.start(),
            run: 1.0,
            since: self.clock(),
            duration: 1.0,
            speed: upper_quartile(speeds.to_vec()),
            step,
            behind: self.start(),
            start_speed: self.release_speed(),
            carried: pieces.iter().any(|piece| piece.load > 1e-6),
            bends: false,
            averages,
            rate_unit: Quantity::Velocity.rate_unit(),
        }
    }

    fn bends_until(&self, run: f64) -> bool {
        let (from, to) = (self.start(), self.start() + run);
        self.track()
            .pieces()
            .iter()
            .filter(|p| p.start + p.length > from && p.start < to)
            .any(|p| p.curvature.abs() > 1e-6)
    }
}

impl Extent {
    /// The extent of several events: from the least place to the greatest,
    /// and from the first moment to the last.
    pub fn of_all<'e>(events: impl Iterator<Item = &'e Event>) -> Self {
        let mut speeds = Vec::new();
        let extents = events.map(|event| {
            speeds.extend(event.speeds());
            event.extent()
        });
        let all = extents.reduce(|a, b| Self {
            begin: a.begin.min(b.begin),
            run: (a.begin + a.run).max(b.begin + b.run) - a.begin.min(b.begin),
            since: a.since.min(b.since),
            duration: (a.since + a.duration).max(b.since + b.duration)
                - a.since.min(b.since),
            speed: a.speed,
            step: a.step.min(b.step),
            behind: a.behind.min(b.behind),
            start_speed: a.start_speed.max(b.start_speed),
            carried: a.carried || b.carried,
            bends: a.bends || b.bends,
            averages: a.averages || b.averages,
            rate_unit: match a.rate_unit == b.rate_unit {
                true => a.rate_unit,
                false => "values/s",
            },
        });
        let speed = upper_quartile(speeds);
        match all {
            Some(all) => Self { speed, ..all },
            None => Self {
                begin: 0.0,
                run: 1.0,
                since: 0.0,
                duration: 1.0,
                speed,
                step: 1.0,
                behind: 0.0,
                start_speed: 0.0,
                carried: false,
                bends: false,
                averages: false,
                rate_unit: Quantity::Velocity.rate_unit(),
            },
        }
    }
}

/// The upper quartile \[m/s\], 0.1 at the least; 1 where there are none.
fn upper_quartile(mut speeds: Vec<f64>) -> f64 {
    speeds.sort_by(f64::total_cmp);
    let quartile = speeds.get(speeds.len() * 3 / 4).copied();
    quartile.unwrap_or(1.0).max(0.1)
}

/// Mean speeds between positions; the mass starts at 0.
fn rates(times: &[f64], positions: &[f64]) -> Vec<f64> {
    let mut before = (0.0, 0.0);
    let mut rates = Vec::with_capacity(times.len());
    for (&t, &s) in times.iter().zip(positions) {
        if t > before.0 {
            rates.push((s - before.1) / (t - before.0));
        }
        before = (t, s);
    }
    rates
}

/// Speeds from accelerations, by the trapezoidal rule.
fn sums(speed: f64, times: &[f64], accelerations: &[f64]) -> Vec<f64> {
    let (mut time, mut before) = (0.0, accelerations[0]);
    let mut speed = speed;
    let pairs = times.iter().zip(accelerations);
    pairs
        .map(|(&t, &a)| {
            speed += 0.5 * (a + before) * (t - time);
            (time, before) = (t, a);
            speed
        })
        .collect()
}
