//! A flow depth that changes along the track or with time, against the
//! equations of motion integrated with another integrator.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use couloir::physics::friction::{Turbulent, VelocityWeakening, Voellmy};
use couloir::physics::{
    Depth, DepthRows, Forces, GRAVITY, Sum, Track, rest, sample,
    sample_changed,
};
use couloir::scalar::{Grad, Kind, Plain, Real};
use couloir::{Event, Series};
use nalgebra::Vector2;
use ode_solvers::{Dopri5, OutputType, System};

const MU: f64 = 0.2;
const XI: f64 = 800.0;

/// A slope of one angle, so that the integrator meets no jump.
fn slope() -> Track {
    Track::from_points(&[0.0, 150.0, 1200.0], &[600.0, 525.0, 0.0]).unwrap()
}

/// Shallow, deep, and shallow again.
fn rows(at: [f64; 3]) -> DepthRows {
    DepthRows::new(at.to_vec(), vec![0.8, 2.4, 1.2]).unwrap()
}

fn times() -> Vec<f64> {
    (1..=50).map(|i| 0.4 * f64::from(i)).collect()
}

fn event(depth: Depth) -> Event {
    let zeros = vec![0.0; times().len()];
    Event::on(slope())
        .depth(depth)
        .velocity(Series::velocity(times(), zeros).unwrap())
        .build()
        .unwrap()
}

fn law<K: Kind>(mu: f64, xi: f64) -> Voellmy<Real<K>> {
    Voellmy { mu: mu.into(), xi: xi.into() }
}

/// Speeds and distances of an event.
fn found(event: &Event, mu: f64, xi: f64) -> Vec<[f64; 2]> {
    let mut all = Vec::new();
    let (path, release) = (event.path(), event.release::<Plain>());
    sample(&path, &law(mu, xi), release, &times(), false, |state| {
        all.push([state.speed.value(), state.distance.value()]);
    })
    .unwrap();
    all
}

/// d(s, u)/dt on the slope.
struct Integrated(Depth);

impl Integrated {
    fn depth(&self, t: f64, x: f64) -> f64 {
        match &self.0 {
            Depth::Even(depth) => *depth,
            Depth::Along(rows) => rows.at(x),
            Depth::During(rows) => rows.at(t),
        }
    }
}

impl System<f64, Vector2<f64>> for Integrated {
    fn system(&self, t: f64, y: &Vector2<f64>, dy: &mut Vector2<f64>) {
        let (sin, cos) = (0.5 / 1.25_f64.sqrt(), 1.0 / 1.25_f64.sqrt());
        let drag = GRAVITY * y[1] * y[1] / (XI * self.depth(t, y[0] * cos));
        *dy = Vector2::new(y[1], GRAVITY * (sin - MU * cos) - drag);
    }
}

fn expected(depth: &Depth) -> Vec<[f64; 2]> {
    let mut all = Vec::new();
    let (mut y, mut last) = (Vector2::new(0.0, 0.0), 0.0);
    for t in times() {
        let law = Integrated(depth.clone());
        let mut solver = Dopri5::new(law, last, t, t - last, y, 1e-10, 1e-10);
        solver.set_output(OutputType::Sparse);
        solver.integrate().unwrap();
        y = *solver.y_out().last().unwrap();
        last = t;
        all.push([y[1], y[0]]);
    }
    all
}

/// The largest difference in speed, and in place.
fn apart(a: &[[f64; 2]], b: &[[f64; 2]]) -> [f64; 2] {
    let most = |k: usize| {
        let each = a.iter().zip(b).map(|(a, b)| (a[k] - b[k]).abs());
        each.fold(0.0, f64::max)
    };
    [most(0), most(1)]
}

const PLACES: [f64; 3] = [60.0, 200.0, 420.0];
const MOMENTS: [f64; 3] = [3.0, 9.0, 17.0];

/// Steps of 2 % err by their square: some mm/s and mm, where a mean depth errs
/// by m/s.
#[test]
fn the_motion_is_that_of_the_integrated_equations() {
    for depth in [Depth::Along(rows(PLACES)), Depth::During(rows(MOMENTS))] {
        let exact = expected(&depth);
        let [speed, place] =
            apart(&found(&event(depth.clone()), MU, XI), &exact);
        assert!(speed < 4e-3 && place < 1e-2, "{depth:?} {speed} {place}");
        let even = found(&event(1.6.into()), MU, XI);
        assert!(apart(&even, &exact)[0] > 1.0, "{depth:?}");
    }
}

#[test]
fn rows_of_one_depth_are_that_depth() {
    let plain = found(&event(1.7.into()), MU, XI);
    let same = |at: [f64; 3]| DepthRows::new(at.to_vec(), vec![1.7; 3]);
    for depth in [
        Depth::Along(same(PLACES).unwrap()),
        Depth::During(same(MOMENTS).unwrap()),
    ] {
        let [speed, place] = apart(&found(&event(depth), MU, XI), &plain);
        assert!(speed < 1e-9 && place < 1e-8, "{speed} {place}");
    }
}

/// With forces added, with many laws at once, and with laws that vary with the
/// speed, the depth is the same.
#[test]
fn every_way_to_solve_the_motion_has_the_depth() {
    let none = Forces::<Plain>::default();
    for depth in [Depth::Along(rows(PLACES)), Depth::During(rows(MOMENTS))] {
        let event = event(depth);
        let direct = found(&event, MU, XI);
        let mut changed = Vec::new();
        let (path, release) = (event.path(), event.release::<Plain>());
        let at = times().into_iter().map(Real::new);
        let law = law(MU, XI);
        sample_changed(&path, &law, &none, release, at, false, |state| {
            changed.push([state.speed.value(), state.distance.value()]);
        })
        .unwrap();
        assert!(apart(&direct, &changed)[0] < 1e-9);
        for speeds in event.slide_many(&[law; 9], &times()) {
            let pairs = speeds.unwrap();
            let pairs = pairs.iter().zip(&direct);
            assert!(pairs.into_iter().all(|(a, b)| (a - b[0]).abs() < 1e-9));
        }
        // A friction that weakens by nothing is Coulomb's.
        let (mu, r) = (Real::<Plain>::new(MU), Real::new(1.0));
        let even = VelocityWeakening { mu, r, u0: Real::new(5.0) };
        let sum = Sum::new(even, Turbulent { xi: Real::new(XI) });
        let mut bent = Vec::new();
        sample(&path, &sum, release, &times(), false, |state| {
            bent.push([state.speed.value(), state.distance.value()]);
        })
        .unwrap();
        assert!(apart(&direct, &bent)[0] < 1e-6);
    }
}

#[test]
fn derivatives_are_those_of_the_motion() {
    // The force jumps a little at the end of each step of the depth: a
    // difference over the jump is of neither side, and this one meets none.
    let step = 1e-6;
    for depth in [Depth::Along(rows(PLACES)), Depth::During(rows(MOMENTS))] {
        let event = event(depth);
        let (path, release) = (event.path(), event.release::<Grad<4>>());
        let law = Voellmy::<Real<Grad<4>>> {
            mu: Real::variable(MU, 0),
            xi: Real::variable(XI, 1),
        };
        let mut slopes = Vec::new();
        sample(&path, &law, release, &times(), true, |state| {
            slopes.push(state.speed.partial(0));
        })
        .unwrap();
        let shifted = |by: f64| found(&event, MU + by, XI);
        let pairs = shifted(step).into_iter().zip(shifted(-step));
        for ((up, down), slope) in pairs.zip(&slopes) {
            let difference = (up[0] - down[0]) / (2.0 * step);
            let off = (slope - difference).abs();
            assert!(off < 1e-4 * difference.abs().max(1.0), "{off}");
        }
    }
}

/// A mass rests when it comes to rest, though the depth goes on to change.
#[test]
fn it_rests_when_it_stops() {
    let x = [0.0, 200.0, 1200.0];
    let track = Track::from_points(&x, &[100.0, 0.0, 0.0]).unwrap();
    let stops = |depth: Depth| {
        let event = Event::on(track.clone()).depth(depth).build().unwrap();
        let release = event.release::<Plain>();
        rest(&event.path(), &law(MU, XI), release).unwrap().unwrap()
    };
    let even = stops(1.5.into());
    let late = DepthRows::new(vec![200.0, 900.0], vec![1.5, 4.0]).unwrap();
    let same = stops(Depth::During(late));
    assert!((same.time.value() - even.time.value()).abs() < 1e-9);
    assert!((same.distance.value() - even.distance.value()).abs() < 1e-9);
    let deeper = DepthRows::new(vec![0.0, 200.0], vec![1.5, 6.0]).unwrap();
    assert!(stops(Depth::Along(deeper)).distance > even.distance + 5.0);
}
