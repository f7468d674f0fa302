//! Where the mismatch is, as it is told: stretches with force and sign.

use crate::diagnosis::compare::checks::recordings;
use crate::diagnosis::decide::added::{Added, Passing};
use crate::diagnosis::findings::{Diagnosis, Mismatch, Pictured, Verdict};
use crate::diagnosis::locate::{FreeForce, Stretch};
use crate::mechanism::Reach;
use crate::observe::Event;
use crate::physics::forces::Axis;

/// Runs of the free-form force nearer than this are one \[m\].
const NEAR: f64 = 25.0;

/// The stretches in which simulation and recording differ, as a force: that of
/// each selected term where it is confined to, or where its 90 % band leaves
/// zero out; of what no mechanism describes that of the free-form force, where
/// its band does. Empty where no force is missing.
pub(crate) fn mismatch(
    verdict: Verdict,
    added: &[Added<'_>],
    forces: &[FreeForce],
    events: &[&Event],
    pictured: &[Pictured],
) -> Vec<Mismatch> {
    let courses = Courses::new(events, pictured);
    let told = match verdict {
        Verdict::MissingPhysics => {
            let terms = added.iter().filter(|term| term.is_force());
            terms.flat_map(|term| courses.of_term(term)).collect()
        }
        Verdict::Unexplained => courses.of_force(forces),
        _ => Vec::new(),
    };
    // Of what may have either sign none is told.
    let has_sign =
        |m: &Mismatch| m.specific_force_q05 * m.specific_force_q95 > 0.0;
    told.into_iter().filter(has_sign).collect()
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
        let number = |event: &Event| {
            let mut all = events.iter();
            all.position(|one| std::ptr::eq(*one, event)).unwrap_or(0)
        };
        let course = |((event, _), p): ((&'a Event, _), _)| {
            Course::new(number(event), event, p)
        };
        Self(owners.map(course).collect())
    }

    /// Where or when the last of them ends.
    fn end(&self, axis: Axis) -> f64 {
        let ends = self.0.iter().map(|course| course.ends(axis)[1]);
        ends.fold(f64::NEG_INFINITY, f64::max)
    }

    /// The free-form force over distance where its band leaves zero out, runs
    /// nearby joined.
    fn of_force(&self, forces: &[FreeForce]) -> Vec<Mismatch> {
        let over_distance = forces.iter().find(|f| f.axis == Axis::Place);
        let Some(force) = over_distance else { return Vec::new() };
        let mut runs = force.runs();
        if runs.is_empty() {
            runs.push(force.strongest());
        }
        let tell = |(stretch, parts): (Stretch, Vec<Stretch>)| {
            let (_, course) = self.covering(force.axis, stretch)?;
            let part = |p: &Stretch| (p.from, p.to, mean(&force.over(*p)));
            Some(Mismatch {
                parts: parts.iter().map(part).collect(),
                ..course.mismatch(force.axis, stretch, &force.over(stretch))
            })
        };
        joined(&runs).into_iter().filter_map(tell).collect()
    }

    /// The force of a term: where it is confined to, or wherever its sign is
    /// known.
    fn of_term(&self, term: &Added<'_>) -> Vec<Mismatch> {
        if let Some(Reach { axis, from, to }) = term.reach() {
            let to = to.min(self.end(axis)).max(from);
            let stretch = Stretch { from, to };
            let covering = self.covering(axis, stretch);
            let tell = |(event, course): (usize, &Course)| {
                let forces = term.forces(event, &course.within(axis, stretch));
                course.mismatch(axis, stretch, &means(&forces))
            };
            return covering.map(tell).into_iter().collect();
        }
        let everywhere =
            Stretch { from: f64::NEG_INFINITY, to: f64::INFINITY };
        let Some((event, course)) = self.covering(Axis::Place, everywhere)
        else {
            return Vec::new();
        };
        let forces = term.forces(event, &course.way);
        let sides = [1.0, -1.0].into_iter();
        let told = sides.filter_map(|side| course.side(&forces, side));
        told.collect()
    }

    /// The course that covers most of a stretch, the first of equals, with
    /// the number of its event.
    fn covering(
        &self,
        axis: Axis,
        stretch: Stretch,
    ) -> Option<(usize, &Course<'a>)> {
        let covered = |course: &Course| {
            let [first, last] = course.ends(axis);
            stretch.to.min(last) - stretch.from.max(first)
        };
        let most = |best, other| match covered(other) > covered(best) {
            true => other,
            false => best,
        };
        let course = self.0.iter().reduce(most)?;
        Some((course.number, course))
    }
}

/// When one mass is where.
struct Course<'a> {
    /// Which of the events.
    number: usize,
    event: &'a Event,
    times: Vec<f64>,
    places: Vec<f64>,
    /// The same with speeds and the ground.
    way: Vec<Passing>,
}

impl<'a> Course<'a> {
    fn new(number: usize, event: &'a Event, pictured: &Pictured) -> Self {
        let start = event.track().origin() + event.start();
        let mut times = vec![event.clock()];
        let mut places = vec![start];
        for (&t, &s) in pictured.times.iter().zip(&pictured.places) {
            if t > event.clock() {
                times.push(t);
                places.push(s.max(places[places.len() - 1]));
            }
        }
        let way = way(event, &times, &places);
        Self { number, event, times, places, way }
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

    /// The points of the way within a stretch, or the nearest one.
    fn within(&self, axis: Axis, stretch: Stretch) -> Vec<Passing> {
        let at = |p: &Passing| match axis {
            Axis::Time => p.time,
            _ => p.place,
        };
        let inside =
            |p: &&Passing| (stretch.from..stretch.to).contains(&at(p));
        let all: Vec<Passing> =
            self.way.iter().filter(inside).copied().collect();
        if !all.is_empty() {
            return all;
        }
        let middle = 0.5 * (stretch.from + stretch.to);
        let off = |p: &&Passing| (at(p) - middle).abs();
        let nearest = self.way.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        // Moved there: between two values the term acts nowhere else.
        nearest.map(|p| self.moved(*p, axis, middle)).into_iter().collect()
    }

    fn moved(&self, at: Passing, axis: Axis, to: f64) -> Passing {
        match axis {
            Axis::Time => Passing { time: to, place: self.place_at(to), ..at },
            _ => Passing { place: to, time: self.time_at(to), ..at },
        }
    }

    /// The hull of the points at which draws of a force have one sign, 90 % of
    /// them in all.
    fn side(&self, forces: &[Vec<f64>], sign: f64) -> Option<Mismatch> {
        let known = |i: &usize| {
            let at: Vec<f64> = forces.iter().map(|f| f[*i] * sign).collect();
            quantile(at, 0.05) > 0.0
        };
        let all: Vec<usize> = (0..self.way.len()).filter(known).collect();
        let (first, last) = (*all.first()?, *all.last()?);
        let (from, to) = (self.way[first].place, self.way[last].place);
        let over = |draw: &Vec<f64>| {
            all.iter().map(|i| draw[*i]).sum::<f64>() / all.len() as f64
        };
        let drawn: Vec<f64> = forces.iter().map(over).collect();
        let stretch = Stretch { from, to };
        Some(self.mismatch(Axis::Place, stretch, &drawn))
    }

    /// What is told of a stretch with draws of the mean force there.
    fn mismatch(
        &self,
        axis: Axis,
        stretch: Stretch,
        drawn: &[f64],
    ) -> Mismatch {
        let ends = [stretch.from, stretch.to];
        let (times, places) = match axis {
            Axis::Time => (ends, ends.map(|t| self.place_at(t))),
            _ => (ends.map(|s| self.time_at(s)), ends),
        };
        let force = mean(drawn);
        let same = drawn.iter().filter(|f| **f * force > 0.0).count();
        let load = self.load(0.5 * (places[0] + places[1]));
        Mismatch {
            axis,
            from: stretch.from,
            to: stretch.to,
            time_from: times[0],
            time_to: times[1],
            place_from: places[0],
            place_to: places[1],
            specific_force: force,
            specific_force_q05: quantile(drawn.to_vec(), 0.05),
            specific_force_q95: quantile(drawn.to_vec(), 0.95),
            delta_mu: if load > 0.0 { -force / load } else { f64::NAN },
            probability: same as f64 / drawn.len() as f64,
            parts: Vec::new(),
        }
    }

    /// The load of the ground at a place \[m/s2\].
    fn load(&self, place: f64) -> f64 {
        let track = self.event.track();
        let piece = track.piece_at((place - track.origin()).max(0.0));
        track.pieces()[piece].load
    }
}

/// The points of a way at some times, with the speeds between them.
fn way(event: &Event, times: &[f64], places: &[f64]) -> Vec<Passing> {
    let track = event.track();
    let last = times.len() - 1;
    let point = |i: usize| {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
        let lapse = (times[after] - times[before]).max(f64::MIN_POSITIVE);
        let on = (places[i] - track.origin()).max(0.0);
        let piece = track.piece_at(on);
        Passing {
            place: places[i],
            time: times[i],
            speed: (places[after] - places[before]) / lapse,
            site: event.path().site(piece, times[i]),
        }
    };
    (0..times.len()).map(point).collect()
}

/// The mean of each draw.
fn means(draws: &[Vec<f64>]) -> Vec<f64> {
    draws.iter().map(|draw| mean(draw)).collect()
}

fn quantile(mut values: Vec<f64>, p: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(p * (values.len() - 1) as f64) as usize]
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

/// Into how many steps a stretch is cut that is marked on a track.
const STEPS: i32 = 24;

/// Marks the mismatches on the tracks, as far as they go.
pub(crate) fn mark(diagnosis: &mut Diagnosis, events: &[&Event]) {
    let owners = recordings(events);
    for (pictured, (event, _)) in diagnosis.pictured.iter_mut().zip(owners) {
        let track = event.track();
        let stretches = diagnosis.mismatch.iter().map(|m| {
            let on = |place: f64| place - track.origin();
            let from = on(m.place_from).max(0.0);
            let to = on(m.place_to).min(track.length());
            if from > to {
                return Vec::new();
            }
            let share = |i: i32| f64::from(i) / f64::from(STEPS);
            let along = (0..=STEPS).map(|i| from + share(i) * (to - from));
            along.map(|place| track.position(place)).collect()
        });
        pictured.marked = stretches.collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::catalogue::find;
    use crate::observe::Series;
    use crate::physics::{GRAVITY, Track};

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

    /// What is told of a mechanism with one draw of its values.
    fn told(label: &str, values: &[f64]) -> Vec<Mismatch> {
        let (upper, of_upper) = event(0.0);
        let (lower, of_lower) = event(150.0);
        let found = find(label, &upper.extent(), &[]).unwrap();
        let n = values.len();
        let term = Added::new(found.as_ref(), &[values], 0..n, None);
        let verdict = Verdict::MissingPhysics;
        let pictured = [of_upper, of_lower];
        mismatch(verdict, &[term], &[], &[&upper, &lower], &pictured)
    }

    #[test]
    fn a_stretch_is_told_by_the_event_that_passes_it() {
        let load = GRAVITY * 20.0_f64.to_radians().cos();
        // Each mass is at `origin + 10 t`.
        for (from, to, begins, ends) in
            [(20.0, 60.0, 2.0, 6.0), (180.0, 220.0, 3.0, 7.0)]
        {
            let m = told("friction-patch", &[0.1, from, to - from]).remove(0);
            assert_eq!((m.from, m.to), (from, to));
            assert!((m.time_from - begins).abs() < 1e-9, "{}", m.time_from);
            assert!((m.time_to - ends).abs() < 1e-9, "{}", m.time_to);
            assert!((m.specific_force + 0.1 * load).abs() < 1e-9);
            assert!((m.delta_mu - 0.1).abs() < 1e-9);
        }
        // A step of the friction goes on to where the last mass does.
        assert_eq!(told("friction-step", &[0.1, 180.0]).remove(0).to, 250.0);
        // Shorter than the way between two values it is told all the same.
        let m = told("friction-patch", &[-0.2, 41.0, 2.0]).remove(0);
        assert!((m.specific_force - 0.2 * load).abs() < 1e-9);
    }

    #[test]
    fn a_force_without_edges_is_told_by_its_signs() {
        let all = told("turbulent-drag", &[0.003]);
        assert_eq!(all.len(), 1);
        // Of the first of equals, at 10 m/s all the way.
        assert_eq!((all[0].from, all[0].to), (0.0, 100.0));
        assert!((all[0].specific_force + 0.3).abs() < 1e-9);
        assert_eq!(told("turbulent-drag", &[0.0]).len(), 0);
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
        let begin = d.pictured[0].marked[0][0];
        assert!((begin.0 - x).abs() < 1e-9);
        assert!(d.pictured[1].marked[0].is_empty());
    }

    fn mismatched() -> Mismatch {
        told("friction-patch", &[0.1, 20.0, 40.0]).remove(0)
    }
}
