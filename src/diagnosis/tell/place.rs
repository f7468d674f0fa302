//! Where the mismatch is, as it is told: stretches with force and sign.

use crate::diagnosis::compare::checks::recordings;
use crate::diagnosis::findings::{Diagnosis, Mismatch, Pictured, Verdict};
use crate::diagnosis::locate::{FreeForce, Stretch};
use crate::mechanism::Reach;
use crate::observe::Event;
use crate::physics::forces::Axis;

/// Runs of the free-form force nearer than this are one \[m\].
const NEAR: f64 = 25.0;

/// The stretches in which simulation and recording differ: where a selected
/// mechanism is confined, its edges; else the hull of the runs in which the
/// free-form force's band leaves zero out, those nearby joined. Empty where no
/// force is missing.
pub(crate) fn mismatch(
    verdict: Verdict,
    reaches: &[Reach],
    forces: &[FreeForce],
    events: &[&Event],
    pictured: &[Pictured],
) -> Vec<Mismatch> {
    // Of what is of the start, the measurement or the errors no force is told.
    if !matches!(verdict, Verdict::MissingPhysics | Verdict::Unexplained) {
        return Vec::new();
    }
    let along = |axis: Axis| forces.iter().find(|f| f.axis == axis);
    let courses = Courses::new(events, pictured);
    if !reaches.is_empty() {
        return reaches
            .iter()
            .filter_map(|reach| {
                let force = along(reach.axis)?;
                let end = courses.end(reach.axis);
                let stretch = Stretch {
                    from: reach.from,
                    to: reach.to.min(end).max(reach.from),
                };
                courses.mismatch(force, stretch, &[])
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
        .filter_map(|(stretch, parts)| {
            courses.mismatch(force, stretch, &parts)
        })
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

/// When each recorded mass is where, by the corrected model.
struct Courses<'a>(Vec<Course<'a>>);

impl<'a> Courses<'a> {
    fn new(events: &[&'a Event], pictured: &[Pictured]) -> Self {
        let owners = recordings(events).into_iter().zip(pictured);
        Self(owners.map(|((event, _), p)| Course::new(event, p)).collect())
    }

    /// Where or when the last of them ends.
    fn end(&self, axis: Axis) -> f64 {
        let ends = self.0.iter().map(|course| course.ends(axis)[1]);
        ends.fold(f64::NEG_INFINITY, f64::max)
    }

    /// What is told of a stretch: times, and the load of the ground, by the
    /// course that covers most of it, the first of equals.
    fn mismatch(
        &self,
        force: &FreeForce,
        stretch: Stretch,
        parts: &[Stretch],
    ) -> Option<Mismatch> {
        let covered = |course: &Course| {
            let [first, last] = course.ends(force.axis);
            stretch.to.min(last) - stretch.from.max(first)
        };
        let most = |best, other| match covered(other) > covered(best) {
            true => other,
            false => best,
        };
        let course = self.0.iter().reduce(most)?;
        Some(course.mismatch(force, stretch, parts))
    }
}

/// When one mass is where.
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

    /// Where or when it begins and ends.
    fn ends(&self, axis: Axis) -> [f64; 2] {
        let of = if axis == Axis::Time { &self.times } else { &self.places };
        [of[0], of[of.len() - 1]]
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
        parts: &[Stretch],
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
        let at = |p: f64| drawn[(p * (drawn.len() - 1) as f64) as usize];
        let force_there = mean(&drawn);
        let same = drawn.iter().filter(|f| **f * force_there > 0.0).count();
        let load = self.load(0.5 * (places[0] + places[1]));
        let part =
            |part: &Stretch| (part.from, part.to, mean(&force.over(*part)));
        Mismatch {
            axis: force.axis,
            from: stretch.from,
            to: stretch.to,
            time_from: times[0],
            time_to: times[1],
            place_from: places[0],
            place_to: places[1],
            specific_force: force_there,
            specific_force_q05: at(0.05),
            specific_force_q95: at(0.95),
            delta_mu: if load > 0.0 { -force_there / load } else { f64::NAN },
            probability: same as f64 / drawn.len() as f64,
            parts: parts.iter().map(part).collect(),
        }
    }

    /// The load of the ground at a place \[m/s2\].
    fn load(&self, place: f64) -> f64 {
        let track = self.event.track();
        let piece = track.piece_at((place - track.origin()).max(0.0));
        track.pieces()[piece].load
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
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

/// Marks the mismatch on the tracks, as far as they go.
pub(crate) fn mark(diagnosis: &mut Diagnosis, events: &[&Event]) {
    let owners = recordings(events);
    for (pictured, (event, _)) in diagnosis.pictured.iter_mut().zip(owners) {
        let track = event.track();
        for m in &diagnosis.mismatch {
            let on = |place: f64| place - track.origin();
            let from = on(m.place_from).max(0.0);
            let to = on(m.place_to).min(track.length());
            if from > to {
                continue;
            }
            let steps = 24;
            pictured.marked.extend((0..=steps).map(|i| {
                let share = f64::from(i) / f64::from(steps);
                track.position(from + share * (to - from))
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::CELLS;
    use crate::diagnosis::locate::Process;
    use crate::observe::Series;
    use crate::physics::Track;

    /// A mass that goes at 10 m/s for 10 s from its track's first point.
    fn event(origin: f64) -> (Event, Pictured) {
        let times: Vec<f64> = (1..=10).map(f64::from).collect();
        let series = Series::velocity(times.clone(), vec![10.0; 10]).unwrap();
        let track = Track::incline(20.0, 200.0).unwrap().with_origin(origin);
        let event = Event::on(track).release(0.0, 10.0).velocity(series);
        let places = times.iter().map(|t| origin + 10.0 * t).collect();
        let pictured = Pictured { times, places, ..Pictured::default() };
        (event.build().unwrap(), pictured)
    }

    /// A brake of 1 m/s2 in every cell over 300 m.
    fn force() -> FreeForce {
        let step = 300.0 / CELLS as f64;
        FreeForce {
            axis: Axis::Place,
            at: (0..CELLS).map(|i| (i as f64 + 0.5) * step).collect(),
            mean: vec![-1.0; CELLS],
            sd: vec![0.1; CELLS],
            width: 2.0,
            draws: vec![vec![-1.0; CELLS]; 2],
            log_bayes_factor: 0.0,
            se: 0.0,
            own: vec![],
            spread: vec![],
            process: Process(0.0, 0.0),
        }
    }

    #[test]
    fn a_stretch_is_told_by_the_event_that_passes_it() {
        let (upper, of_upper) = event(0.0);
        let (lower, of_lower) = event(150.0);
        let pictured = [of_upper, of_lower];
        let told = |from: f64, to: f64| {
            let reach = Reach { axis: Axis::Place, from, to };
            let verdict = Verdict::MissingPhysics;
            let events = [&upper, &lower];
            mismatch(verdict, &[reach], &[force()], &events, &pictured)
                .remove(0)
        };
        // Each mass is at `origin + 10 t`.
        for (from, to, begins, ends) in
            [(20.0, 60.0, 2.0, 6.0), (180.0, 220.0, 3.0, 7.0)]
        {
            let m = told(from, to);
            assert_eq!((m.from, m.to), (from, to));
            assert!((m.time_from - begins).abs() < 1e-9, "{}", m.time_from);
            assert!((m.time_to - ends).abs() < 1e-9, "{}", m.time_to);
        }
        // A step of the friction goes on to where the last mass does.
        assert_eq!(told(180.0, f64::INFINITY).to, 250.0);
    }

    #[test]
    fn a_track_is_marked_where_it_has_the_stretch() {
        let (upper, of_upper) = event(0.0);
        let (lower, of_lower) = event(250.0);
        let m = Mismatch { place_from: 20.0, place_to: 60.0, ..mismatched() };
        let mut d = Diagnosis {
            mismatch: vec![m],
            pictured: vec![of_upper, of_lower],
            ..Diagnosis::default()
        };
        mark(&mut d, &[&upper, &lower]);
        let x = 20.0 * 20.0_f64.to_radians().cos();
        assert!((d.pictured[0].marked[0].0 - x).abs() < 1e-9);
        assert!(d.pictured[1].marked.is_empty());
    }

    fn mismatched() -> Mismatch {
        let (event, pictured) = event(0.0);
        let reach = Reach { axis: Axis::Place, from: 0.0, to: 1.0 };
        let verdict = Verdict::MissingPhysics;
        mismatch(verdict, &[reach], &[force()], &[&event], &[pictured])
            .remove(0)
    }
}
