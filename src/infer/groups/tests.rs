//! Three groups with something in common, against the whole and against
//! quadrature.

use super::*;
use crate::error::Outcome;
use crate::infer::Quiet;
use crate::model::{Label, Number, Program, Run};
use crate::prior::{AnyPrior, Normal};
use crate::scalar::Real;

/// a ~ N(0, 1); for each of some events b ~ Exponential of mean 2, and 0.5 was
/// seen of N(a b, 1).
struct Events(&'static [usize]);

impl Program for Events {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let a = AnyPrior::Normal(0.0, 1.0);
        let a = run.scalar(Label::new("a", "1"), a)?;
        for &event in self.0 {
            let b = AnyPrior::Exponential(2.0);
            let b = run.scalar(Label::new("b", "1").at(event), b)?;
            run.observe_each(&0.5, Normal::new(a * b, Real::new(1.0)))?;
        }
        Ok(())
    }
}

const PROGRAMS: [Events; 5] = [
    Events(&[0, 1, 2]),
    Events(&[]),
    Events(&[0]),
    Events(&[1]),
    Events(&[2]),
];

/// Gives a test the three events and what they have in common.
fn with_events(test: impl FnOnce(&Grouped<'_>, &Group<'_>)) {
    let all = PROGRAMS.each_ref().map(|p| Posterior::new(p).unwrap());
    let [whole, common, groups @ ..] = &all;
    let common = Group { posterior: common, places: vec![0] };
    let groups = groups
        .iter()
        .enumerate()
        .map(|(i, posterior)| Group { posterior, places: vec![0, 1 + i] })
        .collect();
    test(&Grouped { whole, common: None, groups }, &common);
}

/// By midpoints, to 1e-5: both integrands are smooth and gone at the ends.
fn log_evidence() -> f64 {
    let sum = |from: f64, to: f64, count: i32, f: &dyn Fn(f64) -> f64| {
        let step = (to - from) / f64::from(count);
        let at = |i| from + (f64::from(i) + 0.5) * step;
        (0..count).map(|i| f(at(i))).sum::<f64>() * step
    };
    let normal = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
    let one = |a: f64| {
        let density = |b: f64| 0.5 * (-0.5 * b).exp() * normal(0.5 - a * b);
        sum(0.0, 60.0, 4000, &density)
    };
    sum(-8.0, 8.0, 400, &|a| normal(a) * one(a).powi(3)).ln()
}

#[test]
fn one_within_the_other_is_as_all_at_once() {
    let known = log_evidence();
    let laplace = LaplaceMixture::default();
    with_events(|grouped, common| {
        let seed = Seed::new(1);
        let LaplaceMixture { space, schedule } = &laplace;
        let parts = components(grouped.whole, space, schedule, seed.child(0));
        let parts = parts.unwrap();
        let sharp = Precision::Sharp;
        let effort = laplace.effort(sharp);
        let nested =
            laplace.nested(grouped, common, &parts, effort, seed.child(1));
        let either =
            laplace.within_common(grouped, common, sharp, seed, &Quiet);
        let [nested, either] = [nested, either].map(|found| {
            let found = found.unwrap();
            assert_eq!(found.warnings, Vec::<String>::new());
            found.evidence.unwrap()
        });
        assert_eq!(nested.method, NESTED);
        assert_ne!(either.method, NESTED);
        for found in [nested, either] {
            let off = (found.log - known).abs();
            // Four standard errors of the estimate.
            let what = format!("{found:?}, {known}");
            assert!(off < 4.0 * found.se && found.se < 0.05, "{what}");
        }
    });
}

/// a ~ N(0, 1), and b ~ N(a, 0.1).
struct Leaning;

impl Program for Leaning {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let a = AnyPrior::Normal(0.0, 1.0);
        let a = run.scalar(Label::new("a", "1"), a)?;
        let near = Normal::new(a, Real::new(0.1));
        run.scalar(Label::new("b", "1"), near)?;
        Ok(())
    }
}

#[test]
fn a_prior_that_leans_on_what_is_in_common_is_drawn_given_that() {
    let posterior = Posterior::new(&Leaning).unwrap();
    let mut rng = Seed::new(1).rng();
    for _ in 0..100 {
        let known = [5.0, f64::NAN];
        let drawn = posterior.draw_place_given(&known, &mut rng);
        let line = drawn.unwrap().unwrap();
        assert_eq!(line[0], 5.0);
        // Six standard deviations.
        assert!((line[1] - 5.0).abs() < 0.6, "{line:?}");
    }
}

/// a ~ N(0, 1); for each of some events b ~ N(0, 1), rejected above 1, then
/// c ~ N(0, 1), and 0.5 was seen of N(c, 1).
struct Rejecting(&'static [usize]);

impl Program for Rejecting {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let normal = AnyPrior::Normal(0.0, 1.0);
        run.scalar(Label::new("a", "1"), normal)?;
        for &event in self.0 {
            let b = run.scalar(Label::new("b", "1").at(event), normal)?;
            if b > 1.0 {
                return Err(crate::error::Stop::Reject("b is above 1"));
            }
            let c = run.scalar(Label::new("c", "1").at(event), normal)?;
            run.observe_each(&0.5, Normal::new(c, Real::new(1.0)))?;
        }
        Ok(())
    }
}

#[test]
fn a_group_that_rejects_before_its_last_parameter_counts_as_nothing_there() {
    let all = [
        Rejecting(&[0, 1, 2]),
        Rejecting(&[]),
        Rejecting(&[0]),
        Rejecting(&[1]),
        Rejecting(&[2]),
    ];
    let all = all.each_ref().map(|p| Posterior::new(p).unwrap());
    let [whole, common, groups @ ..] = &all;
    let common = Group { posterior: common, places: vec![0] };
    let places = |i: usize| vec![0, 1 + 2 * i, 2 + 2 * i];
    let groups = groups.iter().enumerate();
    let groups =
        groups.map(|(i, p)| Group { posterior: p, places: places(i) });
    let groups = groups.collect();
    let grouped = Grouped { whole, common: None, groups };
    let laplace = LaplaceMixture::default();
    let LaplaceMixture { space, schedule } = &laplace;
    let seed = Seed::new(1);
    let parts = components(whole, space, schedule, seed.child(0)).unwrap();
    let effort = laplace.effort(Precision::Sharp);
    let found = laplace.nested(&grouped, &common, &parts, effort, seed);
    let found = found.unwrap().evidence.unwrap();
    // Phi(1) times the density of N(0, sqrt 2) at 0.5, for each.
    let one = 0.841_344_746_f64.ln()
        - 0.25 * 0.25
        - 0.5 * (2.0 * std::f64::consts::TAU).ln();
    let off = (found.log - 3.0 * one).abs();
    // Four standard errors of the estimate.
    assert!(off < 4.0 * found.se && found.se < 0.1, "{found:?} {one}");
}
