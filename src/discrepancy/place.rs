//! Where the mismatch is, as it is told: stretches with force and sign.

use super::diagnosis::{Mismatch, Pictured, Verdict};
use super::locate::{FreeForce, Stretch};
use crate::change::Reach;
use crate::observe::Event;
use crate::physics::forces::Axis;

/// Runs of the free-form force nearer than this are one \[m\].
const NEAR: f64 = 25.0;

/// The stretches in which simulation and recording differ: where a selected
/// mechanism is confined, its edges; else the hull of the runs in which the
/// free-form force's band leaves zero out, those nearby joined. Empty only if
/// nothing is missing.
pub(super) fn mismatch(
    verdict: Verdict,
    reaches: &[Reach],
    forces: &[FreeForce],
    event: &Event,
    pictured: &Pictured,
) -> Vec<Mismatch> {
    if verdict == Verdict::Adequate {
        return Vec::new();
    }
    let along = |axis: Axis| forces.iter().find(|f| f.axis == axis);
    let course = Course::new(event, pictured);
    if !reaches.is_empty() {
        return reaches
            .iter()
            .filter_map(|reach| {
                let force = along(reach.axis)?;
                let end = course.end(reach.axis);
                let stretch = Stretch {
                    from: reach.from,
                    to: reach.to.min(end).max(reach.from),
                };
                Some(course.mismatch(force, stretch, Vec::new()))
            })
            .collect();
    }
    let Some(force) = along(Axis::Place) else { return Vec::new() };
    let mut runs = force.runs();
    if runs.is_empty() {
        runs.push(force.strongest());
    }
    joined(&runs)
        .into_iter()
        .map(|(stretch, parts)| course.mismatch(force, stretch, parts))
        .collect()
}

/// Runs nearer than [`NEAR`] as one, with what they are made of.
fn joined(runs: &[Stretch]) -> Vec<(Stretch, Vec<Stretch>)> {
    let mut joined: Vec<(Stretch, Vec<Stretch>)> = Vec::new();
    for run in runs {
        match joined.last_mut() {
            Some((hull, parts)) if run.from - hull.to < NEAR => {
                hull.to = run.to;
                parts.push(*run);
            }
            _ => joined.push((*run, vec![*run])),
        }
    }
    joined
}

/// When the mass is where, by the corrected model.
struct Course<'a> {
    event: &'a Event,
    times: Vec<f64>,
    places: Vec<f64>,
}

impl<'a> Course<'a> {
    fn new(event: &'a Event, pictured: &Pictured) -> Self {
        let start = event.track().origin() + event.start();
        let mut times = vec![0.0];
        let mut places = vec![start];
        for (&t, &s) in pictured.times.iter().zip(&pictured.places) {
            if t > 0.0 {
                times.push(t);
                places.push(s.max(places[places.len() - 1]));
            }
        }
        Self { event, times, places }
    }

    fn end(&self, axis: Axis) -> f64 {
        let of = if axis == Axis::Time { &self.times } else { &self.places };
        of[of.len() - 1]
    }

    fn time_at(&self, place: f64) -> f64 {
        between(&self.places, &self.times, place)
    }

    fn place_at(&self, time: f64) -> f64 {
        between(&self.times, &self.places, time)
    }

    fn mismatch(
        &self,
        force: &FreeForce,
        stretch: Stretch,
        parts: Vec<Stretch>,
    ) -> Mismatch {
        let (times, places) = match force.axis {
            Axis::Time => {
                let place =
                    [stretch.from, stretch.to].map(|t| self.place_at(t));
                ([stretch.from, stretch.to], place)
            }
            _ => {
                let time = [stretch.from, stretch.to].map(|s| self.time_at(s));
                (time, [stretch.from, stretch.to])
            }
        };
        let mut drawn = force.over(stretch);
        drawn.sort_by(f64::total_cmp);
        let mean = drawn.iter().sum::<f64>() / drawn.len() as f64;
        let at = |p: f64| drawn[(p * (drawn.len() - 1) as f64) as usize];
        let same = drawn.iter().filter(|f| **f * mean > 0.0).count();
        let middle = 0.5 * (places[0] + places[1]);
        let track = self.event.track();
        let piece = track.piece_at((middle - track.origin()).max(0.0));
        let load = track.pieces()[piece].load;
        Mismatch {
            axis: force.axis,
            from: stretch.from,
            to: stretch.to,
            time_from: times[0],
            time_to: times[1],
            place_from: places[0],
            place_to: places[1],
            specific_force: mean,
            specific_force_q05: at(0.05),
            specific_force_q95: at(0.95),
            delta_mu: if load > 0.0 { -mean / load } else { f64::NAN },
            probability: same as f64 / drawn.len() as f64,
            parts: parts
                .into_iter()
                .map(|part| {
                    let over = force.over(part);
                    let mean = over.iter().sum::<f64>() / over.len() as f64;
                    (part.from, part.to, mean)
                })
                .collect(),
        }
    }
}

/// Linear between points whose x do not decrease; the ends beyond.
fn between(x: &[f64], y: &[f64], at: f64) -> f64 {
    let i = x.partition_point(|&x| x < at);
    if i == 0 {
        return y[0];
    }
    if i == x.len() {
        return y[y.len() - 1];
    }
    let step = x[i] - x[i - 1];
    let share = if step > 0.0 { (at - x[i - 1]) / step } else { 0.0 };
    y[i - 1] + share * (y[i] - y[i - 1])
}
