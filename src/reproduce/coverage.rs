//! Table 5 and Figure 8: how often 90 % intervals hold the truth.

use serde::{Deserialize, Serialize};

use super::experiment::{Priors, TRUTH, Which, model, plan, series};
use crate::draws::{Draws, summarise};
use crate::error::{Error, Result};
use crate::infer::{
    Backend, Bridge, Effort, Inference, Map, Marginal, MetropolisHastings,
    Progress, Quadrature, Quiet, infer, part,
};
use crate::model::Posterior;
use crate::observe::{Event, Series};
use crate::parallel;
use crate::seed::Seed;

/// One model over all series.
#[derive(Debug, Clone)]
pub struct ModelStudy {
    /// Which.
    pub which: Which,
    /// The parameters' names.
    pub names: Vec<String>,
    /// How many of the samplers' 90 % intervals hold the truth, by parameter.
    pub covered: Vec<usize>,
    /// The same of the exact intervals.
    pub covered_exactly: Vec<usize>,
    /// The posterior mode of each series, by parameter.
    pub modes: Vec<Vec<f64>>,
    /// The lowest and the highest acceptance rate of any series' chain.
    pub acceptance: (f64, f64),
    /// ln evidence of each series by bridge sampling.
    pub log_evidence: Vec<f64>,
    /// The same by quadrature.
    pub log_evidence_exact: Vec<f64>,
}

/// Both models under one prior.
#[derive(Debug, Clone)]
pub struct PriorStudy {
    /// "wide" or "printed".
    pub name: &'static str,
    /// The priors.
    pub priors: Priors,
    /// M0 and M1.
    pub models: [ModelStudy; 2],
}

impl PriorStudy {
    /// log10 of the Bayes factor of M1 against M0, by series.
    pub fn log10_bf(&self) -> Vec<f64> {
        let [m0, m1] = &self.models;
        log10_ratio(&m1.log_evidence, &m0.log_evidence)
    }

    /// The same by quadrature.
    pub fn log10_bf_exact(&self) -> Vec<f64> {
        let [m0, m1] = &self.models;
        log10_ratio(&m1.log_evidence_exact, &m0.log_evidence_exact)
    }
}

fn log10_ratio(above: &[f64], below: &[f64]) -> Vec<f64> {
    let ratio = |(a, b): (&f64, &f64)| (a - b) / std::f64::consts::LN_10;
    above.iter().zip(below).map(ratio).collect()
}

/// What one series says under one model.
#[derive(Serialize, Deserialize)]
struct Fit {
    names: Vec<String>,
    intervals: Vec<(f64, f64)>,
    exact: Vec<Marginal>,
    mode: Vec<f64>,
    acceptance: f64,
    log_evidence: f64,
    log_evidence_exact: f64,
}

/// As in the paper: 20 000 steps of the random walk, the last 10 000 kept.
const PAPERS: Effort = Effort { chains: 1, draws: 10_000, warmup: 10_000 };

/// A short walk: enough to tell the quadrature where to look.
const SCOUTING: Effort = Effort { chains: 1, draws: 2000, warmup: 1500 };

/// The draws of a walk, and the posterior by quadrature where they lie.
fn explored(
    posterior: &Posterior<'_>,
    effort: &Effort,
    seed: Seed,
) -> Result<(Draws, Inference)> {
    let walk = MetropolisHastings::random_walk(effort);
    let found = walk.explore(posterior, seed, &Quiet)?;
    let draws = found
        .draws
        .ok_or_else(|| Error::inference("the walk left no draws"))?;
    let exact = quadrature().from_draws(posterior, &draws, &Quiet)?;
    Ok((draws, exact))
}

/// As many nodes as leave the evidence of these models right to 0.02.
fn quadrature() -> Quadrature {
    Quadrature { nodes: Some(20), ..Quadrature::default() }
}

fn evidence(found: &Inference) -> f64 {
    found.evidence.as_ref().map_or(f64::NAN, |e| e.log)
}

/// What is asked of the posterior of one of the study's models.
fn asked<T>(
    event: Event,
    which: Which,
    priors: &Priors,
    ask: impl FnOnce(&Posterior<'_>) -> Result<T>,
) -> Result<T> {
    let model = model(event, which, priors)?;
    ask(&Posterior::new(&model)?)
}

fn fit(posterior: &Posterior<'_>, seed: Seed) -> Result<Fit> {
    let (draws, exact) = explored(posterior, &PAPERS, seed.child(0))?;
    let summaries = summarise(&draws);
    let median = summaries.iter().map(|s| s.q50).collect();
    let search = Map { starts: 1, from: vec![median] };
    let mode = infer(&search, posterior, seed.child(1), &Quiet)?.mode;
    let bridge = Bridge { draws: 4000, ..Bridge::default() };
    let (sampled, _) = bridge.from_draws(posterior, &draws, seed.child(2))?;
    Ok(Fit {
        names: draws.names().to_vec(),
        intervals: summaries.iter().map(|s| (s.q05, s.q95)).collect(),
        mode: mode.map_or_else(Vec::new, |m| m.natural),
        acceptance: draws.acceptance().first().copied().unwrap_or(f64::NAN),
        log_evidence: sampled.log,
        log_evidence_exact: evidence(&exact),
        exact: exact.marginals,
    })
}

/// The study's synthetic series, the same under every prior; without those
/// whose errors carry them off the track.
pub(super) fn synthetic(samples: usize, seed: Seed) -> Result<Vec<Series>> {
    let plan = plan(1.0, 0.0)?;
    let made = parallel::try_map(0..samples as u64, |i| {
        let series = series(&plan, TRUTH, seed.child(i))?;
        Ok(recorded(&plan, &series)?.map(|_| series))
    })?;
    Ok(made.into_iter().flatten().collect())
}

/// The plan with a series recorded; `None` where the event refuses it, as it
/// does speeds that add up to more than the track. One series in a study is
/// then left out, and counted.
fn recorded(plan: &Event, series: &Series) -> Result<Option<Event>> {
    match plan.with_recording(series.clone()) {
        Ok(event) => Ok(Some(event)),
        Err(error) if error.is_input() => Ok(None),
        Err(error) => Err(error),
    }
}

/// Calibrates every series with both models.
pub(super) fn study(
    name: &'static str,
    priors: Priors,
    seen: &[Series],
    seed: Seed,
    progress: &dyn Progress,
) -> Result<PriorStudy> {
    let plan = plan(1.0, 0.0)?;
    let of = |which: Which| -> Result<ModelStudy> {
        let fits = parallel::try_map((0..).zip(seen), |(i, series)| {
            let seed = seed.child(which as u64).child(i);
            let fit = part(progress, &format!("fit of {seed:?}"), || {
                let event = plan.with_recording(series.clone())?;
                asked(event, which, &priors, |p| fit(p, seed))
            });
            progress.advance(1);
            fit
        })?;
        Ok(gathered(which, &fits))
    };
    let models = [of(Which::M0)?, of(Which::M1)?];
    Ok(PriorStudy { name, priors, models })
}

fn gathered(which: Which, fits: &[Fit]) -> ModelStudy {
    let truth = which.truth(TRUTH);
    let count = |holds: &dyn Fn(&Fit, usize, f64) -> bool| -> Vec<usize> {
        truth
            .iter()
            .enumerate()
            .map(|(i, truth)| {
                fits.iter().filter(|f| holds(f, i, *truth)).count()
            })
            .collect()
    };
    let rates = || fits.iter().map(|f| f.acceptance);
    ModelStudy {
        which,
        names: fits.first().map_or_else(Vec::new, |f| f.names.clone()),
        covered: count(&|fit, i, truth| {
            let (low, high) = fit.intervals[i];
            low <= truth && truth <= high
        }),
        covered_exactly: count(&|fit, i, truth| fit.exact[i].covers(truth)),
        modes: (0..truth.len())
            .map(|i| fits.iter().map(|f| f.mode[i]).collect())
            .collect(),
        acceptance: (
            rates().fold(f64::INFINITY, f64::min),
            rates().fold(f64::NEG_INFINITY, f64::max),
        ),
        log_evidence: fits.iter().map(|f| f.log_evidence).collect(),
        log_evidence_exact: fits
            .iter()
            .map(|f| f.log_evidence_exact)
            .collect(),
    }
}

/// Coverage by quadrature alone, where the series come about in another way
/// than they are calibrated.
#[derive(Debug, Clone)]
pub struct Reading {
    /// What is different.
    pub what: &'static str,
    /// How many series.
    pub samples: usize,
    /// How many more were left out, since their errors carry them off the
    /// track.
    pub left_out: usize,
    /// How many 90 % intervals hold the truth, by model and parameter.
    pub covered: [Vec<usize>; 2],
    /// The mean width of mu's 90 % interval, by model.
    pub width_mu: [f64; 2],
    /// log10 of the Bayes factor of M1 against M0, by series.
    pub log10_bf: Vec<f64>,
}

/// Exact intervals of series that `draw` makes, calibrated on `plan`.
pub(super) fn reading(
    what: &'static str,
    samples: usize,
    plan: &Event,
    priors: &Priors,
    seed: Seed,
    progress: &dyn Progress,
    draw: &(dyn Fn(Seed) -> Result<Series> + Sync),
) -> Result<Reading> {
    let found = parallel::try_map(0..samples as u64, |i| {
        let seed = seed.child(i);
        let both = part(progress, &format!("{what}, {seed:?}"), || {
            exact(plan, priors, seed, draw)
        });
        progress.advance(1);
        both
    })?;
    let found: Vec<_> = found.into_iter().flatten().collect();
    let log10_bf = found
        .iter()
        .map(|[m0, m1]| (m1.log_evidence - m0.log_evidence) / f64::ln(10.0))
        .collect();
    Ok(Reading {
        what,
        samples: found.len(),
        left_out: samples - found.len(),
        covered: Which::BOTH.map(|which| covered(which, &found)),
        width_mu: [0, 1].map(|m| width_mu(found.iter().map(|f| &f[m]))),
        log10_bf,
    })
}

/// What quadrature says of one series under one model.
#[derive(Serialize, Deserialize)]
struct Exact {
    marginals: Vec<Marginal>,
    log_evidence: f64,
}

/// The same of a series that `draw` makes, under both models; `None` where
/// its errors carry it off the track.
fn exact(
    plan: &Event,
    priors: &Priors,
    seed: Seed,
    draw: &(dyn Fn(Seed) -> Result<Series> + Sync),
) -> Result<Option<[Exact; 2]>> {
    let Some(event) = recorded(plan, &draw(seed.child(0))?)? else {
        return Ok(None);
    };
    let of = |which| {
        asked(event.clone(), which, priors, |posterior| {
            let (_, found) = explored(posterior, &SCOUTING, seed.child(1))?;
            let log_evidence = evidence(&found);
            Ok(Exact { marginals: found.marginals, log_evidence })
        })
    };
    Ok(Some([of(Which::M0)?, of(Which::M1)?]))
}

/// How many of the 90 % intervals under a model hold the truth, by parameter.
fn covered(which: Which, found: &[[Exact; 2]]) -> Vec<usize> {
    let truth = which.truth(TRUTH);
    let hits = |(i, truth): (usize, &f64)| {
        let marginals = found.iter().map(|f| &f[which as usize].marginals[i]);
        marginals.filter(|marginal| marginal.covers(*truth)).count()
    };
    truth.iter().enumerate().map(hits).collect()
}

/// The mean width of mu's 90 % interval.
fn width_mu<'f>(found: impl ExactSizeIterator<Item = &'f Exact>) -> f64 {
    let count = found.len().max(1) as f64;
    let quantiles = found.map(|f| &f.marginals[0].quantiles);
    quantiles.map(|q| q[5] - q[1]).sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_off_the_track_is_left_out() {
        let plan = plan(1.0, 0.0).unwrap();
        let values = |speed| vec![speed; plan.velocity.len()];
        let slow = plan.velocity.with_values(values(10.0)).unwrap();
        assert!(recorded(&plan, &slow).unwrap().is_some());
        let fast = plan.velocity.with_values(values(60.0)).unwrap();
        assert!(recorded(&plan, &fast).unwrap().is_none());
    }

    /// Noise alone had stopped one study in some dozens.
    #[test]
    fn no_seed_of_fifty_loses_a_series() {
        for seed in 1..=50 {
            let seen = synthetic(100, Seed::new(seed).child(0)).unwrap();
            assert_eq!(seen.len(), 100, "seed {seed}");
        }
    }
}
