//! A whole calibration: inference, predictions, checks, as one report.

use crate::draws::{self, Draws, Summary, summarise};
use crate::error::{Error, Result, Stop};
use crate::infer::{
    Backend, ImportanceSampling, Inference, Map, Mode, Progress, Remembered,
    convergence, infer,
};
use crate::mechanism::Role;
use crate::model::{Assembled, Point, Posterior};
use crate::observe::Series;
use crate::parallel;
use crate::physics::State;
use crate::predict::{Bands, posterior_checked, prior_predictive};
use crate::prior::{AnyPrior, Distribution};
use crate::report::text::is_synthetic;
use crate::report::{
    CalibrationReport, Checks, EvidenceReport, ParameterReport, TrackReport,
};
use crate::scalar::{Plain, Real};
use crate::seed::Seed;

/// A calibration as it is told, with the draws behind it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Calibration {
    /// Everything that is told.
    pub report: CalibrationReport,
    /// The posterior draws.
    pub draws: Draws,
}

/// How many draws of the proposal the evidence is estimated from: its
/// standard error is then below 0.01 in ln for a posterior of a few peaks,
/// a hundredth of what a comparison of models asks for.
const EVIDENCE_DRAWS: usize = 6000;

/// How many posterior draws that proposal is fitted to. The fit has some
/// dozens of unknowns, and is refitted to draws of its own.
const FITTED: usize = 500;

/// Calibrates a model: runs the backend, finds the mode and the evidence,
/// predicts, and checks the fit.
///
/// # Errors
/// A backend without draws, or a model that fails.
pub fn calibrate(
    model: &Assembled,
    backend: &dyn Backend,
    seed: u64,
    progress: &dyn Progress,
) -> Result<Calibration> {
    calibrate_from(model, backend, Seed::new(seed), progress)
        .map(|found| found.with_seed(seed))
}

impl Calibration {
    /// The same of a run of that seed.
    pub(crate) fn with_seed(mut self, seed: u64) -> Self {
        self.report.seed = seed;
        self
    }
}

/// The same from a part of a run's seed, which is not told.
///
/// # Errors
/// As [`calibrate`].
pub(crate) fn calibrate_from(
    model: &Assembled,
    backend: &dyn Backend,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Calibration> {
    let kept = progress.checkpoint();
    let kept = kept.map(|kept| Remembered::new(model, kept, &named(model)));
    let posterior = match &kept {
        Some(remembered) => Posterior::new(remembered)?,
        None => Posterior::new(model)?,
    };
    calibrated(model, &posterior, backend, seed, progress)
}

/// The same of a posterior, whether what it costs is remembered or not.
fn calibrated(
    model: &Assembled,
    posterior: &Posterior<'_>,
    backend: &dyn Backend,
    root: Seed,
    progress: &dyn Progress,
) -> Result<Calibration> {
    let mut found = infer(backend, posterior, root.child(0), progress)?;
    let draws = draws_of(&found, backend)?;
    let summaries = summaries(&mut found, &draws);
    let median: Vec<f64> = summaries.iter().map(|s| s.q50).collect();
    let search = Map { starts: 4, from: vec![median.clone()] };
    let mode = infer(&search, posterior, root.child(1), progress)?.mode;
    if found.evidence.is_none() && posterior.is_proper() {
        let seed = root.child(2);
        add_evidence(&mut found, posterior, &draws, seed, progress)?;
    }
    let simulations = posterior.cost().simulations;
    progress.begin("predicting", None);
    let series = recording(model)?;
    let (bands, statistics) =
        posterior_checked(posterior, &draws, series, root.child(3))?;
    let times = series.times();
    let prior = prior_predictive(posterior, 1000, times, root.child(4)).ok();
    let mut report = CalibrationReport {
        backend: backend.name().to_owned(),
        parameters: parameters(model, &draws, &summaries, mode.as_ref()),
        simulations,
        prior_bands: prior,
        statistics,
        ..of_model(model)
    };
    tell_run(&mut report, found, &draws);
    tell_recording(&mut report, series, bands);
    check_fit(&mut report, posterior, series, &median)?;
    report.checks.kolmogorov_smirnov_p = chains_alike(&draws);
    report.track = track(model, &median)?;
    Ok(Calibration { report, draws })
}

/// What tells a model from others of the same run, of the same event.
fn named(model: &Assembled) -> String {
    let (friction, noise) = (model.friction(), model.noise());
    format!("{friction}, {noise}, {}", model.labels().join(", "))
}

/// The summaries of the draws, with a warning where they are poor; those of
/// chains have been told already.
fn summaries(found: &mut Inference, draws: &Draws) -> Vec<Summary> {
    if !found.summaries.is_empty() {
        return std::mem::take(&mut found.summaries);
    }
    let summaries = summarise(draws);
    found.warnings.extend(convergence(&summaries, draws.chains()));
    summaries
}

/// Finds the evidence by importance sampling about the draws.
fn add_evidence(
    found: &mut Inference,
    posterior: &Posterior<'_>,
    draws: &Draws,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<()> {
    progress.begin("evidence", None);
    let sampler = ImportanceSampling {
        draws: EVIDENCE_DRAWS,
        ..ImportanceSampling::default()
    };
    let few = draws.few(FITTED)?;
    let estimate = sampler.from_draws(posterior, &few, seed, progress)?;
    found.evidence = estimate.evidence;
    found.warnings.extend(estimate.warnings);
    Ok(())
}

fn draws_of(found: &Inference, backend: &dyn Backend) -> Result<Draws> {
    found.draws.clone().ok_or_else(|| {
        Error::input(format!(
            "backend {} yields no draws, which a calibration is made of; use \
             mh, smc or another, or `bench` to see the mode",
            backend.name()
        ))
    })
}

fn recording(model: &Assembled) -> Result<&Series> {
    model
        .event()
        .recordings()
        .next()
        .ok_or_else(|| Error::input("the event has no recording"))
}

fn of_model(model: &Assembled) -> CalibrationReport {
    let event = model.event().name();
    CalibrationReport {
        event: event.to_owned(),
        friction: model.friction(),
        noise: model.noise(),
        mechanisms: model.labels(),
        synthetic: is_synthetic(event),
        ..CalibrationReport::default()
    }
}

fn tell_run(report: &mut CalibrationReport, found: Inference, draws: &Draws) {
    let acceptance = draws.acceptance().iter().copied();
    report.acceptance = acceptance.filter(|a| a.is_finite()).collect();
    report.seconds = found.cost.seconds;
    report.evidence = found.evidence.map(|e| EvidenceReport {
        value: e.log,
        se: e.se,
        method: e.method,
    });
    report.doubts = found.warnings.clone();
    report.warnings = [found.warnings, found.hints].concat();
}

fn tell_recording(
    report: &mut CalibrationReport,
    series: &Series,
    bands: Bands,
) {
    report.quantity = series.quantity().name().to_owned();
    report.unit = series.quantity().unit().to_owned();
    report.window = series.window();
    report.times = series.times().to_vec();
    report.values = series.values().to_vec();
    report.standard_errors =
        series.grid().standard_errors().map(<[f64]>::to_vec);
    report.checks.coverage90 = bands.coverage(series.values());
    report.checks.rmse = bands.rmse(series.values());
    report.bands = bands;
}

/// Innovations at the posterior median, and what the tests say of them.
fn check_fit(
    report: &mut CalibrationReport,
    posterior: &Posterior<'_>,
    series: &Series,
    median: &[f64],
) -> Result<()> {
    let (_, found) = posterior.collect(Point::Natural(median))?;
    let innovations = found.innovations.into_iter().next().unwrap_or_default();
    let n = innovations.len();
    report.autocorrelation =
        draws::autocorrelation(&innovations, (n / 3).min(20))
            .into_iter()
            .skip(1)
            .collect();
    report.checks = Checks {
        ljung_box_p: draws::uncorrelated_p(&innovations),
        shapiro_wilk_p: draws::normal_p(&innovations),
        ..report.checks.clone()
    };
    report.innovation_times = series.times()[..n].to_vec();
    report.innovations = innovations;
    Ok(())
}

/// The smallest p-value of the tests between chains, for the number of pairs
/// and parameters (Bonferroni); NaN for one chain.
fn chains_alike(draws: &Draws) -> f64 {
    let parameters = draws.dimension();
    (0..parameters)
        .filter_map(|i| draws::between_chains(draws, i))
        .map(|found| (found.p_adjusted() * parameters as f64).min(1.0))
        .fold(f64::NAN, f64::min)
}

/// How many draws of each chain a trace shows.
const TRACE: usize = 500;

/// How many draws a scatter shows.
const SCATTER: usize = 1500;

fn parameters(
    model: &Assembled,
    draws: &Draws,
    summaries: &[Summary],
    mode: Option<&Mode>,
) -> Vec<ParameterReport> {
    let rows = draws.thinned(SCATTER);
    let priors: Vec<_> = model.priors().collect();
    parallel::map(summaries.iter().enumerate(), |(i, summary)| {
        let (_, prior) = priors[i];
        let curve = curve(prior, draws, i);
        // A length's prior is another wherever the stretch begins.
        let (also, alone) = match model.role(i) {
            Role::Length { until } => {
                (format!(", ending by {until:.4}"), Vec::new())
            }
            _ => (String::new(), prior_curve(prior, &curve)),
        };
        ParameterReport {
            of_errors: !model.is_of_motion(i),
            map: mode.map(|m| m.natural[i]),
            prior_text: format!("{prior}{also}"),
            prior_density: alone,
            posterior_density: curve,
            chains: draws.column(i).iter().map(|c| thin(c)).collect(),
            pooled: rows.iter().map(|row| row[i]).collect(),
            ..of_summary(summary)
        }
    })
}

/// A parameter's figures, from a summary of its draws.
pub(crate) fn of_summary(s: &Summary) -> ParameterReport {
    ParameterReport {
        name: s.name.clone(),
        unit: s.unit.clone(),
        mean: s.mean,
        sd: s.sd,
        q025: s.q025,
        q05: s.q05,
        q50: s.q50,
        q95: s.q95,
        q975: s.q975,
        rhat: s.rhat,
        ess_bulk: s.ess_bulk,
        ess_tail: s.ess_tail,
        mcse_mean: s.mcse_mean,
        ..ParameterReport::default()
    }
}

fn thin(chain: &[f64]) -> Vec<f64> {
    let step = chain.len().div_ceil(TRACE).max(1);
    chain.iter().copied().step_by(step).collect()
}

/// The posterior density of a parameter, as a curve.
pub(crate) fn curve(
    prior: &AnyPrior,
    draws: &Draws,
    parameter: usize,
) -> Vec<(f64, f64)> {
    let ends = |p: f64| prior.quantile(p).filter(|x| x.is_finite());
    let support = draws::Support { lower: ends(0.0), upper: ends(1.0) };
    let pooled = draws.pooled(parameter);
    draws::density(&pooled, support, 200)
        .map_or_else(Vec::new, |d| d.grid.into_iter().zip(d.density).collect())
}

/// The prior's density over the posterior's range and as far again.
fn prior_curve(prior: &AnyPrior, curve: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let (Some((low, _)), Some((high, _))) = (curve.first(), curve.last())
    else {
        return Vec::new();
    };
    if !prior.is_proper() {
        return Vec::new();
    }
    let low = prior.quantile(0.005).map_or(*low, |q| q.min(*low));
    let high = prior.quantile(0.995).map_or(*high, |q| q.max(*high));
    // Heavy tails would leave nothing of the posterior to see.
    let span = curve[curve.len() - 1].0 - curve[0].0;
    let low = low.max(curve[0].0 - 3.0 * span);
    let high = high.min(curve[curve.len() - 1].0 + 3.0 * span);
    (0..=300)
        .map(|i| low + (high - low) * f64::from(i) / 300.0)
        .map(|x| {
            let log: Real<Plain> = prior.log_density(Real::new(x));
            (x, log.value().exp())
        })
        .filter(|(_, d)| d.is_finite())
        .collect()
}

/// The terrain, with the mass of the median flow on it.
fn track(model: &Assembled, median: &[f64]) -> Result<TrackReport> {
    let event = model.event();
    let (x, z) = event.track().points();
    let last = event
        .recordings()
        .flat_map(|s| s.times().last().copied())
        .fold(0.0, f64::max);
    let times: Vec<f64> =
        (0..=12).map(|i| last * f64::from(i) / 12.0).collect();
    let mut report =
        TrackReport { x: x.to_vec(), z: z.to_vec(), ..TrackReport::default() };
    let states = match model.motion(median, &times) {
        Ok(states) => states,
        Err(Stop::Reject(_)) => return Ok(report),
        Err(Stop::Fail(error)) => return Err(error),
    };
    let place = |t: f64, s: f64| {
        let (x, z) = event.track().position(s);
        (t, x, z)
    };
    report.positions = times
        .iter()
        .zip(&states)
        .map(|(t, state): (&f64, &State<Plain>)| {
            place(*t, state.distance.value())
        })
        .collect();
    report.rest = model.rest(median).ok().flatten().and_then(|rest| {
        let s = rest.distance.value();
        let shown = s <= event.track().length();
        shown.then(|| place(rest.time.value(), s))
    });
    Ok(report)
}
