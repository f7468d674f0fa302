//! The exact solution of the motion against an integration of the equations
//! of motion at tolerance 1e-12.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use crate::terrain::{any_track, random_track};
use couloir::Seed;
use couloir::physics::friction::{
    Cohesion, Coulomb, Curvature, Entrainment, Pcm, Viscous,
};
use couloir::physics::track::Piece;
use couloir::physics::{
    Friction, Path, Rate, Release, Site, State, Sum, Track, Varies, rest,
    sample,
};
use couloir::scalar::{Plain, Real};
use couloir::seed::Rng;
use nalgebra::Vector2;
use ode_solvers::{Dop853, OutputType, System};
use rand::RngExt;

/// The coefficients of r = mu max(0, load + p kappa u^2) + k0 + k1 u + k2 u^2.
#[derive(Debug, Clone, Copy)]
struct Drag {
    mu: f64,
    p: f64,
    k0: f64,
    k1: f64,
    k2: f64,
    growth: f64,
    /// Whether mu changes from piece to piece.
    patchy: bool,
}

impl Drag {
    fn mu_at(&self, piece: &Piece) -> f64 {
        let half = if piece.length.is_finite() { 0.5 } else { 0.0 };
        let middle = piece.start + half * piece.length.min(1e9);
        let wave = if self.patchy { (0.02 * middle).sin() } else { 0.0 };
        self.mu * (1.0 + 0.3 * wave)
    }

    /// The speed at which a bend lifts the mass off; infinite elsewhere.
    fn lift_off(&self, piece: &Piece) -> f64 {
        let lift = -self.p * piece.curvature;
        if lift > 0.0 { (piece.load / lift).sqrt() } else { f64::INFINITY }
    }

    /// du/dt with the mass on the bed or off it, continued smoothly to
    /// speeds where it is not, so that roots can be polished.
    fn acceleration(&self, piece: &Piece, u: f64, lifted: bool) -> f64 {
        let pressed = piece.load + self.p * piece.curvature * u * u;
        let load = if lifted { 0.0 } else { pressed };
        let quadratic = (self.k2 + self.growth) * u * u;
        piece.pull
            - self.mu_at(piece) * load
            - self.k0
            - self.k1 * u
            - quadratic
    }
}

/// The same for couloir, on a law that depends on the place.
impl Friction<Plain> for Drag {
    fn varies(&self) -> Varies {
        if self.patchy { Varies::WithPlace } else { Varies::Nowhere }
    }
    fn rate(&self, at: &Site, _: Real) -> Rate<Plain> {
        let wave = if self.patchy { (0.02 * at.distance).sin() } else { 0.0 };
        Rate {
            mu: (self.mu * (1.0 + 0.3 * wave)).into(),
            pressed: self.p.into(),
            constant: self.k0.into(),
            linear: self.k1.into(),
            quadratic: self.k2.into(),
            growth: self.growth.into(),
        }
    }
}

/// The same as a sum of couloir's own blocks.
fn blocks(drag: &Drag) -> impl Friction<Plain> + use<> {
    let n = Real::<Plain>::new;
    let dry = Sum::new(Coulomb { mu: n(drag.mu) }, Curvature { c: n(drag.p) });
    // PCM's own mu is 0 here; M/D is infinite where there is no drag.
    let drags = Sum::new(
        Pcm { mu: n(0.0), md: n(1.0 / drag.k2) },
        Viscous { k: n(drag.k1) },
    );
    let others = Sum::new(
        Cohesion { cohesion: n(drag.k0) },
        Entrainment { e: n(drag.growth) },
    );
    Sum::new(dry, Sum::new(drags, others))
}

/// One piece's equations of motion, s counted from the piece's start.
#[derive(Clone, Copy)]
struct Equations<'a> {
    drag: &'a Drag,
    piece: &'a Piece,
    lifted: bool,
    /// The place \[m\] and the speed \[m/s\] at which to stop.
    until: f64,
    threshold: f64,
}

impl System<f64, Vector2<f64>> for Equations<'_> {
    fn system(&self, _: f64, y: &Vector2<f64>, dy: &mut Vector2<f64>) {
        *dy = Vector2::new(y[1], self.acceleration(y[1]));
    }
    fn solout(&mut self, _: f64, y: &Vector2<f64>, _: &Vector2<f64>) -> bool {
        y[0] >= self.until || y[1] < 0.0 || self.passes(y[1]) > 0.0
    }
}

impl Equations<'_> {
    fn acceleration(&self, u: f64) -> f64 {
        self.drag.acceleration(self.piece, u, self.lifted)
    }

    /// How far the speed is past the one where the bed takes or leaves.
    fn passes(&self, u: f64) -> f64 {
        if self.lifted { self.threshold - u } else { u - self.threshold }
    }

    /// The same without an end.
    fn endless(self) -> Self {
        let threshold = if self.lifted { -1e9 } else { f64::INFINITY };
        Self { until: f64::INFINITY, threshold, ..self }
    }

    /// Time and state after `time`, or at the first step past the end.
    fn run(self, from: Vector2<f64>, time: f64) -> (f64, Vector2<f64>) {
        if time <= 0.0 {
            return (0.0, from);
        }
        let mut solver =
            Dop853::new(self, 0.0, time, time, from, 1e-12, 1e-12);
        solver.set_output(OutputType::Sparse);
        solver.integrate().expect("a smooth equation");
        let last = solver.x_out().len() - 1;
        (solver.x_out()[last], solver.y_out()[last])
    }

    /// The time in (0, high) at which f, which rises there, is 0: Newton's
    /// method in its bracket, each time integrating from the piece's start.
    fn root(
        self,
        from: Vector2<f64>,
        high: f64,
        f: impl Fn(Vector2<f64>) -> (f64, f64),
    ) -> (f64, Vector2<f64>) {
        let free = self.endless();
        let (mut low, mut high, mut t) = (0.0, high, high);
        for _ in 0..60 {
            let (value, slope) = f(free.run_on(from, t));
            if value > 0.0 {
                high = t
            } else {
                low = t
            }
            let next = t - value / slope;
            let inside = next >= low && next <= high;
            let next = if inside { next } else { 0.5 * (low + high) };
            let done = (next - t).abs() <= 1e-15 * (1.0 + t);
            t = next;
            if done {
                break;
            }
        }
        (t, free.run_on(from, t))
    }

    /// The state after exactly `time`, going on below u = 0.
    fn run_on(self, from: Vector2<f64>, time: f64) -> Vector2<f64> {
        let (mut done, mut y) = self.run(from, time);
        while done < time {
            let (more, next) = self.run(y, time - done);
            (done, y) = (done + more, next);
        }
        y
    }
}

/// A stretch of the reference motion on one piece.
struct Leg {
    begins: f64,
    ends: f64,
    at: Place,
}

/// A piece, distance into it and speed, and whether the bed carries nothing.
#[derive(Clone, Copy)]
struct Place {
    piece: usize,
    from: Vector2<f64>,
    lifted: bool,
}

/// The reference motion up to a time.
struct Reference<'a> {
    drag: &'a Drag,
    track: &'a Track,
    legs: Vec<Leg>,
    /// Time and distance at rest.
    rest: Option<(f64, f64)>,
    /// The least speed at which a border was crossed: errors grow there as
    /// its inverse.
    slowest: f64,
    /// How hard the mass braked when it stopped \[m/s2\].
    brake: f64,
}

impl<'a> Reference<'a> {
    fn new(
        drag: &'a Drag,
        track: &'a Track,
        (s, u): (f64, f64),
        until: f64,
    ) -> Self {
        let mut motion = Self {
            drag,
            track,
            legs: Vec::new(),
            rest: None,
            slowest: f64::INFINITY,
            brake: 0.0,
        };
        let piece = track.piece_at(s);
        let mut next = Some((
            0.0,
            motion.enter(piece, s - track.pieces()[piece].start, u),
        ));
        while let Some((begins, at)) = next {
            next = motion.leg(begins, at, until);
        }
        motion
    }

    fn enter(&self, piece: usize, s: f64, u: f64) -> Place {
        let threshold = self.drag.lift_off(&self.track.pieces()[piece]);
        let lifted = u > threshold;
        Place { piece, from: Vector2::new(s, u.max(0.0)), lifted }
    }

    fn equations(&self, at: &Place) -> Equations<'a> {
        let piece = &self.track.pieces()[at.piece];
        Equations {
            drag: self.drag,
            piece,
            lifted: at.lifted,
            until: piece.length,
            threshold: self.drag.lift_off(piece),
        }
    }

    /// Adds the leg that begins here; where the next one does, if any.
    fn leg(
        &mut self,
        begins: f64,
        at: Place,
        until: f64,
    ) -> Option<(f64, Place)> {
        let here = self.equations(&at);
        let (from, length) = (at.from, here.piece.length);
        if from[1] <= 0.0 && here.acceleration(0.0) <= 0.0 {
            self.rest = Some((begins, here.piece.start + from[0]));
            self.brake = -here.acceleration(0.0);
            return None;
        }
        let (mut last, mut y) = here.run(from, until - begins);
        let mut end = None;
        if here.passes(y[1]) > 0.0 {
            let sign = if at.lifted { -1.0 } else { 1.0 };
            (last, y) = here.root(from, last, |y| {
                (here.passes(y[1]), sign * here.acceleration(y[1]))
            });
            end = Some(Place { from: y, lifted: !at.lifted, ..at });
        }
        if y[1] < 0.0 {
            (last, y) =
                here.root(from, last, |y| (-y[1], -here.acceleration(y[1])));
            end = Some(Place { from: Vector2::new(y[0], 0.0), ..at });
        }
        if y[0] >= length {
            (last, y) = here.root(from, last, |y| (y[0] - length, y[1]));
            self.slowest = self.slowest.min(y[1]);
            end = Some(self.enter(at.piece + 1, 0.0, y[1]));
        }
        let ends = begins + last;
        self.legs.push(Leg { begins, ends, at });
        end.map(|at| (ends, at))
    }

    /// Distance, speed and acceleration at a time.
    fn at(&self, time: f64) -> (f64, f64, f64) {
        let next = self.legs.partition_point(|leg| leg.ends <= time);
        let Some(leg) = self.legs.get(next) else {
            let (_, place) = self.rest.expect("the reference goes further");
            return (place, 0.0, 0.0);
        };
        let here = self.equations(&leg.at);
        let y = here.endless().run_on(leg.at.from, time - leg.begins);
        (here.piece.start + y[0], y[1], here.acceleration(y[1]))
    }

    /// How near a time is to one at which the acceleration jumps \[s\].
    fn jump_near(&self, time: f64) -> f64 {
        let near = self.legs.iter().map(|leg| (leg.ends - time).abs());
        near.fold(f64::INFINITY, f64::min)
    }
}

/// Now one, now another: nothing, next to nothing, or up to `most`.
fn amount(rng: &mut Rng, most: f64) -> f64 {
    match rng.random_range(0..5) {
        0 | 1 => 0.0,
        2 => 10.0_f64.powf(rng.random_range(-12.0..-5.0)),
        _ => most * rng.random_range(0.0_f64..1.0).powi(2),
    }
}

fn any_drag(rng: &mut Rng) -> Drag {
    let bent = rng.random_bool(0.4);
    Drag {
        mu: [0.0, rng.random_range(0.0..0.7)]
            [usize::from(rng.random_bool(0.9))],
        p: if bent { rng.random_range(0.2..1.5) } else { 0.0 },
        k0: amount(rng, 3.0),
        k1: amount(rng, 0.3),
        k2: amount(rng, 0.2),
        growth: amount(rng, 0.02),
        patchy: rng.random_bool(0.3),
    }
}

/// The largest errors met, for the report that a failure prints.
#[derive(Debug, Default)]
struct Worst {
    speed: f64,
    distance: f64,
    acceleration: f64,
    stop: f64,
    compared: usize,
    lifts: usize,
    stops: usize,
    grazing: usize,
}

/// What speeds \[m/s\], distances \[m\] and accelerations \[m/s2\] may differ
/// by: the reference's own error, some hundred steps at 1e-12 of up to 1e4 m.
const SMALL: f64 = 1e-8;

impl Worst {
    fn states(
        &mut self,
        motion: &Reference<'_>,
        times: &[f64],
        found: &[State<Plain>],
    ) {
        for (&time, state) in times.iter().zip(found) {
            let (s, u, a) = motion.at(time);
            self.speed = self.speed.max((state.speed.value() - u).abs());
            self.distance =
                self.distance.max((state.distance.value() - s).abs());
            // Across a border the acceleration jumps: not within round-off.
            if motion.jump_near(time) > 1e-6 {
                let error = (state.acceleration.value() - a).abs();
                self.acceleration = self.acceleration.max(error);
            }
            self.compared += 1;
        }
    }

    fn assert_small(&self, case: &dyn std::fmt::Debug) {
        assert!(self.speed <= SMALL, "{self:?}\n{case:?}");
        assert!(self.distance <= SMALL, "{self:?}\n{case:?}");
        assert!(self.acceleration <= SMALL, "{self:?}\n{case:?}");
        assert!(self.stop <= 1.0, "{self:?}\n{case:?}");
    }
}

/// Solves one case both ways.
fn compare<L: Friction<Plain>>(
    worst: &mut Worst,
    (drag, law): (&Drag, &L),
    track: &Track,
    start: (f64, f64),
    times: &[f64],
) {
    let until = 300.0_f64.max(times[times.len() - 1] + 1.0);
    let motion = Reference::new(drag, track, start, until);
    // Errors grow as the inverse of the speed over a crest, in any solver.
    if motion.slowest < 1e-2 {
        worst.grazing += 1;
        return;
    }
    worst.lifts += motion.legs.iter().filter(|leg| leg.at.lifted).count();
    let path = Path::new(track, 1.0);
    let release = Release { distance: start.0.into(), speed: start.1.into() };
    let mut found = Vec::new();
    sample(&path, law, release, times, false, |s| found.push(s)).unwrap();
    worst.states(&motion, times, &found);
    let mut speeds = Vec::new();
    sample(&path, law, release, times, true, |s| speeds.push(s)).unwrap();
    for (alone, state) in speeds.iter().zip(&found) {
        assert_eq!(alone.speed, state.speed);
    }
    let stopped = rest(&path, law, release).unwrap();
    match (motion.rest, stopped) {
        (Some((time, place)), Some(found)) => {
            // A stop is as uncertain as the speed, over the braking.
            let bound = 1e-7_f64.max(SMALL / motion.brake);
            let late = (found.time.value() - time).abs() / bound;
            let far = (found.distance.value() - place).abs() / SMALL;
            worst.stop = worst.stop.max(late).max(far);
            worst.stops += 1;
        }
        (Some(rest), None) => panic!("{rest:?} is never reached"),
        (None, Some(rest)) => assert!(rest.time > until, "{rest:?}"),
        (None, None) => {}
    }
}

fn times(rng: &mut Rng, until: f64) -> Vec<f64> {
    let mut times: Vec<f64> =
        (0..12).map(|_| rng.random_range(0.0..until)).collect();
    times.sort_by(f64::total_cmp);
    times
}

fn any_start(rng: &mut Rng, track: &Track) -> (f64, f64) {
    let place = track.length() * rng.random_range(0.0..1.0);
    match rng.random_range(0..4) {
        0 => (0.0, 0.0),
        1 => (place, 0.0),
        _ => (place * 0.3, rng.random_range(0.1..80.0)),
    }
}

#[test]
fn a_thousand_motions_are_the_integrated_ones() {
    let mut worst = Worst::default();
    for case in 0..1000 {
        let mut rng = Seed::new(11).child(case).rng();
        let track = any_track(&mut rng);
        let drag = any_drag(&mut rng);
        let start = any_start(&mut rng, &track);
        let until = rng.random_range(3.0..60.0);
        let times = times(&mut rng, until);
        if drag.patchy {
            compare(&mut worst, (&drag, &drag), &track, start, &times);
        } else {
            let law = blocks(&drag);
            compare(&mut worst, (&drag, &law), &track, start, &times);
        }
        worst.assert_small(&(case, &drag, start, track.pieces().len()));
    }
    assert!(worst.grazing < 20 && worst.stops > 300, "{worst:?}");
    assert!(worst.lifts > 300, "{worst:?}");
}

#[test]
fn ten_thousand_pieces_are_crossed_without_drift() {
    let mut worst = Worst::default();
    for case in 0..3 {
        let mut rng = Seed::new(12).child(case).rng();
        let track = random_track(&mut rng, 10_000, 2.0, (15.0, 40.0));
        let mut drag = any_drag(&mut rng);
        (drag.mu, drag.k2, drag.patchy) = (0.2, 0.01, case == 2);
        (drag.p, drag.k1) = ([0.0, 1.0, 0.0][case as usize], 0.0);
        let times = times(&mut rng, 400.0);
        compare(&mut worst, (&drag, &drag), &track, (0.0, 0.0), &times);
        worst.assert_small(&(case, &drag));
    }
}

#[test]
fn long_pieces_are_crossed_at_the_terminal_speed() {
    // 2 C l up to 500: exp(-2 C l) is far below round-off.
    let mut worst = Worst::default();
    for case in 0..200 {
        let mut rng = Seed::new(13).child(case).rng();
        let range = [(0.0, 1e-9), (10.0, 40.0)][case as usize % 2];
        let track = random_track(&mut rng, 3, 500.0, range);
        let mut drag = any_drag(&mut rng);
        drag.k2 = rng.random_range(0.02..0.5);
        (drag.mu, drag.k0) = (drag.mu * (case % 3) as f64 / 4.0, 0.0);
        let start = any_start(&mut rng, &track);
        let times = times(&mut rng, 200.0);
        compare(&mut worst, (&drag, &drag), &track, start, &times);
        worst.assert_small(&(case, &drag, start));
    }
}

#[test]
fn a_bottleneck_of_the_speed_is_passed() {
    // Viscous drag nearly balances the pull at one speed; beyond it a bend
    // unloads the bed and lifts the mass off: more than a quarter turn of
    // the tangent in the solution.
    let slope = |degrees: f64| degrees.to_radians().tan();
    let (x, mut z) = ([0.0, 1.0, 81.0, 82.0], [0.0; 4]);
    for (i, angle) in [-50.0, 45.0, 85.0].into_iter().enumerate() {
        z[i + 1] = z[i] - (x[i + 1] - x[i]) * slope(angle);
    }
    let track = Track::from_points(&x, &z).unwrap();
    let piece = track.pieces()[1];
    let mut drag = any_drag(&mut Seed::new(14).rng());
    (drag.mu, drag.p, drag.patchy) = (0.9, 3.0, false);
    (drag.k0, drag.k2, drag.growth) = (0.0, 0.0, 0.0);
    let a = piece.pull - 0.9 * piece.load;
    let c = 0.9 * 3.0 * piece.curvature;
    drag.k1 = 1.4 * (-a * c).sqrt();
    let start = (piece.start + 0.01, 0.3 * (-a / c).sqrt());
    let times: Vec<f64> = (1..120).map(|i| 0.25 * f64::from(i)).collect();
    let mut worst = Worst::default();
    compare(&mut worst, (&drag, &drag), &track, start, &times);
    worst.assert_small(&(piece, &drag, start));
    assert!(worst.lifts > 1, "{piece:?} {drag:?}");
}

/// A law that has forces fitted to it, whether or not that is needed.
struct Fitted<'a>(&'a Drag);

impl Friction<Plain> for Fitted<'_> {
    fn varies(&self) -> Varies {
        Varies::WithSpeed
    }
    fn rate(&self, at: &Site, speed: Real) -> Rate<Plain> {
        self.0.rate(at, speed)
    }
}

#[test]
fn fitted_laws_move_as_exact_ones_do() {
    // Each leg errs by 1e-12 at most, and errors add up over a few hundred of
    // them. Where a bend lifts the mass off, the force has a kink.
    let mut ends = 0;
    for case in 0..300 {
        let mut rng = Seed::new(15).child(case).rng();
        let track = any_track(&mut rng);
        let (drag, path) = (any_drag(&mut rng), Path::new(&track, 1.0));
        let (s, u) = any_start(&mut rng, &track);
        let release = Release { distance: s.into(), speed: u.into() };
        let times = times(&mut rng, 40.0);
        let [mut one, mut other] = [Vec::new(), Vec::new()];
        sample(&path, &drag, release, &times, false, |s| one.push(s)).unwrap();
        let law = Fitted(&drag);
        sample(&path, &law, release, &times, false, |s| other.push(s))
            .unwrap();
        let mut worst = 0.0_f64;
        for (a, b) in one.iter().zip(&other) {
            worst = worst.max((a.speed - b.speed).value().abs());
            worst = worst.max((a.distance - b.distance).value().abs() / 10.0);
        }
        let one = rest(&path, &drag, release).unwrap();
        let other = rest(&path, &law, release).unwrap();
        assert_eq!(one.is_some(), other.is_some(), "{case} {drag:?}");
        if let (Some(a), Some(b)) = (one, other) {
            worst = worst.max((a.distance - b.distance).value().abs() / 10.0);
            ends += 1;
        }
        assert!(worst < 5e-9, "{worst:e} {case} {drag:?}");
    }
    assert!(ends > 100, "{ends}");
}
