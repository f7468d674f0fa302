//! Gradients of models with many parameters, found backwards: the same as
//! forward, to round-off.
//!
//! The information of a model at a point is worked out forward, however many
//! parameters there are; its gradient is what all are compared with.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use couloir::Seed;
use couloir::mechanism::catalogue::catalogue;
use couloir::model::{Density, Together, Weights, With};
use couloir::noise::Ar;
use couloir::prelude::*;
use couloir::prior::{
    Beta, Gamma, HalfNormal, InverseGamma, LogNormal, Normal, Uniform,
};
use rand::RngExt;
use rayon::prelude::*;

/// A school's results: values about a centre of its own, centres about a
/// mean, and a chance of heavy tails in each.
struct Schools {
    data: Vec<Vec<f64>>,
}

impl Schools {
    fn new(groups: usize) -> Self {
        let value = |i: usize, j: usize| (1.7 * i as f64 + j as f64).sin();
        let group = |i| (0..3).map(|j| value(i, j)).collect();
        Self { data: (0..groups).map(group).collect() }
    }
}

impl Program for Schools {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mean =
            run.scalar(Label::new("mean", "1"), Normal::new(0.0, 3.0))?;
        let spread =
            run.scalar(Label::new("spread", "1"), HalfNormal::new(1.0))?;
        for (i, values) in self.data.iter().enumerate() {
            let centre = Label::new("centre", "1").at(i);
            let centre = run.scalar(centre, Normal::new(mean, spread))?;
            let sd = Label::new("sd", "1").at(i);
            let sd = run.scalar(sd, LogNormal::new(0.0, spread))?;
            let share = Label::new("share", "1").at(i);
            let share = run.scalar(share, Beta::new(2.0, 1.0 + spread))?;
            let width = sd * (1.0 + share * share) + share.max(0.5);
            run.observe_each(values, Normal::new(centre, width))?;
        }
        Ok(())
    }
}

fn slope() -> Track {
    let x: Vec<f64> = (0..=80).map(|i| 5.0 * f64::from(i)).collect();
    let z = x.iter().map(|x| 0.0012 * (400.0 - x).powi(2) - 0.1 * x);
    Track::from_points(&x, &z.clone().collect::<Vec<_>>()).unwrap()
}

fn event(name: &str) -> Event {
    let times: Vec<f64> = (1..=30).map(|i| 0.5 * f64::from(i)).collect();
    let values = times.iter().map(|t| 25.0 * (t / 8.0).sin().abs());
    let values = values.collect();
    let series = Series::velocity(times, values).unwrap();
    Event::on(slope()).named(name).velocity(series).build().unwrap()
}

/// An avalanche with a law and correlated errors of its own.
struct Avalanche(Event);

impl Program for Avalanche {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mu = run.scalar(Label::new("mu", "1"), Gamma::new(9.0, 0.03))?;
        let xi =
            run.scalar(Label::new("xi", "m/s2"), Gamma::new(2.5, 400.0))?;
        let drag = Label::new("k", "1/s");
        let k = run.scalar(drag, HalfNormal::new(0.01))?;
        let phi =
            run.scalar(Label::new("phi", "1"), Uniform::new(-1.0, 1.0))?;
        let sigma2 = Label::new("sigma2", "m2/s2");
        let sigma2 = run.scalar(sigma2, InverseGamma::new(3.0, 20.0))?;
        let law = Sum::new(Voellmy { mu, xi }, Viscous { k });
        let law = run.declare(law);
        let phi = [phi].into_iter().collect();
        let errors = run.declare(Ar { phi, sigma2 });
        let flow = self.0.slide(&law)?;
        run.observe(&self.0.velocity, flow.velocity(), &errors)
    }
}

fn avalanches(count: usize) -> Together<(Avalanche, Event)> {
    let member = |i: usize| {
        let event = event(&format!("event{i}"));
        (Avalanche(event.clone()), event)
    };
    Together::new((0..count).map(member).collect()).unwrap()
}

/// Places on the line that the prior may well have drawn.
fn places(model: &dyn Model, seed: u64) -> Vec<f64> {
    let count = Posterior::new(model).unwrap().dimension();
    let mut rng = Seed::new(seed).rng();
    (0..count).map(|_| rng.random_range(-1.0..1.0)).collect()
}

fn backwards(model: &dyn Model, z: &[f64]) -> (Density, Vec<f64>) {
    let mut gradient = vec![f64::NAN; z.len()];
    let density = model.gradient(z, Weights::LINE, &mut gradient).unwrap();
    (density, gradient)
}

/// Compares both ways; both add the same terms in another order, so they
/// differ by the round-off of the largest of them, amplified where terms
/// cancel along a motion of some hundred steps.
fn compare(model: &dyn Model, z: &[f64]) -> Density {
    let (density, found) = backwards(model, z);
    let known = model.information(z).unwrap();
    assert!(found.len() > 16, "too few parameters for a tape");
    assert_eq!(density.rejected, known.density.rejected);
    let largest = known.gradient.amax();
    for (i, (a, b)) in found.iter().zip(known.gradient.iter()).enumerate() {
        let apart = (a - b).abs() / (b.abs() + 1e-3 * largest).max(1e-300);
        assert!(apart < 1e-11, "{i}: {a} instead of {b}, {apart:e}");
    }
    density
}

#[test]
fn a_hierarchy_of_two_hundred_has_the_forward_gradient() {
    let model = Schools::new(66);
    for seed in 0..20 {
        let z = places(&model, seed);
        assert_eq!(z.len(), 200);
        assert!(compare(&model, &z).rejected.is_none());
    }
}

#[test]
fn flows_have_the_forward_gradient() {
    let model = avalanches(8);
    let mut scored = 0;
    for seed in 0..20 {
        let density = compare(&model, &places(&model, seed));
        scored += usize::from(density.rejected.is_none());
        // One motion each: backwards it is solved once.
        assert!(density.slides <= 8);
    }
    assert!(scored > 10, "{scored}");
}

#[test]
fn flows_under_mechanisms_have_the_forward_gradient() {
    let base = avalanches(4);
    let event = event("");
    let mut compared = 0;
    for mechanism in catalogue(&event.extent(), &[]) {
        let model = With::new(&base, &[mechanism.as_ref()]);
        for seed in 0..3 {
            let z = places(&model, seed);
            compared += usize::from(compare(&model, &z).rejected.is_none());
        }
    }
    assert!(compared > 30, "{compared}");
}

/// Rejects where the first parameter is positive, after most are declared.
struct Half(Schools);

impl Program for Half {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let side = run.scalar(Label::new("x", "1"), Normal::new(0.0, 1.0))?;
        self.0.run(run)?;
        if side > 0.0 {
            return Err(Stop::Reject("on the wrong side"));
        }
        Ok(())
    }
}

#[test]
fn a_rejected_density_has_no_gradient() {
    let model = Half(Schools::new(10));
    let mut z = places(&model, 1);
    z[0] = -0.5;
    assert!(compare(&model, &z).rejected.is_none());
    let before = backwards(&model, &z);
    z[0] = 0.5;
    let (density, gradient) = backwards(&model, &z);
    assert_eq!(density.rejected, Some("on the wrong side"));
    assert!(gradient.iter().all(|g| *g == 0.0));
    // What was recorded in vain is forgotten.
    z[0] = -0.5;
    assert_eq!(backwards(&model, &z), before);
}

/// Avalanches whose friction falls with their speed: their motion is
/// integrated, which no tape follows.
struct Weakening(Event);

impl Program for Weakening {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mut any = |name| {
            run.scalar(Label::new(name, "1"), LogNormal::new(-0.7, 0.2))
        };
        let (mu, r, u0) = (any("mu")?, any("r")?, 12.0 * any("u0")?);
        let law = run.declare(VelocityWeakening { mu, r, u0 });
        let errors = run.declare(Iid { sigma2: Real::new(4.0) });
        let flow = self.0.slide(&law)?;
        run.observe(&self.0.velocity, flow.velocity(), &errors)
    }
}

#[test]
fn integrated_motions_go_forward() {
    let member = |i: usize| {
        let event = event(&format!("event{i}")).first(6).unwrap();
        (Weakening(event.clone()), event)
    };
    let model = Together::new((0..6).map(member).collect()).unwrap();
    let z = places(&model, 3);
    assert!(compare(&model, &z).rejected.is_none());
}

/// Forms its likelihood on two threads.
struct Apart(Vec<f64>);

impl Program for Apart {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let x = Label::new("x", "1");
        let x = run.vector(x, self.0.len(), Normal::new(0.0, 1.0))?;
        let half = x.len() / 2;
        let sum = |x: &[Real<K>]| x.iter().map(|x| x.exp() * *x).sum();
        let (a, b): (Real<K>, Real<K>) =
            rayon::join(|| sum(&x[..half]), || sum(&x[half..]));
        run.observe_each(&self.0, Normal::new(a * b, 2.0))
    }
}

#[test]
fn a_body_may_use_other_threads() {
    let model = Apart((0..40).map(|i| f64::from(i).cos()).collect());
    for seed in 0..20 {
        compare(&model, &places(&model, seed));
    }
}

#[test]
fn threads_do_not_disturb_each_other() {
    let (schools, flows) = (Schools::new(40), avalanches(5));
    let models: [&dyn Model; 2] = [&schools, &flows];
    let jobs: Vec<_> = (0..60).map(|seed| (seed, models[seed % 2])).collect();
    let found = |&(seed, model): &(usize, &dyn Model)| {
        backwards(model, &places(model, seed as u64)).1
    };
    let one_by_one: Vec<_> = jobs.iter().map(found).collect();
    for _ in 0..5 {
        let together: Vec<_> = jobs.par_iter().map(found).collect();
        assert_eq!(one_by_one, together);
    }
}

/// Asks another model for its gradient in the middle of its own body.
struct Nested {
    own: Schools,
    other: Schools,
}

impl Program for Nested {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let x = run.scalar(Label::new("x", "1"), Normal::new(0.0, 1.0))?;
        let z = places(&self.other, 8);
        let slope = backwards(&self.other, &z).1[3];
        run.observe_each(&slope, Normal::new(x, 1.0))?;
        self.own.run(run)
    }
}

#[test]
fn gradients_within_gradients_stand_apart() {
    // Many nodes before and within: more than are filed at once.
    for (own, other) in [(10, 10), (60, 300), (300, 60)] {
        let model =
            Nested { own: Schools::new(own), other: Schools::new(other) };
        let z = places(&model, 5);
        compare(&model, &z);
        let again = backwards(&model, &z);
        assert_eq!(again, backwards(&model, &z));
    }
}
