//! How long does one simulation take, exact and numerical?
//!
//! What an added force costs, `force, ..`, is printed as the ratio to the same
//! motion without it, and what a law costs that says it varies with the speed,
//! `by speed, ..`, as the ratio to the same law in closed form; both for plain
//! numbers and for numbers with derivatives. `cargo bench --bench one_flow --
//! ratio` prints nothing else.

#![allow(missing_docs, clippy::print_stdout)]

mod reference;

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, criterion_group, criterion_main};

use couloir::physics::forces::{Axis, Range, STEPS, Shape, Stretch, Term};
use couloir::physics::friction::{
    LawKind, Laws, Turbulent, VelocityWeakening, Voellmy,
};
use couloir::physics::{
    Forces, Friction, Rate, Site, State, Sum, Varies, sample, sample_changed,
};
use couloir::scalar::{Grad, Kind, Plain, Real};

fn slide(criterion: &mut Criterion, name: &str, law: &impl Friction<Plain>) {
    let event = reference::event();
    let times = event.velocity.times();
    criterion.bench_function(name, |b| {
        b.iter(|| {
            let mut sum = 0.0;
            let path = event.path();
            let visit = |s: couloir::physics::State<Plain>| {
                sum += s.speed.value();
            };
            let release = event.release();
            let done = sample(&path, law, release, times, true, visit);
            assert!(done.is_ok());
            sum
        });
    });
}

fn flows(criterion: &mut Criterion) {
    let number = Real::<Plain>::new;
    let voellmy = Voellmy { mu: number(0.32), xi: number(495.73) };
    slide(criterion, "flow, exact", &voellmy);
    let weakening =
        VelocityWeakening { mu: number(0.5), r: number(0.6), u0: number(8.0) };
    slide(criterion, "flow, by speed", &weakening);
}

/// Voellmy's law, said to vary with the speed in a way of its own.
struct BySpeed<L>(L);

impl<K: Kind, L: Friction<K>> Friction<K> for BySpeed<L> {
    fn varies(&self) -> Varies {
        Varies::WithSpeed
    }
    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K> {
        self.0.rate(at, speed)
    }
}

/// Voellmy's drag and a friction that weakens, as strong in the middle.
fn weakening_drag<K: Kind>() -> impl Friction<K> {
    let number = |value, i| Real::<K>::variable(value, i);
    let [mu, r] = [number(0.35, 0), number(0.6, 2)];
    let dry = VelocityWeakening { mu, r, u0: number(8.0, 3) };
    Sum::new(dry, Turbulent { xi: number(390.0, 1) })
}

/// The seconds of some simulations under a law.
fn seconds_under<K: Kind>(law: &impl Friction<K>) -> f64 {
    let event = reference::event();
    let (path, release) = (event.path(), event.release());
    let mut sum = 0.0;
    let mut visit = |s: State<K>| sum += s.speed.value();
    let begun = Instant::now();
    for _ in 0..200 {
        let (law, times) = (black_box(law), event.velocity.times());
        let done = sample(&path, law, release, times, true, &mut visit);
        assert!(done.is_ok());
    }
    black_box(sum);
    begun.elapsed().as_secs_f64()
}

/// Prints the ratios of the shortest of interleaved runs.
fn by_speed_over_exact<K: Kind>(kind: &str) {
    let [mu, xi] = [(0.25, 0), (390.0, 1)];
    let [mu, xi] = [mu, xi].map(|(value, i)| Real::<K>::variable(value, i));
    let exact = Voellmy { mu, xi };
    let mut least = [f64::INFINITY; 3];
    for _ in 0..40 {
        let now = [
            seconds_under(&exact),
            seconds_under(&BySpeed(exact)),
            seconds_under(&weakening_drag::<K>()),
        ];
        least = std::array::from_fn(|i| least[i].min(now[i]));
    }
    let [exact, same, weakening] = least;
    let (same, weakening) = (same / exact, weakening / exact);
    println!("by speed, Voellmy, {kind}: {same:.1} times closed form");
    println!("by speed, weakening drag, {kind}: {weakening:.1} times");
}

/// Forces as mechanisms add them; the edges are unknown, too.
fn forces<K: LawKind>(name: &str) -> Forces<K> {
    let number = |value, i| Real::<K>::variable(value, i);
    let mu = Rate { mu: number(0.1, 2), ..Rate::default() };
    let run = Range { begin: 0.0, span: 430.0 };
    let mut term = Term::everywhere(mu);
    match name {
        "patch" => {
            let edges = [number(150.3, 3), number(260.7, 4)];
            term.over = Stretch::Between(Axis::Place, edges);
        }
        "surge" => {
            let edges = [number(5.3, 3), number(9.7, 4)];
            term.over = Stretch::Between(Axis::Time, edges);
        }
        "hardening" => term.shape = Shape::Linear(Axis::Place, run),
        "weakening" => term.shape = Shape::WithSpeed(number(8.0, 3)),
        _ => {
            let cells = (0..40).map(|i| number(f64::from(i).sin(), 2));
            term.shape = Shape::Cells(Axis::Place, run, cells.collect());
        }
    }
    let mut forces = Forces::default();
    forces.terms.push(term);
    forces.step = 21.0 / STEPS;
    forces
}

/// The seconds of some simulations, with forces or without.
fn seconds<K: LawKind>(forces: Option<&Forces<K>>) -> f64 {
    let event = reference::event();
    let laws = Laws::default().parse("voellmy");
    let Ok(laws) = laws else { return f64::NAN };
    let values = [Real::<K>::variable(0.25, 0), Real::variable(390.0, 1)];
    let times = event.velocity.times();
    let (path, release) = (event.path(), event.release());
    let mut sum = 0.0;
    let mut visit = |s: State<K>| sum += s.speed.value();
    let begun = Instant::now();
    for _ in 0..200 {
        let law = laws.with(black_box(&values));
        let done = match black_box(forces) {
            None => sample(&path, &law, release, times, true, &mut visit),
            Some(forces) => {
                let at = times.iter().map(|&t| Real::new(t));
                sample_changed(
                    &path, &law, forces, release, at, true, &mut visit,
                )
            }
        };
        assert!(done.is_ok());
    }
    black_box(sum);
    begun.elapsed().as_secs_f64()
}

/// Prints the ratio of the shortest of interleaved runs.
fn with_over_without<K: LawKind>(kind: &str, name: &str) {
    let forces = forces::<K>(name);
    let (mut with, mut without) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..40 {
        with = with.min(seconds(Some(&forces)));
        without = without.min(seconds::<K>(None));
    }
    println!("force, {name}, {kind}: {:.2} times without", with / without);
}

fn ratios(_: &mut Criterion) {
    by_speed_over_exact::<Plain>("plain");
    by_speed_over_exact::<Grad<8>>("8 derivatives");
    by_speed_over_exact::<Grad<16>>("16 derivatives");
    for name in ["patch", "surge", "hardening", "weakening", "cells"] {
        with_over_without::<Plain>("plain", name);
        with_over_without::<Grad<8>>("8 derivatives", name);
        with_over_without::<Grad<16>>("16 derivatives", name);
    }
}

criterion_group!(benches, flows, ratios);
criterion_main!(benches);
