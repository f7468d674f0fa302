//! Changed motion against closed forms, another integrator and differences.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use couloir::mechanism::Mechanism;
use couloir::mechanism::catalogue::{catalogue, find};
use couloir::model::{Assembled, Point, Posterior};
use couloir::noise;
use couloir::observe::Extent;
use couloir::physics::forces::{Axis, Forces, Range, Shape, Stretch, Term};
use couloir::physics::friction::{LAWS, Laws};
use couloir::physics::track::Piece;
use couloir::physics::{
    GRAVITY, Path, Rate, Release, State, Track, rest, rest_changed, sample,
    sample_changed,
};
use couloir::prior::AnyPrior;
use couloir::scalar::{Grad, Kind, Plain, Real};
use couloir::{Event, Series};

/// A release.
const AT: (f64, f64) = (0.0, 1.0);

/// A track of pieces of several slopes, on a shared axis that begins at 100.
fn bent() -> Track {
    let x = [0.0, 30.0, 70.0, 140.0, 900.0];
    let z = [500.0, 482.0, 455.0, 420.0, 120.0];
    Track::from_points(&x, &z).unwrap().with_origin(100.0)
}

fn times(last: f64) -> Vec<f64> {
    (1..=60).map(|i| last * f64::from(i) / 60.0).collect()
}

/// Speeds under a law and forces.
fn changed<K: couloir::physics::friction::LawKind>(
    track: &Track,
    law: &str,
    values: &[f64],
    forces: &Forces<K>,
    times: &[f64],
) -> Vec<Real<K>> {
    let law = Laws::default().parse(law).unwrap();
    let values: Vec<Real<K>> = values.iter().map(|&v| Real::new(v)).collect();
    let path = Path::new(track, 1.3);
    let release = Release { distance: AT.0.into(), speed: AT.1.into() };
    let mut speeds = Vec::new();
    let at = times.iter().map(|&t| Real::new(t));
    let law = law.with(&values);
    let push = |s: State<K>| speeds.push(s.speed);
    sample_changed(&path, &law, forces, release, at, true, push).unwrap();
    speeds
}

/// The same without forces.
fn plain(track: &Track, law: &str, values: &[f64], at: &[f64]) -> Vec<f64> {
    let law = Laws::default().parse(law).unwrap();
    let values: Vec<Real<Plain>> =
        values.iter().map(|&v| Real::new(v)).collect();
    let path = Path::new(track, 1.3);
    let release = Release { distance: AT.0.into(), speed: AT.1.into() };
    let mut speeds = Vec::new();
    sample(&path, &law.with(&values), release, at, true, |s| {
        speeds.push(s.speed.value());
    })
    .unwrap();
    speeds
}

/// Runge and Kutta's method of fourth order in small steps; `push` is du/dt
/// of a moving mass at a place on the shared axis, a time and a speed.
fn integrated(
    track: &Track,
    at: &[f64],
    push: impl Fn(&Piece, f64, f64, f64) -> f64,
) -> Vec<f64> {
    let h = 2e-4;
    let (mut s, mut u, mut t) = (AT.0, AT.1, 0.0);
    let mut speeds = Vec::new();
    for &until in at {
        while t < until - 0.5 * h {
            let f = |ds: f64, u: f64, dt: f64| {
                let s = s + ds;
                let piece = &track.pieces()[track.piece_at(s)];
                push(piece, s + track.origin(), t + dt, u)
            };
            let k1 = f(0.0, u, 0.0);
            let k2 = f(0.5 * h * u, u + 0.5 * h * k1, 0.5 * h);
            let k3 = f(0.5 * h * u, u + 0.5 * h * k2, 0.5 * h);
            let k4 = f(h * u, u + h * k3, h);
            let next = (u + h * (k1 + 2.0 * (k2 + k3) + k4) / 6.0).max(0.0);
            s += 0.5 * h * (u + next);
            (u, t) = (next, t + h);
        }
        speeds.push(u);
    }
    speeds
}

fn of<K: Kind>(rate: Rate<K>, over: Stretch<K>, shape: Shape<K>) -> Forces<K> {
    let mut forces = Forces::default();
    forces.terms.push(Term { rate, over, shape });
    forces.step = 0.2;
    forces
}

fn worst(a: &[Real<Plain>], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a.value() - b).abs()).fold(0.0, f64::max)
}

#[test]
fn a_patch_with_its_edges_inside_pieces() {
    let at = times(14.0);
    let rate = Rate { mu: Real::new(0.17), ..Rate::default() };
    let edges = [133.3.into(), 187.7.into()];
    let over = Stretch::Between(Axis::Place, edges);
    let forces = of(rate, over, Shape::Even);
    let found = changed(&bent(), "voellmy", &[0.2, 900.0], &forces, &at);
    let c = GRAVITY / (900.0 * 1.3);
    let expected = integrated(&bent(), &at, |piece, s, _, u| {
        let more = if (133.3..187.7).contains(&s) { 0.17 } else { 0.0 };
        piece.pull - (0.2 + more) * piece.load - c * u * u
    });
    assert!(worst(&found, &expected) < 1e-3, "{found:?} {expected:?}");
}

#[test]
fn a_push_sets_a_resting_mass_moving_again() {
    let track = Track::incline(10.0, 500.0).unwrap();
    let at = times(15.0);
    let rate = Rate { constant: Real::new(-3.0), ..Rate::default() };
    let over = Stretch::Between(Axis::Time, [8.0.into(), 11.0.into()]);
    let forces = of(rate, over, Shape::Even);
    let found = changed(&track, "coulomb", &[0.3], &forces, &at);
    let angle = 10.0_f64.to_radians();
    let a = GRAVITY * (angle.sin() - 0.3 * angle.cos());
    let expected: Vec<f64> = at
        .iter()
        .map(|&t| match t {
            t if t < 8.0 => (AT.1 + a * t).max(0.0),
            t if t < 11.0 => (a + 3.0) * (t - 8.0),
            t => ((a + 3.0) * 3.0 + a * (t - 11.0)).max(0.0),
        })
        .collect();
    assert!(worst(&found, &expected) < 1e-9, "{found:?} {expected:?}");
}

#[test]
fn a_force_without_an_end_lets_a_mass_come_to_rest() {
    let track = Track::incline(10.0, 500.0).unwrap();
    let path = Path::new(&track, 1.3);
    let release = Release { distance: AT.0.into(), speed: 9.0.into() };
    let law = Laws::default().parse("coulomb").unwrap();
    let values = [Real::<Plain>::new(0.3)];
    let rate = Rate { constant: Real::new(1.0), ..Rate::default() };
    let edges = [2.0.into(), f64::INFINITY.into()];
    let over = Stretch::Between(Axis::Time, edges);
    let forces = of(rate, over, Shape::Even);
    let law = law.with(&values);
    let rest = rest_changed(&path, &law, &forces, release).unwrap().unwrap();
    let angle = 10.0_f64.to_radians();
    let slows = GRAVITY * (0.3 * angle.cos() - angle.sin());
    let after = (9.0 - 2.0 * slows) / (slows + 1.0);
    assert!((rest.time.value() - 2.0 - after).abs() < 1e-9);
}

#[test]
fn a_mass_that_a_drag_by_stages_never_stops_is_told_at_once() {
    let release = Release { distance: AT.0.into(), speed: 9.0.into() };
    let rate = Rate { linear: Real::new(0.06), ..Rate::default() };
    let forces = of(rate, Stretch::Everywhere, Shape::Even);
    let coulomb = Laws::default().parse("coulomb").unwrap();
    let viscous = Laws::default().parse("coulomb + viscous").unwrap();
    let [mu, drag] = [0.3, 0.06].map(Real::<Plain>::new);
    let (values, all) = ([mu], [mu, drag]);
    let on = |degrees: f64| {
        let track = Track::incline(degrees, 500.0).unwrap();
        let path = Path::new(&track, 1.3);
        let found =
            rest_changed(&path, &coulomb.with(&values), &forces, release);
        let expected = rest(&path, &viscous.with(&all), release);
        (found.unwrap(), expected.unwrap())
    };
    let begun = Instant::now();
    let (found, expected) = on(30.0);
    assert!(found.is_none() && expected.is_none());
    // It goes on for ever at its terminal speed: to follow it took seconds.
    assert!(begun.elapsed() < Duration::from_millis(200));
    let (found, expected) = on(10.0);
    let [found, expected] = [found, expected].map(|r| r.unwrap().time.value());
    assert!((found - expected).abs() < 1e-4, "{found} {expected}");
}

#[test]
fn a_law_that_weakens_at_once_is_asked_for_as_often_as_it_needs() {
    // Most of it is gone at 3 m/s, and the recording is long.
    let at = times(80.0);
    let (law, values) = ("velocity-weakening", [0.4, 0.4, 1.0]);
    let none = Rate { constant: Real::new(0.0), ..Rate::default() };
    let mut forces = of(none, Stretch::Everywhere, Shape::Even);
    forces.step = 80.0 / 40.0;
    let found = changed(&bent(), law, &values, &forces, &at);
    let worst = worst(&found, &plain(&bent(), law, &values, &at));
    assert!(worst < 2e-3, "{worst}");
}

#[test]
fn viscous_drag_by_stages_is_the_exact_law() {
    let at = times(20.0);
    let rate = Rate { linear: Real::new(0.06), ..Rate::default() };
    let forces = of(rate, Stretch::Everywhere, Shape::Even);
    let found = changed(&bent(), "coulomb", &[0.2], &forces, &at);
    let expected = plain(&bent(), "coulomb + viscous", &[0.2, 0.06], &at);
    let worst = worst(&found, &expected);
    assert!(worst < 2e-5, "{worst}");
}

#[test]
fn a_stiff_drag_is_asked_for_more_often() {
    let at = times(20.0);
    // With a step of 2 s the stages would be stable up to 1.25/s.
    for drag in [3.0, 0.6] {
        let rate = Rate { linear: Real::new(drag), ..Rate::default() };
        let forces = of(rate, Stretch::Everywhere, Shape::Even);
        let forces = Forces { step: 2.0, ..forces };
        let found = changed(&bent(), "coulomb", &[0.2], &forces, &at);
        let law = "coulomb + viscous";
        let expected = plain(&bent(), law, &[0.2, drag], &at);
        let worst = worst(&found, &expected);
        assert!(worst < 1e-3, "{drag}: {worst}");
    }
}

#[test]
fn linear_drag_of_the_law_beside_a_steady_change() {
    let at = times(16.0);
    let range = Range { begin: 0.0, span: 16.0 };
    let rate = Rate { mu: Real::new(0.2), ..Rate::default() };
    let shape = Shape::Linear(Axis::Time, range);
    let forces = of(rate, Stretch::Everywhere, shape);
    let law = "coulomb + viscous";
    let found = changed(&bent(), law, &[0.2, 0.1], &forces, &at);
    let expected = integrated(&bent(), &at, |piece, _, t, u| {
        piece.pull - (0.2 + 0.2 * t / 16.0) * piece.load - 0.1 * u
    });
    let worst = worst(&found, &expected);
    assert!(worst < 5e-4, "{worst}");
}

#[test]
fn a_mass_that_never_leaves_its_track_goes_on_under_a_change_that_is_over() {
    // Faster than the terminal speed at the end of the range, on a slope
    // without an end.
    let range = Range { begin: 100.0, span: 60.0 };
    let shape: Shape<Plain> = Shape::Linear(Axis::Place, range);
    let rate = Rate { mu: Real::new(0.1), ..Rate::default() };
    let forces = of(rate, Stretch::Everywhere, shape);
    let at = times(400.0);
    let found = changed(&bent(), "voellmy", &[0.1, 300.0], &forces, &at);
    let last = *bent().pieces().last().unwrap();
    let c = GRAVITY / (300.0 * 1.3);
    let terminal = ((last.pull - 0.2 * last.load) / c).sqrt();
    let speed = found.last().unwrap().value();
    assert!((speed - terminal).abs() < 1e-6, "{speed} {terminal}");
}

#[test]
fn velocity_weakening_by_stages_is_the_law_integrated() {
    let at = times(20.0);
    let rate = Rate { mu: Real::new(-0.15), ..Rate::default() };
    let shape = Shape::WithSpeed(8.0.into());
    let forces = of(rate, Stretch::Everywhere, shape);
    let found = changed(&bent(), "coulomb", &[0.35], &forces, &at);
    let values = [0.35, 0.2 / 0.35, 8.0];
    let expected = plain(&bent(), "velocity-weakening", &values, &at);
    let worst = worst(&found, &expected);
    assert!(worst < 5e-5, "{worst}");
}

#[test]
fn hardening_is_as_steady_as_its_stairs_allow() {
    let at = times(16.0);
    for axis in [Axis::Place, Axis::Time] {
        let range = match axis {
            Axis::Time => Range { begin: 0.0, span: 16.0 },
            _ => Range { begin: 100.0, span: 500.0 },
        };
        let along = move |s: f64, t: f64| {
            let x = if axis == Axis::Time { t } else { s };
            (x - range.begin).clamp(0.0, range.span)
        };
        for saturates in [false, true] {
            let scale = 0.2 * range.span;
            let shape = match saturates {
                true => Shape::Saturating(axis, range, scale.into()),
                false => Shape::Linear(axis, range),
            };
            let rate = Rate { mu: Real::new(0.2), ..Rate::default() };
            let forces = of(rate, Stretch::Everywhere, shape);
            let found = changed(&bent(), "coulomb", &[0.2], &forces, &at);
            let expected = integrated(&bent(), &at, |piece, s, t, _| {
                let x = along(s, t);
                let part = match saturates {
                    true => -(-x / scale).exp_m1(),
                    false => x / range.span,
                };
                piece.pull - (0.2 + 0.2 * part) * piece.load
            });
            let worst = worst(&found, &expected);
            assert!(worst < 5e-4, "{axis:?} {saturates}: {worst}");
        }
    }
}

#[test]
fn a_tilt_is_a_steeper_incline() {
    let at = times(10.0);
    let tilt = Real::new(1.5_f64.to_radians());
    let forces = Forces { tilt, ..Forces::<Plain>::default() };
    let gentle = Track::incline(24.0, 900.0).unwrap();
    let steep = Track::incline(25.5, 900.0).unwrap();
    let values = [0.25, 800.0];
    let found = changed(&gentle, "voellmy", &values, &forces, &at);
    let expected = plain(&steep, "voellmy", &values, &at);
    assert!(worst(&found, &expected) < 1e-9);
}

/// The forces of each kind with amounts that carry derivatives.
fn kinds<K: Kind>(which: usize, x: &[Real<K>; 3]) -> Forces<K> {
    let between = |axis| Stretch::Between(axis, [x[1], x[2]]);
    let mu = Rate { mu: x[0], ..Rate::default() };
    let push = Rate { constant: -x[0], ..Rate::default() };
    let linear = Rate { linear: x[0], ..Rate::default() };
    let range = Range { begin: 100.0, span: 300.0 };
    let all = Stretch::Everywhere;
    let place = Axis::Place;
    match which {
        0 => of(mu, between(place), Shape::Even),
        1 => of(push, between(Axis::Time), Shape::Even),
        2 => of(linear, all, Shape::Even),
        3 => of(mu, all, Shape::WithSpeed(x[1])),
        4 => of(mu, all, Shape::Linear(place, range)),
        5 => of(mu, all, Shape::Saturating(place, range, x[1])),
        _ => Forces { tilt: x[0], ..Forces::default() },
    }
}

#[test]
fn gradients_are_those_of_differences() {
    let at: Vec<f64> = times(14.0).into_iter().step_by(7).collect();
    let cases: [[f64; 3]; 7] = [
        [0.13, 133.3, 187.7],
        [0.9, 3.21, 7.89],
        [0.05, 0.0, 0.0],
        [-0.12, 7.3, 0.0],
        [0.11, 0.0, 0.0],
        [0.11, 71.0, 0.0],
        [0.02, 0.0, 0.0],
    ];
    let (law, values) = ("voellmy", [0.23, 950.0]);
    for (which, x) in cases.iter().enumerate() {
        let number = |i: usize| Real::<Grad<4>>::variable(x[i], i);
        let forces = kinds(which, &[number(0), number(1), number(2)]);
        let exact = changed(&bent(), law, &values, &forces, &at);
        for i in (0..3).filter(|&i| x[i] != 0.0) {
            let h = 1e-5 * x[i].abs();
            let off = |by: f64| {
                let mut y = x.map(Real::<Plain>::new);
                y[i] += by;
                changed(&bent(), law, &values, &kinds(which, &y), &at)
            };
            let (up, down) = (off(h), off(-h));
            for (k, speed) in exact.iter().enumerate() {
                let slope = (up[k] - down[k]).value() / (2.0 * h);
                let tells = 1e-5 * slope.abs() + 1e-7;
                let apart = (speed.partial(i) - slope).abs();
                let t = at[k];
                assert!(
                    apart < tells,
                    "{which}, {i}, t = {t}: {} {slope}",
                    speed.partial(i)
                );
            }
        }
    }
}

/// An event on the bent track, with some recording.
fn event() -> Event {
    let at = times(14.0);
    let values = plain(&bent(), "voellmy", &[0.2, 900.0], &at);
    Event::on(bent())
        .velocity(Series::velocity(at, values).unwrap())
        .release(0.0, AT.1)
        .build()
        .unwrap()
}

fn model(law: &str, found: Vec<Box<dyn Mechanism>>) -> Assembled {
    let laws = Laws::default().parse(law).unwrap();
    let (noise, none) = (noise::parse("iid").unwrap(), BTreeMap::new());
    Assembled::new(event(), laws, noise, &none)
        .unwrap()
        .with_mechanisms(found, &none)
        .unwrap()
}

/// The median of every prior, and a little below it of a uniform one: a
/// stretch that begins there has room.
fn usual(model: &Assembled) -> Vec<f64> {
    let of = |prior: &AnyPrior| match prior {
        AnyPrior::Uniform(..) => prior.quantile(0.4),
        _ => prior.quantile(0.5),
    };
    model.priors().map(|(_, prior)| of(prior).unwrap()).collect()
}

fn everything() -> Extent {
    let extent = event().extent();
    Extent { carried: true, bends: true, averages: true, ..extent }
}

#[test]
fn each_mechanism_gives_the_baseline_back_and_bears_every_law() {
    for entry in LAWS {
        let plain = model(entry.name(), Vec::new());
        let own = usual(&plain);
        let posterior = Posterior::new(&plain).unwrap();
        let base = posterior.density(Point::Natural(&own)).unwrap();
        assert_eq!(base.rejected, None, "{}", entry.name());
        for mechanism in catalogue(&everything(), &[]) {
            let label = mechanism.label();
            let about = format!("{label} under {}", entry.name());
            let with = model(entry.name(), vec![mechanism]);
            let posterior = Posterior::new(&with).unwrap();
            let mut values = usual(&with);
            let there = posterior.density(Point::Natural(&values)).unwrap();
            assert_eq!(there.rejected, None, "{about}");
            values[0] = 1e-13;
            let zero = posterior.density(Point::Natural(&values)).unwrap();
            let (a, b) = (zero.log_likelihood, base.log_likelihood);
            let by_stages = entry.name() == "velocity-weakening"
                || ["viscous-drag", "velocity-weakening"]
                    .contains(&label.as_str());
            let near = if by_stages { 1e-5 } else { 1e-9 };
            assert!(
                (a - b).abs() < near * b.abs().max(1.0),
                "{about} {a} {b}"
            );
        }
    }
}

#[test]
fn labels_find_their_mechanisms() {
    let extent = everything();
    for mechanism in catalogue(&extent, &[]) {
        let label = mechanism.label();
        let found = find(&label, &extent, &[]).unwrap();
        assert_eq!(found.label(), label);
        let first = find(mechanism.name(), &extent, &[]).unwrap();
        assert_eq!(first.name(), mechanism.name());
    }
    let found = find("friction-hardening(time,saturating)", &extent, &[]);
    assert_eq!(found.unwrap().label(), "friction-hardening(time, saturating)");
    assert_eq!(
        find("friction-step", &extent, &[]).unwrap().label(),
        "friction-step(distance)"
    );
    let error = find("friction-pach", &extent, &[]).unwrap_err();
    assert!(error.is_input() && error.to_string().contains("friction-patch"));
}

/// What a model with one mechanism predicts of its recording.
fn predicted(event: Event, label: &str, amount: f64) -> Vec<f64> {
    let found = find(label, &event.extent(), &[]).unwrap();
    let laws = Laws::default().parse("coulomb").unwrap();
    let (noise, none) = (noise::parse("iid").unwrap(), BTreeMap::new());
    let model = Assembled::new(event, laws, noise, &none)
        .unwrap()
        .with_mechanisms(vec![found], &none)
        .unwrap();
    let posterior = Posterior::new(&model).unwrap();
    let (density, said) =
        posterior.collect(Point::Natural(&[amount, 0.2, 1.0])).unwrap();
    assert_eq!(density.rejected, None);
    said.predictions[0].clone()
}

#[test]
fn a_clock_ahead_and_a_mean_over_a_window() {
    let at: Vec<f64> = (1..40).map(|i| 0.2 * f64::from(i)).collect();
    let incline = Track::incline(30.0, 900.0).unwrap();
    let recorded = Series::velocity(at.clone(), at.clone()).unwrap();
    let event = Event::on(incline).velocity(recorded).build().unwrap();
    let angle = 30.0_f64.to_radians();
    let a = GRAVITY * (angle.sin() - 0.2 * angle.cos());
    let late = predicted(event.clone(), "clock-offset", 1.1);
    let early = predicted(event.clone(), "clock-offset", -0.7);
    let mean = predicted(event, "averaging-window", 1.5);
    for (i, t) in at.iter().enumerate() {
        assert!((late[i] - a * (t - 1.1).max(0.0)).abs() < 1e-9);
        assert!((early[i] - a * (t + 0.7)).abs() < 1e-9);
        let half = 0.5 * t.min(1.5);
        assert!((mean[i] - a * (t - half)).abs() < 1e-9, "t = {t}");
    }
}
