//! Laws that vary with the speed in a way of their own, against the equations
//! of motion integrated along the slope, and at the edges of what a law can
//! be.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use crate::terrain::any_track;
use couloir::Seed;
use couloir::physics::friction::{Turbulent, VelocityWeakening};
use couloir::physics::{
    Friction, Path, Rate, Release, Site, State, Sum, Track, Varies, rest,
    sample,
};
use couloir::scalar::{Grad, Kind, Plain, Real};
use nalgebra::Vector2;
use ode_solvers::{Dop853, OutputType, System};
use rand::RngExt;

/// A resistance \[m/s2\] written as a function of the speed \[m/s\].
#[derive(Clone, Copy)]
struct Resists(fn(f64) -> f64);

impl Friction<Plain> for Resists {
    fn varies(&self) -> Varies {
        Varies::WithSpeed
    }
    fn rate(&self, _: &Site, speed: Real) -> Rate<Plain> {
        Rate { constant: (self.0)(speed.value()).into(), ..Rate::default() }
    }
}

fn weakening() -> impl Friction<Plain> {
    let n = Real::<Plain>::new;
    let dry = VelocityWeakening { mu: n(0.35), r: n(0.6), u0: n(8.0) };
    Sum::new(dry, Turbulent { xi: n(500.0) })
}

/// d(u, t)/ds on a piece.
struct Along<'a, L>(&'a L, Site);

impl<L: Friction<Plain>> System<f64, Vector2<f64>> for Along<'_, L> {
    fn system(&self, _: f64, y: &Vector2<f64>, dy: &mut Vector2<f64>) {
        let u = Real::new(y[0]);
        let resists = self.0.rate(&self.1, u).resistance(&self.1, u);
        *dy =
            Vector2::new((self.1.pull - resists.value()) / y[0], y[0].recip());
    }
}

/// Place, speed and time at which the mass crosses each border, until it is
/// slower than 1 m/s.
fn crossings(
    track: &Track,
    law: &impl Friction<Plain>,
    speed: f64,
) -> Vec<[f64; 3]> {
    let (mut all, mut y) = (Vec::new(), Vector2::new(speed, 0.0));
    for piece in track.pieces().iter().filter(|p| p.length.is_finite()) {
        let site = Site {
            distance: piece.start + 0.5 * piece.length,
            pull: piece.pull,
            load: piece.load,
            curvature: piece.curvature,
            depth: 1.0,
        };
        let (law, l) = (Along(law, site), piece.length);
        let mut solver = Dop853::new(law, 0.0, l, l, y, 1e-12, 1e-12);
        solver.set_output(OutputType::Sparse);
        if solver.integrate().is_err() {
            break;
        }
        y = *solver.y_out().last().unwrap();
        if y[0].is_nan() || y[0] < 1.0 {
            break;
        }
        all.push([piece.start + piece.length, y[0], y[1]]);
    }
    all
}

fn states(
    track: &Track,
    law: &impl Friction<Plain>,
    speed: f64,
    times: &[f64],
) -> Vec<State<Plain>> {
    let path = Path::new(track, 1.0);
    let release = Release { distance: 0.0.into(), speed: speed.into() };
    let mut all = Vec::new();
    sample(&path, law, release, times, false, |s| all.push(s)).unwrap();
    all
}

/// The largest error in speed and place at the borders of sixty tracks.
fn error(law: &impl Friction<Plain>) -> f64 {
    let (mut worst, mut compared) = (0.0_f64, 0);
    for case in 0..60 {
        let mut rng = Seed::new(41).child(case).rng();
        let track = any_track(&mut rng);
        let speed = rng.random_range(2.0..30.0);
        let expected = crossings(&track, law, speed);
        let times: Vec<f64> = expected.iter().map(|c| c[2]).collect();
        let found = states(&track, law, speed, &times);
        for (state, [place, speed, _]) in found.iter().zip(&expected) {
            worst = worst.max((state.speed.value() - speed).abs());
            worst = worst.max((state.distance.value() - place).abs() / 10.0);
            compared += 1;
        }
    }
    assert!(compared > 300, "{compared}");
    worst
}

#[test]
fn smooth_laws_move_as_the_integrated_equations_do() {
    // A leg errs by 1e-12 at most, and there are up to a thousand. Errors grow
    // where the mass nearly stops.
    let bound = 1e-8;
    assert!(error(&weakening()) < bound);
    let laws = [
        |u: f64| 0.02 * u.powf(1.5) + 1.0,
        |u: f64| 3.0 * (u / 12.0).tanh(),
        |u: f64| 1.5 + 0.5 * (0.3 * u).sin(),
    ];
    for (i, law) in laws.into_iter().enumerate() {
        let error = error(&Resists(law));
        assert!(error < bound, "law {i}: {error:e}");
    }
}

#[test]
fn a_kink_is_passed() {
    let law = Resists(|u| 1.0 + 0.2 * (u - 15.0).max(0.0));
    let error = error(&law);
    assert!(error < 1e-7, "{error:e}");
}

/// Dry friction that is lower by 0.1 from a speed \[m/s\] on.
#[derive(Debug, Clone, Copy)]
struct Jumps<K: Kind> {
    mu: Real<K>,
    at: f64,
}

impl<K: Kind> Friction<K> for Jumps<K> {
    fn varies(&self) -> Varies {
        Varies::WithSpeed
    }
    fn rate(&self, _: &Site, speed: Real<K>) -> Rate<K> {
        let less = if speed < self.at { 0.0 } else { 0.1 };
        Rate { mu: self.mu - less, ..Rate::default() }
    }
}

/// A run down an even slope, under [`Jumps`].
struct Run {
    track: Track,
    mu: f64,
    at: f64,
    /// The speed at the start.
    from: f64,
}

impl Run {
    /// Up to the jump on a steep slope, or down to it on a flat one.
    fn any(case: u64) -> Self {
        let mut rng = Seed::new(43).child(case).rng();
        let (at, mu) =
            (rng.random_range(3.0..15.0), rng.random_range(0.3..0.4));
        let (degrees, from) = match case % 2 {
            0 => (rng.random_range(28.0..45.0), rng.random_range(0.0..at)),
            _ => (rng.random_range(0.0..8.0), at + rng.random_range(0.0..5.0)),
        };
        let track = Track::incline(degrees, 2000.0).unwrap();
        Self { track, mu, at, from }
    }

    /// Speed and place after a time: on either side of the jump the force is
    /// constant. `None` once the mass rests.
    fn exact(&self, mu: f64, time: f64) -> Option<[f64; 2]> {
        let piece = self.track.pieces()[0];
        let is_fast = self.from >= self.at;
        let force = |less: f64| piece.pull - (mu - less) * piece.load;
        let [before, beyond] = match is_fast {
            true => [force(0.1), force(0.0)],
            false => [force(0.0), force(0.1)],
        };
        let first = time.min((self.at - self.from) / before);
        let (then, u) = (time - first, self.from + before * first);
        let place = 0.5 * (self.from + u) * first;
        let speed = u + beyond * then;
        let place = place + 0.5 * (u + speed) * then;
        (speed > 0.0).then_some([speed, place])
    }

    /// The same as solved, with derivatives by mu.
    fn solved(&self, times: &[f64]) -> Vec<[Real<Grad<1>>; 2]> {
        let law = Jumps { mu: Real::variable(self.mu, 0), at: self.at };
        let path = Path::new(&self.track, 1.0);
        let speed = self.from.into();
        let release = Release { distance: 0.0.into(), speed };
        let mut all = Vec::new();
        let visit = |s: State<Grad<1>>| all.push([s.speed, s.distance]);
        sample(&path, &law, release, times, false, visit).unwrap();
        all
    }
}

#[test]
fn a_jump_is_passed_at_its_speed() {
    let times = [0.5, 1.0, 2.0, 3.0];
    let (mut worst, mut compared) = ([0.0_f64; 2], 0);
    for run in (0..300).map(Run::any) {
        for (found, time) in run.solved(&times).into_iter().zip(times) {
            let step = 1e-6;
            let at = |shift: f64| run.exact(run.mu + shift, time);
            let all = (at(-step), at(0.0), at(step));
            let (Some(less), Some(known), Some(more)) = all else { continue };
            for i in 0..2 {
                let scale = [run.at, known[i]][i];
                let off = (found[i].value() - known[i]).abs() / scale;
                worst[0] = worst[0].max(off);
                let slope = 0.5 * (more[i] - less[i]) / step;
                let off = (found[i].partial(0) / slope - 1.0).abs();
                worst[1] = worst[1].max(off);
            }
            compared += 1;
        }
    }
    assert!(compared > 800, "{compared}");
    // A jump is met within 2e-7 of its speed.
    assert!(worst[0] < 1e-6 && worst[1] < 1e-5, "{worst:?}");
}

#[test]
fn what_cannot_be_integrated_is_refused() {
    let track = any_track(&mut Seed::new(42).rng());
    let path = Path::new(&track, 1.0);
    let release = Release { distance: 0.0.into(), speed: 9.0.into() };
    let laws = [
        |_: f64| f64::NAN,
        |u: f64| if u == 9.0 { 1.0 } else { f64::NAN },
        |u: f64| if u < 10.0 { f64::NEG_INFINITY } else { 1.0 },
    ];
    for (i, law) in laws.into_iter().enumerate() {
        let times = [1.0, 5.0];
        let done =
            sample(&path, &Resists(law), release, &times, false, |_| {});
        assert!(done.is_err(), "law {i}");
        assert!(rest(&path, &Resists(law), release).is_err(), "law {i}");
    }
}

#[test]
fn a_mass_at_its_terminal_speed_keeps_it() {
    // Along one slope without end, where push and resistance are equal.
    let track = Track::from_points(&[0.0, 10.0], &[10.0, 0.0]).unwrap();
    let pull = track.pieces()[0].pull;
    let law = Drag { at_ten: pull };
    let times = [1.0, 10.0, 100.0];
    for state in states(&track, &law, 10.0, &times) {
        assert!((state.speed.value() - 10.0).abs() < 1e-12, "{state:?}");
    }
    for state in states(&track, &law, 9.0, &times).iter().skip(2) {
        assert!((state.speed.value() - 10.0).abs() < 1e-9, "{state:?}");
    }
}

/// A resistance that grows with the third power of the speed.
struct Drag {
    at_ten: f64,
}

impl<K: Kind> Friction<K> for Drag {
    fn varies(&self) -> Varies {
        Varies::WithSpeed
    }
    fn rate(&self, _: &Site, speed: Real<K>) -> Rate<K> {
        let constant = self.at_ten * (speed / 10.0).powi(3);
        Rate { constant, ..Rate::default() }
    }
}
