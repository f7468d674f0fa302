//! Blocks put together by chance: laws, a noise, mechanisms and a track that
//! nobody chose for each other. What holds for every model holds for these.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::collections::BTreeMap;

use crate::terrain::any_track;
use couloir::mechanism::catalogue::catalogue;
use couloir::mechanism::{Extent, Mechanism};
use couloir::model::{Assembled, Density, Point, Posterior, Weights};
use couloir::observe::{Event, Series};
use couloir::physics::friction::{LAWS, LawSum};
use couloir::physics::{GRAVITY, State, Track};
use couloir::scalar::Plain;
use couloir::{Seed, noise};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::subsequence;
use proptest::test_runner::{
    Config, RngAlgorithm, TestError, TestRng, TestRunner,
};
use rand::RngExt;

const NOISES: [&str; 10] = [
    "iid",
    "student",
    "ar(1)",
    "ar(3)",
    "white",
    "ou + white",
    "matern32 + white",
    "ou + matern32 + white",
    "white + tails",
    "ou + white + tails + growth",
];

/// What only takes energy from a mass, where its amplitude is above 0.
const BRAKES: [&str; 4] =
    ["cohesion", "turbulent-drag", "viscous-drag", "entrainment"];

/// How often the recordings of the models have a value \[s\].
const STEP: f64 = 0.5;

/// A model's blocks, and the seed of its track and its values.
#[derive(Debug, Clone)]
struct Blocks {
    laws: Vec<usize>,
    noise: usize,
    /// Places in the list of mechanisms that apply.
    mechanisms: Vec<u32>,
    seed: u64,
}

fn blocks() -> impl Strategy<Value = Blocks> {
    let all: Vec<usize> = (0..LAWS.len()).collect();
    let laws = subsequence(all, 1..=4);
    let found = vec(any::<u32>(), 0..=2);
    (laws, 0..NOISES.len(), found, any::<u64>()).prop_map(
        |(laws, noise, mechanisms, seed)| Blocks {
            laws,
            noise,
            mechanisms,
            seed,
        },
    )
}

/// An event of chance: speeds that no law made.
fn event(seed: u64) -> Event {
    let mut rng = Seed::new(seed).rng();
    let track = any_track(&mut rng);
    // The track has room for what was recorded.
    let start = rng.random_range(0.5..40.0_f64).min(0.03 * track.length());
    let times: Vec<f64> = (1..=24).map(|i| STEP * f64::from(i)).collect();
    let speeds = times.iter().map(|t| start * (1.05 + (0.7 * t).sin()));
    let speeds = speeds.collect();
    Event::on(track)
        .release(0.0, start)
        .depth(rng.random_range(0.2..4.0))
        .velocity(Series::velocity(times, speeds).unwrap())
        .build()
        .unwrap()
}

/// Those of the mechanisms that a choice means, each once.
fn chosen(choice: &[u32], extent: &Extent) -> Vec<Box<dyn Mechanism>> {
    let mut found: Vec<Box<dyn Mechanism>> = Vec::new();
    for number in choice {
        let mut all = catalogue(extent, &[]);
        let one = all.swap_remove(*number as usize % all.len());
        if found.iter().all(|other| other.name() != one.name()) {
            found.push(one);
        }
    }
    found
}

fn model(of: &Blocks) -> Assembled {
    let event = event(of.seed);
    let law = LawSum::from_iter(of.laws.iter().map(|i| LAWS[*i]));
    let found = chosen(&of.mechanisms, &event.extent());
    let (noise, none) =
        (noise::parse(NOISES[of.noise]).unwrap(), BTreeMap::new());
    let model = Assembled::new(event, law, noise, &none).unwrap();
    model.with_mechanisms(found, &none).unwrap()
}

/// Whether the motion is by stages: a law of the speed with a change, or a
/// change that is one. Its error is of third order in the step.
fn is_by_stages(of: &Blocks) -> bool {
    let is_bent =
        |name: &str| ["velocity-weakening", "viscous-drag"].contains(&name);
    let by_law = of.laws.iter().any(|i| is_bent(LAWS[*i].name()));
    let labels = model(of).labels();
    !labels.is_empty() && (by_law || labels.iter().any(|l| is_bent(l)))
}

/// Checks so many models; the first that fails is told, made as simple as it
/// can be.
fn check(cases: u32, seed: u8, holds: impl Fn(&Blocks) -> Result<(), String>) {
    let config =
        Config { cases, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let found =
        runner.run(&blocks(), |of| holds(&of).map_err(TestCaseError::fail));
    if let Err(TestError::Fail(why, of)) = found {
        let law = LawSum::from_iter(of.laws.iter().map(|i| LAWS[*i]));
        let labels = model(&of).labels();
        panic!("{why}: {law}, {}, {labels:?}: {of:?}", NOISES[of.noise]);
    }
}

/// A draw from the priors: values as named, and their place on the line.
fn drawn(posterior: &Posterior, seed: u64) -> (Density, Vec<f64>, Vec<f64>) {
    let mut rng = Seed::new(seed).child(1).rng();
    let (density, found) = posterior.draw_prior(&mut rng).unwrap();
    (density, found.natural, found.line)
}

/// The motion over a minute, after the draw's parameters; nothing where the
/// law has none with them.
fn motion(of: &Blocks) -> Option<(Track, Vec<f64>, Vec<State<Plain>>)> {
    let model = model(of);
    let posterior = Posterior::new(&model).unwrap();
    let (_, values, _) = drawn(&posterior, of.seed);
    let times: Vec<f64> = (0..240).map(|i| 0.25 * f64::from(i)).collect();
    let track = model.event().track().clone();
    let states = model.motion(&values, &times).ok()?;
    Some((track, values, states))
}

#[test]
fn a_mass_never_goes_back_and_never_flies_off_the_numbers() {
    check(500, 1, |of| {
        let Some((_, values, states)) = motion(of) else { return Ok(()) };
        for pair in states.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let (u, v) = (a.speed.value(), b.speed.value());
            let way = b.distance.value() - a.distance.value();
            // Round-off, where a leg ends at rest.
            let is_fine = u > -1e-6
                && v > -1e-6
                && v.is_finite()
                && way >= -1e-9 * (1.0 + b.distance.value().abs());
            if !is_fine {
                return Err(format!("{values:?}: {u} {v} {way}"));
            }
        }
        Ok(())
    });
}

#[test]
fn a_mass_that_has_stopped_stays() {
    check(400, 2, |of| {
        let model = model(of);
        let posterior = Posterior::new(&model).unwrap();
        let (_, values, _) = drawn(&posterior, of.seed);
        let Ok(Some(rest)) = model.rest(&values) else { return Ok(()) };
        let end = rest.time.value();
        if !(0.0..1e4).contains(&end) {
            return Ok(());
        }
        let times: Vec<f64> =
            (1..=20).map(|i| end + 1e-6 + 0.5 * f64::from(i)).collect();
        let states = model.motion(&values, &times).map_err(|_| "rejected")?;
        let first = states[0].distance.value();
        let moves = |s: &State<Plain>| {
            s.speed.value() > 0.0 || s.distance.value() != first
        };
        match states.iter().any(moves) {
            true => Err(format!("{values:?} moves after {end} s")),
            false => Ok(()),
        }
    });
}

#[test]
fn nothing_that_brakes_gives_energy() {
    check(1500, 3, |of| {
        let event = event(of.seed);
        let found = chosen(&of.mechanisms, &event.extent());
        if !found.iter().all(|m| BRAKES.contains(&m.label().as_str())) {
            return Ok(());
        }
        let Some((track, values, states)) = motion(of) else { return Ok(()) };
        let energy = |s: &State<Plain>| {
            let u = s.speed.value();
            0.5 * u * u + GRAVITY * track.position(s.distance.value()).1
        };
        let mut scale = 1e3_f64;
        let slack = if is_by_stages(of) { 1e-6 } else { 1e-8 };
        for pair in states.windows(2) {
            let [before, after] = [energy(&pair[0]), energy(&pair[1])];
            scale = scale.max(before.abs()).max(after.abs());
            if after - before > slack * scale {
                let more = after - before;
                return Err(format!("{values:?}: {more:e} of {scale:e}"));
            }
        }
        Ok(())
    });
}

#[test]
fn a_density_is_a_number_or_rejected() {
    check(2000, 4, |of| {
        let model = model(of);
        let posterior = Posterior::new(&model).unwrap();
        let (density, values, line) = drawn(&posterior, of.seed);
        let all = [&density.log_prior, &density.log_likelihood];
        let is_known = density.rejected.is_some()
            || all.iter().all(|x| !x.is_nan() && **x < f64::INFINITY);
        if !is_known {
            return Err(format!("{values:?}: {density:?}"));
        }
        if density.rejected.is_some() || line.len() != values.len() {
            return Ok(());
        }
        // The same place named in the other way has the same density.
        let again = posterior.density(Point::Line(&line)).unwrap();
        let (a, b) = (density.log_likelihood, again.log_likelihood);
        match a == b || (a - b).abs() <= 1e-5 * a.abs().max(1.0) {
            true => Ok(()),
            false => Err(format!("{values:?}: {a} and {b}")),
        }
    });
}

/// The slope along a parameter by two differences, where these agree: across
/// a kink of the motion there is none.
fn slope(
    posterior: &Posterior,
    z: &[f64],
    along: usize,
) -> Option<(f64, f64)> {
    let at = |step: f64| {
        let mut z = z.to_vec();
        z[along] += step;
        let density = posterior.density(Point::Line(&z)).unwrap();
        Some(density.on_line()).filter(|x| x.is_finite())
    };
    let h = 1e-4;
    let wide = (at(2.0 * h)? - at(-2.0 * h)?) / (4.0 * h);
    let near = (at(h)? - at(-h)?) / (2.0 * h);
    let one_sided = (at(h)? - at(0.0)?) / h;
    let round_off = 1e-11 * at(0.0)?.abs() / h;
    let size = near.abs().max(1.0);
    let agree = (wide - near).abs() < 1e-5 * size + round_off
        && (one_sided - near).abs() < 1e-2 * size + round_off;
    agree.then_some((near, 1e-4 * size + 10.0 * round_off))
}

#[test]
fn gradients_are_differences() {
    let compared = std::cell::Cell::new((0, 0));
    check(400, 5, |of| {
        let model = model(of);
        let posterior = Posterior::new(&model).unwrap();
        let (density, _, z) = drawn(&posterior, of.seed);
        let is_usual = density.rejected.is_none()
            && density.log_likelihood.abs() < 1e6
            && z.len() == posterior.dimension();
        if !is_usual {
            return Ok(());
        }
        let mut gradient = vec![0.0; z.len()];
        posterior.gradient(&z, Weights::LINE, &mut gradient).unwrap();
        for (along, exact) in gradient.iter().enumerate() {
            let (all, some) = compared.get();
            compared.set((all + 1, some));
            let Some((near, error)) = slope(&posterior, &z, along) else {
                continue;
            };
            compared.set((all + 1, some + 1));
            if (exact - near).abs() > error {
                let name = &posterior.parameters()[along].name;
                return Err(format!("{name} at {z:?}: {exact}, {near}"));
            }
        }
        Ok(())
    });
    let (all, some) = compared.get();
    assert!(some > 1000 && 3 * some > 2 * all, "{some} of {all}");
}
