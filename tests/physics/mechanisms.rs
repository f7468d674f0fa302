//! The catalogue held against its table: each mechanism's priors and what it
//! does, with every number typed here once more.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::collections::{BTreeMap, BTreeSet};

use couloir::mechanism::catalogue::{catalogue, find};
use couloir::mechanism::{Change, Extent, Mechanism};
use couloir::model::{Assembled, Point, Posterior};
use couloir::noise;
use couloir::physics::friction::Laws;
use couloir::physics::track::Piece;
use couloir::physics::{Path, Release, State, Track, sample_changed};
use couloir::prior::AnyPrior;
use couloir::scalar::{Plain, Real};
use couloir::{Event, Series};

/// Gravity \[m/s2\].
const G: f64 = 9.81;

/// A run of 200 m in 16 s from 100 m on, five values a second, at 10 m/s;
/// 50 m of track lie above the release.
fn extent() -> Extent {
    Extent {
        begin: 100.0,
        run: 200.0,
        since: 0.0,
        duration: 16.0,
        speed: 10.0,
        step: 0.2,
        behind: 50.0,
        start_speed: 0.0,
        carried: true,
        bends: true,
        averages: true,
        rate_unit: "m/s2",
    }
}

/// What is unknown of each mechanism in that run. A force has sd 1.5 m/s2 at
/// 10 m/s: 0.15 for what is multiplied by the speed, 0.015 by its square. A
/// change of mu has 0.15, a speed at the start 5 m/s, a clock 1 s, a scale
/// 0.1; a place is anywhere in the run. A stretch is at least as long as the
/// distance between values: 0.2 s, of 16, and so 2.5 m of 200.
const PRIORS: &[(&str, &[&str])] = &[
    ("turbulent-drag", &["drag 1/m HalfNormal(0.015)"]),
    ("viscous-drag", &["drag 1/s HalfNormal(0.15)"]),
    ("cohesion", &["force m/s2 HalfNormal(1.5)"]),
    (
        "surge",
        &[
            "force m/s2 Normal(0, 1.5)",
            "from s Uniform(0, 16)",
            "lasts s Uniform(0.2, 16)",
        ],
    ),
    (
        "entrainment",
        &[
            "growth 1/m HalfNormal(0.015)",
            "from m Uniform(100, 300)",
            "length m Uniform(2.5, 200)",
        ],
    ),
    ("spreading", &["push m/s2 Normal(0, 1.5)", "time s Uniform(0.2, 16)"]),
    ("depth-change", &["delta_drag 1/m Normal(0, 0.015)"]),
    ("initial-velocity", &["speed m/s HalfNormal(5)"]),
    ("release-position", &["shift m Normal(0, 20)"]),
    ("clock-offset", &["ahead s Normal(0, 1)"]),
    ("velocity-scale", &["excess 1 Normal(0, 0.1)"]),
    ("sensor-drift", &["drift m/s2 Normal(0, 0.125)"]),
    (
        // ln 5: half the upper-quartile speed.
        "velocity-weakening",
        &[
            "delta_mu 1 HalfNormal(0.15)",
            "speed m/s LogNormal(1.6094379124341003, 0.7)",
        ],
    ),
    (
        "friction-patch",
        &[
            "delta_mu 1 Normal(0, 0.15)",
            "from m Uniform(100, 300)",
            "length m Uniform(2.5, 200)",
        ],
    ),
    (
        "friction-step(distance)",
        &["delta_mu 1 Normal(0, 0.15)", "from m Uniform(100, 300)"],
    ),
    (
        "friction-step(time)",
        &["delta_mu 1 Normal(0, 0.15)", "from s Uniform(0, 16)"],
    ),
    ("friction-hardening(distance, linear)", &["delta_mu 1 Normal(0, 0.15)"]),
    (
        "friction-hardening(distance, saturating)",
        &["delta_mu 1 Normal(0, 0.15)", "scale m Uniform(4, 200)"],
    ),
    ("friction-hardening(time, linear)", &["delta_mu 1 Normal(0, 0.15)"]),
    (
        "friction-hardening(time, saturating)",
        &["delta_mu 1 Normal(0, 0.15)", "scale s Uniform(0.32, 16)"],
    ),
    ("slope-bias", &["angle deg Normal(0, 3)"]),
    ("curvature", &["share 1 LogNormal(0, 0.3)"]),
    ("averaging-window(from the release)", &["window s HalfNormal(1)"]),
    ("averaging-window(whole)", &["window s HalfNormal(1)"]),
];

/// The same prior, to round-off in its arguments.
fn is(prior: &AnyPrior, expected: &str) -> bool {
    let expected = AnyPrior::parse(expected).unwrap();
    let (a, b) = (prior.arguments(), expected.arguments());
    prior.name() == expected.name()
        && a.len() == b.len()
        && a.iter()
            .zip(&b)
            .all(|(a, b)| (a - b).abs() < 1e-12 * b.abs().max(1.0))
}

fn has(mechanism: &dyn Mechanism, expected: &[&str]) {
    let (label, unknowns) = (mechanism.label(), mechanism.unknowns());
    assert_eq!(unknowns.len(), expected.len(), "{label}");
    for (unknown, expected) in unknowns.iter().zip(expected) {
        let (head, prior) = expected.rsplit_once(' ').unwrap();
        let (head, prior) = match head.rsplit_once(' ') {
            // The arguments have a space, too.
            Some((head, first)) if first.contains('(') => {
                (head, format!("{first} {prior}"))
            }
            _ => (head, prior.to_owned()),
        };
        assert_eq!(format!("{} {}", unknown.name, unknown.unit), head);
        let found = &unknown.prior;
        assert!(is(found, &prior), "{label}: {found:?}, not {prior}");
    }
}

#[test]
fn every_prior_is_the_one_in_the_table() {
    let all = catalogue(&extent(), &[]);
    let found: BTreeSet<String> = all.iter().map(|m| m.label()).collect();
    let listed = PRIORS.iter().map(|row| row.0.to_owned()).collect();
    assert_eq!(found, listed);
    for (label, expected) in PRIORS {
        has(find(label, &extent(), &[]).unwrap().as_ref(), expected);
    }
}

/// A mass said to be moving may have been slower; a release may be moved
/// back only as far as there is track.
#[test]
fn priors_follow_how_the_mass_starts() {
    let moving = Extent { start_speed: 3.0, ..extent() };
    let found = find("initial-velocity", &moving, &[]).unwrap();
    has(found.as_ref(), &["speed m/s Normal(0, 5)"]);
    let near = Extent { behind: 10.0, ..extent() };
    let found = find("release-position", &near, &[]).unwrap();
    has(found.as_ref(), &["shift m Uniform(-10, 40)"]);
    let first = Extent { behind: 0.0, ..extent() };
    let found = find("release-position", &first, &[]).unwrap();
    has(found.as_ref(), &["shift m HalfNormal(20)"]);
}

/// Where and when a mass is, and how fast.
struct Now<'a> {
    piece: &'a Piece,
    place: f64,
    time: f64,
    speed: f64,
}

/// The dry friction below what is added.
const MU: f64 = 0.2;

type Added = fn(&Now<'_>) -> f64;

/// Mechanisms with given values, and what they add to du/dt \[m/s2\].
const FORCES: &[(&str, &[f64], Added)] = &[
    ("turbulent-drag", &[0.01], |n| -0.01 * n.speed * n.speed),
    ("viscous-drag", &[0.1], |n| -0.1 * n.speed),
    ("cohesion", &[1.0], |_| -1.0),
    ("surge", &[1.0, 4.0, 4.0], |n| within(n.time, 4.0, 8.0)),
    ("entrainment", &[0.01, 140.0, 45.0], |n| {
        -0.01 * n.speed * n.speed * within(n.place, 140.0, 185.0)
    }),
    ("spreading", &[1.0, 6.0], |n| (-n.time / 6.0).exp()),
    ("depth-change", &[0.01], |n| {
        -0.01 * (n.place - 100.0) / 200.0 * n.speed * n.speed
    }),
    ("velocity-weakening", &[0.1, 5.0], |n| {
        0.1 * (1.0 - (-n.speed / 5.0).exp()) * n.piece.load
    }),
    ("friction-patch", &[0.1, 140.0, 45.0], |n| {
        -0.1 * n.piece.load * within(n.place, 140.0, 185.0)
    }),
    ("friction-step(distance)", &[0.1, 140.0], |n| {
        -0.1 * n.piece.load * within(n.place, 140.0, f64::INFINITY)
    }),
    ("friction-step(time)", &[0.1, 4.0], |n| {
        -0.1 * n.piece.load * within(n.time, 4.0, f64::INFINITY)
    }),
    ("friction-hardening(distance, linear)", &[0.2], |n| {
        -0.2 * (n.place - 100.0) / 200.0 * n.piece.load
    }),
    ("friction-hardening(distance, saturating)", &[0.2, 80.0], |n| {
        -0.2 * (1.0 - (-(n.place - 100.0) / 80.0).exp()) * n.piece.load
    }),
    ("friction-hardening(time, linear)", &[0.2], |n| {
        -0.2 * n.time / 16.0 * n.piece.load
    }),
    ("friction-hardening(time, saturating)", &[0.2, 6.0], |n| {
        -0.2 * (1.0 - (-n.time / 6.0).exp()) * n.piece.load
    }),
    ("curvature", &[1.0], |n| -MU * n.piece.curvature * n.speed * n.speed),
    ("slope-bias", &[2.0], |n| {
        let theta = n.piece.pull.atan2(n.piece.load);
        let steeper = theta + 2.0 * std::f64::consts::PI / 180.0;
        let force = |angle: f64| G * (angle.sin() - MU * angle.cos());
        force(steeper) - force(theta)
    }),
];

/// 1 from one place or time to another, else 0.
fn within(x: f64, from: f64, to: f64) -> f64 {
    f64::from(u8::from((from..to).contains(&x)))
}

fn change(label: &str, values: &[f64]) -> Change<Plain> {
    let values: Vec<Real<Plain>> =
        values.iter().map(|&v| Real::new(v)).collect();
    let mechanism = find(label, &extent(), &[]).unwrap();
    mechanism.change_of(&values)
}

/// A track of pieces of several slopes, on an axis that begins at 100.
fn bent() -> Track {
    let x = [0.0, 30.0, 70.0, 140.0, 900.0];
    let z = [500.0, 482.0, 455.0, 420.0, 120.0];
    Track::from_points(&x, &z).unwrap().with_origin(100.0)
}

/// The motion at three times close together under Coulomb's law and a change.
fn states(
    track: &Track,
    change: &Change<Plain>,
    at: [f64; 3],
) -> Vec<State<Plain>> {
    let law = Laws::default().parse("coulomb").unwrap();
    let mu = [Real::new(MU)];
    let path = Path::new(track, 1.0);
    let release = Release { distance: 0.0.into(), speed: 1.0.into() };
    let mut states = Vec::new();
    let at = at.into_iter().map(Real::new);
    let (law, forces) = (law.with(&mu), &change.forces);
    sample_changed(&path, &law, forces, release, at, false, |s| {
        states.push(s)
    })
    .unwrap();
    states
}

/// The acceleration is read off the speeds, a thousandth of a second to either
/// side: within one piece of the track.
#[test]
fn every_force_is_what_its_formula_says() {
    let (track, half) = (bent(), 0.001);
    for (label, values, added) in FORCES {
        let change = change(label, values);
        for time in [3.03, 6.03, 9.03] {
            let at = [time - half, time, time + half];
            let [before, now, after] =
                states(&track, &change, at).try_into().unwrap();
            let (place, speed) = (now.distance.value(), now.speed.value());
            let piece = &track.pieces()[track.piece_at(place)];
            let place = place + 100.0;
            let now = Now { piece, place, time, speed };
            let gained = (after.speed - before.speed).value() / (2.0 * half);
            let found = gained - (piece.pull - MU * piece.load);
            let expected = added(&now);
            let error = (found - expected).abs();
            assert!(
                error < 1e-3 * expected.abs() + 1e-6,
                "{label} at {time} s, {place} m, {speed} m/s: \
                 {found}, not {expected}"
            );
        }
    }
}

/// Steep for 20 m and then less so.
fn kinked() -> Track {
    let fall = |angle: f64| 20.0 * angle.to_radians().sin();
    let reach = |angle: f64| 20.0 * angle.to_radians().cos();
    let flat = 45.0;
    let x = [0.0, reach(40.0), reach(40.0) + flat * reach(20.0)];
    let z =
        [900.0, 900.0 - fall(40.0), 900.0 - fall(40.0) - flat * fall(20.0)];
    Track::from_points(&x, &z).unwrap()
}

const TIMES: [f64; 6] = [0.5, 1.0, 2.0, 4.0, 6.0, 8.0];

/// An event with Coulomb's law and white noise, and one mechanism.
fn model_of(event: Event, label: &str) -> Assembled {
    let found = find(label, &event.extent(), &[]).unwrap();
    let law = Laws::default().parse("coulomb").unwrap();
    let (noise, none) = (noise::parse("iid").unwrap(), BTreeMap::new());
    Assembled::new(event, law, noise, &none)
        .unwrap()
        .with_mechanisms(vec![found], &none)
        .unwrap()
}

/// What is predicted with an amount of one mechanism.
fn predicted(track: Track, label: &str, amount: f64) -> Vec<f64> {
    let series = Series::velocity(TIMES.to_vec(), vec![10.0; 6]).unwrap();
    let event = Event::on(track).velocity(series).build().unwrap();
    let model = model_of(event, label);
    let posterior = Posterior::new(&model).unwrap();
    let point = Point::Natural(&[amount, MU, 1.0]);
    posterior.collect(point).unwrap().1.predictions[0].clone()
}

/// On an incline the speed is a t, whose mean over the last w seconds is
/// a (t - w/2), and a t/2 or a t^2/(2 w) where those begin before the release.
#[test]
fn every_start_and_measurement_is_what_its_formula_says() {
    let theta = 30.0_f64.to_radians();
    let a = G * (theta.sin() - MU * theta.cos());
    type Shown = fn(f64, f64) -> f64;
    let rows: [(&str, f64, Shown); 7] = [
        ("initial-velocity", 2.0, |a, t| 2.0 + a * t),
        ("clock-offset", 0.7, |a, t| a * (t - 0.7).max(0.0)),
        ("clock-offset", -0.7, |a, t| a * (t + 0.7)),
        ("velocity-scale", 0.1, |a, t| 1.1 * a * t),
        ("sensor-drift", 0.3, |a, t| a * t + 0.3 * t),
        ("averaging-window(from the release)", 1.5, |a, t| {
            a * (t - 0.5 * t.min(1.5))
        }),
        ("averaging-window(whole)", 1.5, |a, t| {
            if t < 1.5 { a * t * t / 3.0 } else { a * (t - 0.75) }
        }),
    ];
    for (label, amount, shown) in rows {
        let track = Track::incline(30.0, 900.0).unwrap();
        let found = predicted(track, label, amount);
        for (found, t) in found.iter().zip(TIMES) {
            let expected = shown(a, t);
            assert!(
                (found - expected).abs() < 1e-9,
                "{label} at {t} s: {found}, not {expected}"
            );
        }
    }
}

/// A release 5 m further down has 15 m left of the steep 20 m.
#[test]
fn a_release_is_shifted_down_the_track() {
    let found = predicted(kinked(), "release-position", 5.0);
    let a = [40.0_f64, 20.0].map(|angle| {
        let theta = angle.to_radians();
        G * (theta.sin() - MU * theta.cos())
    });
    let kink = (2.0 * 15.0 / a[0]).sqrt();
    for (found, t) in found.iter().zip(TIMES) {
        let expected = a[0] * t.min(kink) + a[1] * (t - kink).max(0.0);
        assert!((found - expected).abs() < 1e-9, "{t} s: {found} {expected}");
    }
}

/// Nothing in the catalogue goes without a test of what it does.
#[test]
fn every_effect_is_tested() {
    let elsewhere = [
        "initial-velocity",
        "release-position",
        "clock-offset",
        "velocity-scale",
        "sensor-drift",
        "averaging-window(from the release)",
        "averaging-window(whole)",
    ];
    let tested: BTreeSet<&str> =
        FORCES.iter().map(|row| row.0).chain(elsewhere).collect();
    let all: BTreeSet<&str> = PRIORS.iter().map(|row| row.0).collect();
    assert_eq!(tested, all);
}
