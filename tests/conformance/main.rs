//! Every backend on every target.
//!
//! The backends are those of `BACKENDS`, so that a new one comes here unasked.
//! What a target knows of its posterior is compared within four Monte Carlo
//! standard errors, estimated from the draws themselves: a sound backend
//! fails one comparison in 16 000. The seeds are fixed, so that it is not
//! another one each time. Where a backend cannot do a target, `CANNOT` says
//! why, and the test asserts that it refused, or that its own diagnostics
//! warned.

mod posteriordb;
mod report;
mod targets;

use couloir::Seed;
use couloir::draws::{Draws, ess_mean, summarise};
use couloir::infer::{BACKENDS, Effort, Entry, Inference, Quiet, infer};
use couloir::model::Posterior;

use targets::{Spread, Target};

/// What becomes of a backend on a target that it cannot do.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Instead {
    /// It runs, and its diagnostics object.
    Warns,
    /// It says that it cannot.
    Refuses,
}
use Instead::{Refuses, Warns};

/// Backend, target, what it does instead, and why.
const CANNOT: &[(&str, &str, Instead, &str)] = &[
    ("mh", "two modes", Warns, "a walk does not cross twelve widths"),
    ("random-walk", "two modes", Warns, "a walk does not cross twelve widths"),
    ("nuts", "two modes", Warns, "a path does not climb out of its mode"),
    ("reciprocal", "two modes", Warns, "it stands on the random walk"),
    ("mh", "funnel", Warns, "one step length for mouth and neck"),
    ("random-walk", "funnel", Warns, "one step length for mouth and neck"),
    ("reciprocal", "funnel", Warns, "it stands on the random walk"),
    ("smc", "funnel", Warns, "one scale of moves for mouth and neck"),
    ("bridge", "funnel", Warns, "it stands on the particles of smc"),
    ("laplace-mixture", "kidscore_momiq", Refuses, "its priors are improper"),
    ("quadrature", "arK", Refuses, "it has more than four parameters"),
    ("quadrature", "eight_schools", Refuses, "more than four parameters"),
    ("quadrature", "kidscore_momiq", Refuses, "its priors are improper"),
    ("bridge", "kidscore_momiq", Refuses, "its priors are improper"),
    ("smc", "kidscore_momiq", Refuses, "its priors are improper"),
    ("importance", "kidscore_momiq", Refuses, "its priors are improper"),
    ("reciprocal", "kidscore_momiq", Refuses, "its priors are improper"),
];

fn instead(backend: &str, target: &str) -> Option<Instead> {
    let row = CANNOT.iter().find(|row| (row.0, row.1) == (backend, target));
    row.map(|row| row.2)
}

/// Enough for some thousand effective draws: a draw along the slope is worth
/// many of a walk's.
fn effort(backend: &str) -> Effort {
    match backend {
        "nuts" => Effort::new().chains(4).draws(2000).warmup(1000),
        _ => Effort::new().chains(4).draws(20_000).warmup(10_000),
    }
}

/// Beyond how many standard errors a difference is one.
const ERRORS: f64 = 4.0;

/// How far a standard deviation may be from that of reference draws.
const SD_TOLERANCE: f64 = 0.1;

fn run(entry: &Entry, target: &Target) -> couloir::Result<Inference> {
    seeded(entry, target, 2)
}

fn seeded(
    entry: &Entry,
    target: &Target,
    seed: u64,
) -> couloir::Result<Inference> {
    let backend = (entry.make)(&effort(entry.name));
    let posterior = Posterior::new(target.model.as_ref())?;
    infer(backend.as_ref(), &posterior, Seed::new(seed), &Quiet)
}

/// Whether an error is within a tolerance; a NaN is not.
fn near(error: f64, tolerance: f64) -> bool {
    error.abs() < tolerance
}

/// What is wrong with what was found; empty for a sound backend.
fn complaints(found: &Inference, target: &Target) -> Vec<String> {
    let mut wrong = Vec::new();
    if let Some(draws) = &found.draws {
        wrong.extend(of_draws(draws, target));
    }
    if let (Some(e), Some(known)) = (&found.evidence, target.log_evidence) {
        // A backend may say that its error is not to be believed.
        let error = (e.log - known).abs();
        if found.warnings.is_empty() && !near(error, ERRORS * e.se) {
            let (log, se) = (e.log, e.se);
            wrong.push(format!("evidence {log} +- {se}, expected {known}"));
        }
    }
    if let (Some(mode), Some(top)) = (&found.mode, target.top) {
        let short = top - mode.log_density;
        if !near(short, 1e-3) {
            wrong.push(format!("a mode {short} below the top {top}"));
        }
    }
    wrong
}

/// The means and spreads that are not what they should be.
fn of_draws(draws: &Draws, target: &Target) -> Vec<String> {
    let mut wrong = Vec::new();
    for check in &target.checks {
        let (mean, se) = mean_of(draws, |row| (check.of)(row));
        let error = mean - check.mean;
        let tolerance = ERRORS * se.hypot(check.se);
        if !near(error, tolerance) {
            wrong.push(format!(
                "{}: mean {mean}, expected {} +- {tolerance}",
                check.what, check.mean
            ));
        }
        let centre = check.mean;
        let squared = |row: &[f64]| ((check.of)(row) - centre).powi(2);
        let (variance, se) = mean_of(draws, squared);
        let far = match check.spread {
            Spread::Any => false,
            Spread::Sd(sd) => !near(variance - sd * sd, ERRORS * se),
            Spread::About(sd) => {
                !near(variance.sqrt() / sd - 1.0, SD_TOLERANCE)
            }
        };
        if far {
            let spread = &check.spread;
            let sd = variance.sqrt();
            wrong.push(format!("{}: {sd}, expected {spread:?}", check.what));
        }
    }
    wrong
}

/// The mean of a function of a draw, with its Monte Carlo standard error.
fn mean_of(draws: &Draws, of: impl Fn(&[f64]) -> f64) -> (f64, f64) {
    let chains: Vec<Vec<f64>> = (0..draws.chains())
        .map(|c| {
            let rows = (0..draws.iterations()).map(|i| draws.row(c, i));
            rows.map(&of).collect()
        })
        .collect();
    let n = draws.total() as f64;
    let mean = chains.iter().flatten().sum::<f64>() / n;
    let square: f64 =
        chains.iter().flatten().map(|x| (x - mean).powi(2)).sum();
    (mean, (square / n / ess_mean(&chains)).sqrt())
}

/// What the diagnostics object to: R-hat and effective sizes by the limits of
/// Vehtari, Gelman, Simpson, Carpenter, Bürkner (2021), and the backend's own
/// warnings.
fn alarm(found: &Inference) -> Option<String> {
    let warning = found.warnings.first().cloned();
    let draws = found.draws.as_ref();
    let summaries = draws.map(summarise).unwrap_or_default();
    warning.or_else(|| {
        summaries.iter().find_map(|s| {
            let ess = s.ess_bulk.min(s.ess_tail);
            let healthy = s.rhat <= 1.01 && ess >= 400.0;
            let said = || format!("{}: R-hat {}, ESS {ess}", s.name, s.rhat);
            (!healthy).then(said)
        })
    })
}

/// Every backend on one target.
fn conforms(target: &Target) {
    let mut wrong = Vec::new();
    for entry in BACKENDS {
        let found = run(entry, target);
        match (found, instead(entry.name, target.name)) {
            (Err(error), Some(Refuses)) if error.is_input() => {}
            (Ok(found), Some(Warns)) => {
                if alarm(&found).is_none() {
                    let complaints = complaints(&found, target);
                    wrong.push(format!(
                        "{}: nothing warned, though {complaints:?}",
                        entry.name
                    ));
                }
            }
            (Ok(found), None) => {
                let complaints = complaints(&found, target);
                if !complaints.is_empty() {
                    let alarm = alarm(&found);
                    wrong.push(format!(
                        "{}: {complaints:#?}, alarm {alarm:?}",
                        entry.name
                    ));
                }
            }
            (found, _) => wrong.push(format!("{}: {found:?}", entry.name)),
        }
    }
    assert!(wrong.is_empty(), "{}:\n{}", target.name, wrong.join("\n"));
}

#[test]
fn a_correlated_normal() {
    conforms(&targets::correlated());
}

#[test]
fn a_banana() {
    conforms(&targets::banana());
}

#[test]
fn two_far_modes() {
    conforms(&targets::two_modes());
}

#[test]
fn a_funnel() {
    conforms(&targets::funnel());
}

#[test]
fn bounds_that_cut_the_mode() {
    conforms(&targets::bounds());
}

#[test]
fn a_linear_calibration() {
    conforms(&targets::linear());
}

#[test]
fn an_event_known_by_quadrature() {
    conforms(&targets::voellmy());
}

#[test]
fn an_autoregression() {
    conforms(&posteriordb::ark());
}

#[test]
fn eight_schools() {
    conforms(&posteriordb::eight_schools());
}

#[test]
fn childrens_scores() {
    conforms(&posteriordb::kidscore());
}

/// The rows of `CANNOT` name what there is.
#[test]
fn the_table_of_exceptions_is_not_stale() {
    let targets = targets::all();
    for (backend, target, ..) in CANNOT {
        assert!(targets.iter().any(|t| t.name == *target), "{target}");
        let known = BACKENDS.iter().any(|entry| entry.name == *backend);
        assert!(known || cfg!(not(feature = "nuts")), "{backend}");
    }
}
