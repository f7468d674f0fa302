//! The evidence of every candidate is the same whatever the seed, on events
//! that can be explained in several places.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::io::Cursor;
use std::path::{Path, PathBuf};

use couloir::Error;
use couloir::challenge::{Case, Errors, Mix, cases};
use couloir::diagnosis::{attribute, fit, locate};
use couloir::infer::{Backend, LaplaceMixture, Quiet, Smc};
use couloir::io::{load, parse_event};
use couloir::mechanism::catalogue::catalogue;
use couloir::model::{Assembled, Posterior, With};
use couloir::observe::Series;
use couloir::physics::forces::Axis;
use couloir::physics::friction::Laws;
use couloir::seed::Seed;

fn model_of(case: &Case) -> Assembled {
    let files = &case.recordings[0].files;
    let text = |name: &str| {
        let found = files.iter().find(|(file, _)| *file == name);
        found
            .map(|(_, text)| text.clone())
            .ok_or_else(|| Error::input(format!("{name} is missing")))
    };
    let open = |name: &str| {
        text(name).map(|text| (Cursor::new(text), PathBuf::from(name)))
    };
    let (path, laws) = (Path::new("event.toml"), Laws::default());
    let toml = text("event.toml").unwrap();
    let file = parse_event(&toml, path, open, &laws).unwrap();
    Assembled::new(file.event, file.friction, file.noise, &file.priors)
        .unwrap()
}

/// ln of the evidence of a free-form force over distance.
fn free_force(model: &Assembled, seed: Seed) -> f64 {
    let none = fit(model, &[], &LaplaceMixture::default(), seed).unwrap();
    let extent = model.event().extent();
    let force = locate(model, &extent, Axis::Place, &none, seed).unwrap();
    none.log_evidence + force.log_bayes_factor
}

/// How far below the best, in ln, a candidate is still estimated sharply: what
/// is further below has less than a ten-thousandth of the probability, and a
/// few hundred draws.
const FAR: f64 = 10.0;

/// The posterior of the patch in the first event has half of its mass in a
/// tail of strong patches, along which friction as good as vanishes.
#[test]
fn evidences_repeat_from_seed_to_seed() {
    for effect in ["friction-patch", "surge", "clock-offset"] {
        let all = cases(20, 8, Mix::One, Errors::Simple).unwrap();
        let case = all.iter().find(|c| c.truth.effect == effect).unwrap();
        let model = model_of(case);
        let extent = model.event().extent();
        let candidates = catalogue(&extent, &model.blocks());
        let fits = [1, 2].map(|seed| {
            let (extent, seed) = (Some(&extent), Seed::new(seed));
            let found = attribute(&model, extent, &candidates, seed, &Quiet);
            found.unwrap().candidates
        });
        let [a, b] = [1, 2].map(|seed| free_force(&model, Seed::new(seed)));
        assert!((a - b).abs() < 0.4, "{effect}: free-form force {a} {b}");
        let first = fits[0].iter().map(|fit| fit.log_evidence);
        let best = first.fold(f64::NEG_INFINITY, f64::max);
        for (i, mechanism) in candidates.iter().enumerate() {
            let [a, b] = [0, 1].map(|seed| fits[seed][i].log_evidence);
            let is_near = 0.5 * (a + b) > best - FAR;
            let label = mechanism.label();
            assert!(
                !is_near || (a - b).abs() < 0.3,
                "{effect}: {label} {a} {b}"
            );
        }
    }
}

/// Tempering from the prior needs a hundred times as many simulations, and no
/// start to climb from: what it says of the patch is what the peaks say.
#[test]
fn a_bent_tail_is_not_left_out() {
    let all = cases(20, 8, Mix::One, Errors::Simple).unwrap();
    let patched =
        all.iter().find(|c| c.truth.effect == "friction-patch").unwrap();
    let model = model_of(patched);
    let extent = model.event().extent();
    let mut candidates = catalogue(&extent, &model.blocks());
    candidates.retain(|mechanism| mechanism.name() == "friction-patch");
    let mechanisms = [candidates[0].as_ref()];
    let with = With::new(&model, &mechanisms);
    let posterior = Posterior::new(&with).unwrap();
    let smc = Smc { particles: 4000, ..Smc::default() };
    let known = smc.explore(&posterior, Seed::new(1), &Quiet).unwrap();
    let known = known.evidence.unwrap();
    for seed in 2..=3 {
        let found = attribute(
            &model,
            Some(&extent),
            &candidates,
            Seed::new(seed),
            &Quiet,
        );
        let fit = &found.unwrap().candidates[0];
        let off = fit.log_evidence - known.log;
        // Four standard errors of the difference.
        let se = fit.se.hypot(known.se);
        assert!(off.abs() < 4.0 * se, "seed {seed}: {off} +- {se}");
    }
}

/// A real recording, of every fifth value, where it is at hand: speeds that a
/// jolt leaves lower are peaks a second wide, which even starts missed with
/// some seeds, by up to 3.5 in ln.
#[test]
fn narrow_peaks_are_not_left_out() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/recordings/avanodes/230204-c07");
    if !folder.exists() {
        println!("no recording at {}: not run", folder.display());
        return;
    }
    let model = every_fifth(&folder);
    let extent = model.event().extent();
    let mut candidates = catalogue(&extent, &model.blocks());
    // Tempering from the prior with 16 000 particles says -48.26 (twice, each
    // +- 0.02) and -49.3 of the last two, and has no answer for the surge
    // (-50.4 and -49.4 with two seeds, the second +- 0.7): that is by 60 000
    // importance draws.
    let known = [
        ("surge", -50.33),
        ("entrainment", -48.26),
        ("friction-patch", -49.3),
    ];
    candidates.retain(|m| known.iter().any(|(name, _)| *name == m.name()));
    for seed in 1..=3 {
        let found = attribute(
            &model,
            Some(&extent),
            &candidates,
            Seed::new(seed),
            &Quiet,
        );
        for (fit, mechanism) in
            found.unwrap().candidates.iter().zip(&candidates)
        {
            let name = mechanism.name();
            let log = known.iter().find(|(n, _)| *n == name).unwrap().1;
            let off = fit.log_evidence - log;
            // Four standard errors, with 0.1 for what is known; a peak that
            // is missed costs 1 and more.
            let se = fit.se.hypot(0.1);
            let short = off.abs() < 4.0 * se && off.abs() < 0.8;
            assert!(short, "{name}, seed {seed}: {off} +- {}", fit.se);
        }
    }
}

fn every_fifth(folder: &Path) -> Assembled {
    let file = load(folder, &Laws::default()).unwrap();
    let series = file.event.recordings().next().unwrap();
    let fifth = |all: &[f64]| -> Vec<f64> {
        all.iter().skip(4).step_by(5).copied().collect()
    };
    let thin = Series::velocity(fifth(series.times()), fifth(series.values()));
    let event = file.event.with_recording(thin.unwrap()).unwrap();
    Assembled::new(event, file.friction, file.noise, &file.priors).unwrap()
}
