//! The evidence three ways on twenty synthetic events, several of which a
//! model can explain in two places.
//!
//! `docs/evidence.md` holds the table that the slow test here prints:
//! `cargo test --release --test evidence -- --ignored --nocapture`.

#![allow(clippy::print_stdout, reason = "the table is what it is run for")]

use couloir::context::Context;
use couloir::observe::Prediction as _;
use couloir::prelude::*;
use couloir::prior::AnyPrior;
use couloir::scalar::Plain;
use couloir::{Declared, seed::Rng};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

/// Dry friction that differs between two places, and drag.
#[derive(Debug, Clone)]
struct Patched<S> {
    mu: S,
    /// Drag per squared speed and depth; 0 under Coulomb's law alone.
    drag: S,
    /// By how much, from where, over which length.
    patches: Vec<[S; 3]>,
    /// Whether a patch fades in and out over some metres; otherwise a piece
    /// of the track has it or not.
    smooth: bool,
}

/// Over which length a smooth patch fades \[m\].
const FADE: f64 = 10.0;

impl<K: Kind> Friction<K> for Patched<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::WithPlace
    }

    fn rate(&self, at: &Site, _: Real<K>) -> Rate<K> {
        let mut mu = self.mu;
        for [delta, begin, length] in &self.patches {
            let beyond = -(*begin - at.distance);
            mu += *delta * self.covered(beyond, *length);
        }
        let quadratic = self.drag / at.depth;
        Rate { mu, quadratic, ..Rate::default() }
    }
}

impl<K: Kind> Patched<Real<K>> {
    /// How much of a patch there is so far beyond its begin.
    fn covered(&self, beyond: Real<K>, length: Real<K>) -> Real<K> {
        if self.smooth {
            let step = |x: Real<K>| ((x / (2.0 * FADE)).tanh() + 1.0) * 0.5;
            return step(beyond) - step(beyond - length);
        }
        let inside = beyond.value() >= 0.0 && (beyond - length).value() < 0.0;
        Real::new(if inside { 1.0 } else { 0.0 })
    }
}

/// A model with one patch, whatever the truth has.
#[derive(Debug)]
struct OnePatch {
    event: Event,
    kind: Case,
}

/// What tells the twenty events apart.
#[derive(Debug, Clone, Copy)]
struct Case {
    index: u64,
    drag: bool,
    smooth: bool,
    correlated: bool,
    /// Whether the truth has two patches of which the model can have one.
    twin: bool,
}

const GRAVITY: f64 = 9.81;

impl Program for OnePatch {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        use AnyPrior::{Gamma, InverseGamma, Normal, Uniform};
        let pure = |name| Label::new(name, "1");
        let metres = |name| Label::new(name, "m");
        let mu = run.scalar(pure("mu"), Gamma(9.0, 0.03))?;
        let mut drag = Real::new(0.0);
        if self.kind.drag {
            let xi =
                run.scalar(Label::new("xi", "m/s2"), Gamma(2.5, 400.0))?;
            drag = GRAVITY / xi;
        }
        let delta = run.scalar(pure("delta_mu"), Normal(0.0, 0.1))?;
        let begin = run.scalar(metres("begin"), Uniform(0.0, 900.0))?;
        let length = run.scalar(metres("length"), Gamma(3.0, 50.0))?;
        let patches = vec![[delta, begin, length]];
        let smooth = self.kind.smooth;
        let law = run.declare(Patched { mu, drag, patches, smooth });
        let flow = self.event.slide(&law)?;
        let series = &self.event.velocity;
        let variance = Label::new("sigma2", "m2/s2");
        if self.kind.correlated {
            let phi = run.scalar(pure("phi"), Uniform(-1.0, 1.0))?;
            let sigma2 = run.scalar(variance, InverseGamma(3.0, 1.0))?;
            let phi = [phi].into_iter().collect();
            let errors = run.declare(Ar { phi, sigma2 });
            return run.observe(series, flow.velocity(), &errors);
        }
        let sigma2 = run.scalar(variance, InverseGamma(3.0, 1.0))?;
        let errors = run.declare(Iid { sigma2 });
        run.observe(series, flow.velocity(), &errors)
    }
}

/// The twenty: both laws, both kinds of edge, both noises, eight twins.
fn cases() -> Vec<Case> {
    let case = |index: u64| Case {
        index,
        drag: index % 2 == 0,
        smooth: index / 2 % 2 == 0,
        correlated: index / 4 % 2 == 1,
        twin: index % 5 == 1 || index % 5 == 3,
    };
    (0..20).map(case).collect()
}

/// A slope of 50 pieces: steeper where drag holds the mass back.
fn track(case: Case, rng: &mut Rng) -> Track {
    let mean = if case.drag { 29.0 } else { 20.0 };
    let (mut x, mut z) = (vec![0.0], vec![0.0]);
    for piece in 1..=50 {
        let wave: f64 = rng.random_range(-2.0..2.0);
        let angle: f64 = mean + wave;
        x.push(20.0 * f64::from(piece));
        z.push(z[piece as usize - 1] - 20.0 * angle.to_radians().tan());
    }
    Track::from_points(&x, &z).unwrap()
}

fn truth(case: Case, rng: &mut Rng) -> Patched<f64> {
    let mu = rng.random_range(0.2..0.25);
    let xi = rng.random_range(800.0..1500.0);
    let drag = if case.drag { GRAVITY / xi } else { 0.0 };
    let size = if case.twin { 0.05..0.06 } else { 0.05..0.1 };
    let delta: f64 = rng.random_range(size);
    let begin = rng.random_range(100.0..200.0);
    let mut patches = vec![[delta, begin, rng.random_range(80.0..120.0)]];
    if case.twin {
        let begin = rng.random_range(500.0..600.0);
        let sign = if case.drag { 1.0 } else { -1.0 };
        let ratio = rng.random_range(0.9..1.1);
        let length = rng.random_range(80.0..120.0);
        patches.push([sign * ratio * delta, begin, length]);
    }
    Patched { mu, drag, patches, smooth: case.smooth }
}

/// The speeds of an event under a law without errors.
fn speeds(event: &Event, law: &Patched<f64>) -> Vec<f64> {
    let real = Real::<Plain>::new;
    let law = Patched {
        mu: real(law.mu),
        drag: real(law.drag),
        patches: law.patches.iter().map(|p| p.map(real)).collect(),
        smooth: law.smooth,
    };
    let context = Context::new();
    let law = Declared::new(law, &context);
    let flow = event.slide(&law).unwrap();
    let mut speeds = Vec::new();
    let series = &event.velocity;
    flow.velocity().predict(series, |v| speeds.push(v.value())).unwrap();
    speeds
}

/// An event on a track with values of 0 at so many times up to a last.
fn blank(track: &Track, last: f64, count: usize) -> Event {
    let times: Vec<f64> =
        (1..=count).map(|i| last * i as f64 / count as f64).collect();
    Event::on(track.clone())
        .depth(2.0)
        .velocity(Series::velocity(times, vec![0.0; count]).unwrap())
        .build()
        .unwrap()
}

/// When the mass has gone 850 m.
fn duration(track: &Track, law: &Patched<f64>) -> f64 {
    let long = blank(track, 120.0, 1200);
    let mut gone = 0.0;
    for (speed, time) in speeds(&long, law).iter().zip(long.velocity.times()) {
        gone += 0.1 * speed;
        if gone > 850.0 {
            return *time;
        }
    }
    panic!("the mass stops after {gone} m");
}

/// A synthetic event: the motion under two patches or one, with errors.
fn model(case: Case) -> OnePatch {
    let mut rng = Seed::new(7000 + case.index).rng();
    let track = track(case, &mut rng);
    let law = truth(case, &mut rng);
    let count = 20 + 2 * case.index as usize;
    let event = blank(&track, duration(&track, &law), count);
    let mut error = 0.0;
    let phi = if case.correlated { 0.5 } else { 0.0 };
    let values = speeds(&event, &law)
        .into_iter()
        .map(|speed| {
            let normal: f64 = StandardNormal.sample(&mut rng);
            error = phi * error + 0.6 * normal;
            f64::max(speed + error, 0.0)
        })
        .collect();
    let series = event.velocity.with_values(values).unwrap();
    OnePatch { event: event.with_recording(series).unwrap(), kind: case }
}

#[test]
#[ignore = "explores"]
fn explore() {
    let only: Option<u64> =
        std::env::var("ONLY").ok().map(|s| s.parse().unwrap());
    let number = |name: &str, default: f64| {
        std::env::var(name).map_or(default, |s| s.parse().unwrap())
    };
    let smc = Smc {
        particles: number("N", 2000.0) as usize,
        moves: number("MOVES", 5.0),
        keep: number("KEEP", 0.6),
        ..Smc::default()
    };
    let is = ImportanceSampling::default();
    for case in cases() {
        if only.is_some_and(|o| o != case.index) {
            continue;
        }
        let model = model(case);
        let posterior = Posterior::new(&model).unwrap();
        let at = posterior.parameters().iter().position(|p| p.name == "begin");
        let show = |backend: &dyn Backend, seed| {
            let found =
                infer(backend, &posterior, Seed::new(seed), &Quiet).unwrap();
            let e = found.evidence.unwrap();
            let begins = found.draws.unwrap().pooled(at.unwrap());
            let n = begins.len() as f64;
            let early =
                begins.iter().filter(|b| **b < 380.0).count() as f64 / n;
            print!(
                " {:.2}±{:.2}/{early:.2}({:.1}s,{}k)",
                e.log,
                e.se,
                found.cost.seconds,
                found.cost.densities / 1000
            );
        };
        print!(
            "{:2} twin {} n {}:",
            case.index,
            case.twin,
            model.event.velocity.len()
        );
        for seed in 0..number("SEEDS", 3.0) as u64 {
            show(&smc, seed);
        }
        print!(" IS");
        for seed in 0..number("IS", 2.0) as u64 {
            show(&is, seed);
        }
        println!();
    }
}
