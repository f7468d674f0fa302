//! Each effect acts, and size zero is the baseline.

use super::*;
use crate::challenge::ground::Shape;
use crate::challenge::moments::Moment;
use crate::challenge::motion::{Law, STEP, slide};
use crate::seed::Seed;

const LAW: Law = Law::Coulomb { mu: 0.35 };

fn ground() -> Ground {
    Ground::draw(Shape::Bends, &mut Seed::new(8).rng())
}

fn scene(ground: &Ground, size: f64) -> Scene<'_> {
    let (upper, top, from, to, duration) = (20.0, 30.0, 50.0, 180.0, 12.0);
    let other = size;
    Scene { size, other, ground, upper, top, from, to, duration }
}

/// Speeds and the errors upon them, with an effect of a size.
fn recorded(kind: &Kind, size: f64) -> (Vec<f64>, Vec<f64>, Ground) {
    let ground = ground();
    let seed = Seed::new(9);
    let scene = scene(&ground, size);
    let effect = (kind.make)(&scene, &mut seed.rng()).unwrap();
    let start = effect.start(Start { place: 50.0, speed: 0.0 }, 0);
    let run = slide(&ground, &LAW, &*effect, start, 12.0, STEP);
    let at = |i: i32| effect.read(&run, 0.1 * f64::from(i), 0);
    let values: Vec<f64> = (1..110).map(at).collect();
    let noise = effect.noise(0.3, &values, &mut seed.child(1).rng());
    let survey = effect.survey(&ground).unwrap_or_else(|| ground.clone());
    (values, noise, survey)
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / a.len() as f64).sqrt()
}

#[test]
fn every_effect_acts_and_none_at_size_zero() {
    let (values, noise, survey) = recorded(NONE, 0.0);
    assert!(apart(&values, &[0.0; 109]) > 5.0);
    for kind in CATALOGUE.into_iter().chain(OUTSIDE) {
        let (zero, quiet, same) = recorded(kind, 0.0);
        let name = kind.name;
        assert!(apart(&values, &zero) < 1e-6, "{name} at size zero");
        assert!(apart(&noise, &quiet) < 1e-9, "{name} at size zero");
        assert!(survey == same, "{name} at size zero");
        let (low, high) = kind.range;
        for size in [low, high, -high] {
            if size < 0.0 && !kind.signed {
                continue;
            }
            let (with, loud, other) = recorded(kind, size);
            let acts = apart(&values, &with) > 0.05
                || apart(&noise, &loud) > 0.05
                || other != survey;
            assert!(acts, "{name} of {size} does nothing");
        }
    }
}

#[test]
fn names_are_told_once() {
    let all: Vec<_> =
        CATALOGUE.iter().chain(&OUTSIDE).map(|k| k.name).collect();
    for (i, name) in all.iter().enumerate() {
        assert!(!all[..i].contains(name), "{name}");
    }
}

#[test]
fn correlated_errors_have_their_variance() {
    let ground = ground();
    let mut rng = Seed::new(4).rng();
    let scene = scene(&ground, 0.8);
    let effect = (ar1::KIND.make)(&scene, &mut rng).unwrap();
    let errors = effect.noise(0.3, &[0.0; 40_000], &mut rng);
    let product = |lag: usize| -> f64 {
        let pairs = errors.iter().zip(&errors[lag..]);
        pairs.map(|(a, b)| a * b).sum::<f64>() / errors.len() as f64
    };
    assert!((product(0) - 0.09).abs() < 0.006);
    assert!((product(1) / product(0) - 0.8).abs() < 0.02);
}

#[test]
fn half_the_step_gives_the_same_speeds_with_every_effect() {
    let ground = ground();
    for kind in CATALOGUE.into_iter().chain(OUTSIDE) {
        let scene = scene(&ground, kind.range.1);
        let effect = (kind.make)(&scene, &mut Seed::new(2).rng()).unwrap();
        let start = effect.start(Start { place: 50.0, speed: 0.0 }, 0);
        let run = |step| slide(&ground, &LAW, &*effect, start, 20.0, step);
        let (whole, half) = (run(STEP), run(0.5 * STEP));
        for k in 1..200 {
            let t = 0.1 * f64::from(k);
            let change = whole.speed(t) - half.speed(t);
            assert!(change.abs() < 1e-4, "{} {t} {change}", kind.name);
        }
    }
}

#[test]
fn hardening_begins_where_the_first_mass_starts() {
    let ground = ground();
    let at = |s: f64| -> Vec<f64> {
        let changed = (1..=20).map(|seed| {
            let mut rng = Seed::new(seed).rng();
            let make = friction_hardening::KIND.make;
            let effect = make(&scene(&ground, 0.2), &mut rng).unwrap();
            let (u, t) = (10.0, 0.0);
            effect.mu(0.3, &Moment { s, u, t, place: s, time: t })
        });
        changed.collect()
    };
    assert!(at(30.0).iter().all(|mu| *mu == 0.3));
    // Of about half it is distance that hardens.
    let changed = at(50.0).into_iter().filter(|mu| *mu > 0.31).count();
    assert!((4..=16).contains(&changed), "{changed}");
}
