//! How far from the same work in plain C?
//!
//! Compiles the C programs in `../shared/yardstick`, where that folder is,
//! and measures both sides in turn, so that the ratios hold on a noisy
//! machine. Ratios are medians over pairs of runs.

#![allow(missing_docs, clippy::print_stdout)]

mod reference;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use couloir::infer::{Effort, MetropolisHastings, Proposal, Quiet, infer};
use couloir::model::{Model, Point, Posterior, Weights};
use couloir::physics::friction::Voellmy;
use couloir::physics::{State, sample};
use couloir::scalar::{Plain, Real};
use couloir::{Event, Seed};

fn main() {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/yardstick");
    let event = reference::event();
    let model = reference::M1::new(event.clone());
    if folder.is_dir() {
        against_c(&folder, &event, &model);
    } else {
        println!("no {}: the C side is left out", folder.display());
    }
    gradient_ratio(&model);
    threads_ratio(&model);
}

fn against_c(folder: &Path, event: &Event, model: &reference::M1) {
    let yard = compile(folder, "yard.c", "yard", &[]);
    let series = "closed form series, 1.4 m";
    let flows: Vec<(f64, f64)> = (0..5)
        .map(|_| (flow_seconds(event), c_flow_seconds(folder, &yard, series)))
        .collect();
    tell("one simulation, couloir over C closed form", &flows);
    let fast = compile(folder, "yard.c", "yard_fast", &["-ffast-math"]);
    let lanes = "closed form 8 lanes, 1.4 m";
    for (yard, how) in [(&yard, "C lanes"), (&fast, "C lanes, fast-math")] {
        let many: Vec<(f64, f64)> = (0..5)
            .map(|_| {
                (many_seconds(event), c_flow_seconds(folder, yard, lanes))
            })
            .collect();
        tell(&format!("one of many simulations over {how}"), &many);
    }
    let mh = compile(folder, "mh.c", "mh", &[]);
    chains_against_c(&|| c_chains_seconds(folder, &mh), model);
}

/// The steps alone, with what is said about their draws, and as the command
/// does them: that one tunes its steps first.
fn chains_against_c(in_c: &dyn Fn() -> f64, model: &reference::M1) {
    let steps = "4 x 50 000 Metropolis-Hastings steps, CPU";
    let runs: Vec<_> =
        (0..5).map(|_| (chains_seconds(model), in_c())).collect();
    let of = |part: usize| -> Vec<(f64, f64)> {
        runs.iter().map(|(ours, c)| (ours[part], *c)).collect()
    };
    tell(steps, &of(0));
    tell("the same with its summary", &of(1));
    let Some(program) = option_env!("CARGO_BIN_EXE_couloir") else { return };
    let whole: Vec<(f64, f64)> =
        (0..5).map(|_| (command_seconds(program), in_c())).collect();
    tell("`couloir calibrate`, with 4 x 5000 steps to tune", &whole);
}

/// CPU seconds of the command on one thread.
fn command_seconds(program: &str) -> f64 {
    let event = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/voellmy-21");
    let mut command = Command::new(program);
    command
        .args(["calibrate", event, "--backend", "mh", "--draws", "50000"])
        .arg("--quiet")
        .env("RAYON_NUM_THREADS", "1");
    let begun = Instant::now();
    assert!(!output(&mut command).is_empty(), "the command says nothing");
    begun.elapsed().as_secs_f64()
}

fn compile(
    folder: &Path,
    source: &str,
    name: &str,
    flags: &[&str],
) -> PathBuf {
    let program = std::env::temp_dir().join(format!("{name}_c"));
    let done = Command::new("cc")
        .args(["-O3", "-march=native", "-fno-math-errno"])
        .args(flags)
        .arg(folder.join(source))
        .arg("-o")
        .arg(&program)
        .arg("-lm")
        .output();
    assert!(done.is_ok_and(|out| out.status.success()), "cc {source}");
    program
}

fn output(command: &mut Command) -> String {
    let out = command.output().map(|out| out.stdout).unwrap_or_default();
    String::from_utf8_lossy(&out).into_owned()
}

/// The mean seconds of one simulation over parameters as the C side has them.
fn flow_seconds(event: &Event) -> f64 {
    let count = 40_000;
    let mut best = f64::INFINITY;
    for _ in 0..7 {
        let begun = Instant::now();
        let mut sum = 0.0;
        for i in 0..count {
            let share = (i % 512) as f64 / 512.0;
            let number = Real::<Plain>::new;
            let law = Voellmy {
                mu: number(0.2 + 0.25 * share),
                xi: number(250.0 + 1000.0 * share),
            };
            let times = event.velocity.times();
            let visit = |s: State<Plain>| sum += s.speed.value();
            let path = event.path();
            let release = event.release();
            let done = sample(&path, &law, release, times, true, visit);
            assert!(done.is_ok());
        }
        std::hint::black_box(sum);
        best = best.min(begun.elapsed().as_secs_f64() / f64::from(count));
    }
    best
}

/// The mean seconds of one simulation of 512, eight side by side.
fn many_seconds(event: &Event) -> f64 {
    let number = Real::<Plain>::new;
    let law = |i: u32| {
        let share = f64::from(i) / 512.0;
        let (mu, xi) = (0.2 + 0.25 * share, 250.0 + 1000.0 * share);
        Voellmy { mu: number(mu), xi: number(xi) }
    };
    let laws: Vec<_> = (0..512).map(law).collect();
    let times = event.velocity.times();
    let mut best = f64::INFINITY;
    for _ in 0..100 {
        let begun = Instant::now();
        let speeds = event.slide_many(&laws, times);
        assert!(speeds.iter().all(Result::is_ok));
        best = best.min(begun.elapsed().as_secs_f64() / 512.0);
    }
    best
}

/// The best time of the C program's line that is called `what`.
fn c_flow_seconds(folder: &Path, program: &Path, what: &str) -> f64 {
    let text = output(Command::new(program).current_dir(folder));
    let line = text.lines().find(|l| l.contains(what));
    let ns = line
        .and_then(|l| l.split("(min ").nth(1))
        .and_then(|rest| rest.split(')').next())
        .and_then(|n| n.parse::<f64>().ok());
    ns.unwrap_or(f64::NAN) * 1e-9
}

/// CPU seconds of four chains of 50 000 steps on one thread, without and with
/// their summary.
fn chains_seconds(model: &reference::M1) -> [f64; 2] {
    let effort = Effort::new().chains(4).draws(50_000).warmup(0);
    // As in the C program: a fixed proposal of the posterior's own shape.
    let sd = [0.0783, 132.3, 0.1865, 2.76];
    let covariance = nalgebra::DMatrix::from_fn(4, 4, |i, j| {
        let correlation: f64 = match (i.min(j), i.max(j)) {
            (0, 1) => 0.415,
            (1, 2) => 0.3,
            (a, b) if a == b => 1.0,
            _ => 0.0,
        };
        1.19_f64.powi(2) * correlation * sd[i] * sd[j]
    });
    let backend = MetropolisHastings {
        proposal: Proposal::Fixed(covariance),
        starts: vec![reference::MIDDLE.to_vec()],
        ..MetropolisHastings::random_walk(&effort)
    };
    on_threads(1, || run(&backend, model))
}

fn c_chains_seconds(folder: &Path, program: &Path) -> f64 {
    let scratch = std::env::temp_dir().join("couloir-yardstick");
    let _ = std::fs::create_dir_all(&scratch);
    for name in ["data.csv", "profile_1p4m.csv"] {
        let _ = std::fs::copy(folder.join(name), scratch.join(name));
    }
    let text = output(
        Command::new(program)
            .args(["profile_1p4m.csv", "1"])
            .current_dir(scratch),
    );
    let seconds = text.split_whitespace().next();
    seconds.and_then(|s| s.parse().ok()).unwrap_or(f64::NAN)
}

/// The seconds of the steps, and of all.
fn run(backend: &MetropolisHastings, model: &dyn Model) -> [f64; 2] {
    let begun = Instant::now();
    let found = Posterior::new(model)
        .and_then(|p| infer(backend, &p, Seed::new(1), &Quiet));
    let steps = found.expect("the model can be sampled").cost.seconds;
    [steps, begun.elapsed().as_secs_f64()]
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads can be started").install(work)
}

fn gradient_ratio(model: &reference::M1) {
    let model: &dyn Model = model;
    let z = Posterior::new(model)
        .and_then(|posterior| posterior.line(&reference::MIDDLE))
        .unwrap_or_default();
    let count = 20_000;
    let mut gradient = [0.0; 4];
    let pairs: Vec<(f64, f64)> = (0..15)
        .map(|_| {
            let begun = Instant::now();
            for _ in 0..count {
                let weights = Weights::LINE;
                let done = model.gradient(&z, weights, &mut gradient);
                std::hint::black_box(&done);
            }
            let with = begun.elapsed().as_secs_f64();
            let begun = Instant::now();
            for _ in 0..count {
                let done = model.evaluate(Point::Line(&z), None);
                std::hint::black_box(&done);
            }
            (with, begun.elapsed().as_secs_f64())
        })
        .collect();
    tell("one gradient over one log density", &pairs);
}

fn threads_ratio(model: &reference::M1) {
    let effort = Effort::new().chains(4).draws(50_000).warmup(1_000);
    let backend = MetropolisHastings::adaptive(&effort);
    let pairs: Vec<(f64, f64)> = (0..5)
        .map(|_| {
            let [_, one] = on_threads(1, || run(&backend, model));
            let [_, two] = on_threads(2, || run(&backend, model));
            (one, two)
        })
        .collect();
    tell("one thread over two, 4 chains", &pairs);
}

/// The median of the ratios, with the range.
fn tell(what: &str, pairs: &[(f64, f64)]) {
    let mut ratios: Vec<f64> = pairs.iter().map(|(a, b)| a / b).collect();
    ratios.sort_by(f64::total_cmp);
    println!(
        "{what}: {:.2} ({:.2} .. {:.2}); {:.3e} s over {:.3e} s",
        ratios[ratios.len() / 2],
        ratios[0],
        ratios[ratios.len() - 1],
        pairs[0].0,
        pairs[0].1,
    );
}
