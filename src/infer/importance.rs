//! Importance sampling from a fitted mixture: evidence, and draws with it.
//!
//! Z = E_q[p/q] for any q that reaches wherever p does. q is a mixture of
//! Student-t distributions fitted to the draws of a short pilot run, refitted
//! twice, with a share of the prior. The weights say how good it is: their
//! spread gives the standard error, their Pareto tail whether to believe it
//! (Vehtari, Simpson, Gelman, Yao, Gabry 2024).

use rayon::prelude::*;

use super::mixture::Mixture;
use super::smc::{Base, Particle, Smc, population, systematic};
use super::{Backend, Effort, Evidence, Inference, Progress, draws_of};
use crate::draws::{Draws, psis};
use crate::error::Result;
use crate::model::Posterior;
use crate::seed::Seed;

/// Importance sampling by a Student-t mixture.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportanceSampling {
    /// How many draws the estimate is made of.
    pub draws: usize,
    /// The run that finds where the posterior lies.
    pub pilot: Smc,
}

impl Default for ImportanceSampling {
    fn default() -> Self {
        Self {
            draws: 20_000,
            pilot: Smc { particles: 1000, refine: false, ..Smc::default() },
        }
    }
}

impl ImportanceSampling {
    /// As many draws as fit an effort.
    pub fn of_effort(effort: &Effort) -> Self {
        let draws = (effort.chains * effort.draws / 2).max(1000);
        Self { draws, ..Self::default() }
    }
}

/// How often the mixture is refitted to weighted draws.
const REFITS: u64 = 2;

/// A Pareto tail index above which the weights' mean cannot be trusted.
const POOR: f64 = 0.7;

impl Backend for ImportanceSampling {
    fn name(&self) -> &'static str {
        "importance"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        posterior.require_proper("importance sampling")?;
        let pilot = self.pilot.explore(posterior, seed.child(0), progress)?;
        let draws = pilot.draws.unwrap_or(draws_of(posterior)?);
        self.from_draws(posterior, &draws, seed.child(1), progress)
    }
}

/// How many draws a mixture is fitted to at the most.
const FITTED: usize = 2000;

impl ImportanceSampling {
    /// The same without a pilot run, from posterior draws that there are.
    ///
    /// # Errors
    /// An improper prior, or a model that fails.
    pub fn from_draws(
        &self,
        posterior: &Posterior<'_>,
        draws: &Draws,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        posterior.require_proper("importance sampling")?;
        let rows: Vec<Vec<f64>> = draws
            .thinned(FITTED)
            .into_iter()
            .map(|row| posterior.line(row))
            .collect::<Result<_>>()?;
        let even = vec![1.0 / rows.len() as f64; rows.len()];
        let mut base = fit(&rows, &even, seed.child(1));
        progress.begin("importance sampling", None);
        for round in 0..REFITS {
            let count = (self.draws / 4).clamp(500, FITTED);
            let found =
                population(posterior, &base, count, seed.child(2 + round))?;
            let (rows, weights) = joined(&rows, found);
            base = fit(&rows, &weights, seed.child(10 + round));
            progress.advance(count as u64);
        }
        let found = population(posterior, &base, self.draws, seed.child(20))?;
        Self::conclude(posterior, &found, seed.child(21))
    }
}

fn fit(rows: &[Vec<f64>], weights: &[f64], seed: Seed) -> Base {
    match Mixture::fit(rows, weights, 6, &mut seed.rng()) {
        Some(mixture) => Base::Mixture(mixture),
        None => Base::Prior,
    }
}

/// What a mixture is refitted to: the given draws and the proposal's own, with
/// half of the weight each. The given draws keep every mode in.
fn joined(
    given: &[Vec<f64>],
    found: Vec<Particle>,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut weights = vec![0.5 / given.len() as f64; given.len()];
    weights.extend(cut(&found).iter().map(|w| 0.5 * w));
    let mut rows = given.to_vec();
    rows.extend(found.into_iter().map(|p| p.z));
    (rows, weights)
}

/// Weights that are cut at the square root of their number times the mean
/// (Ionides 2008), so that no single draw makes a component.
pub(super) fn cut(found: &[Particle]) -> Vec<f64> {
    let most = 1.0 / (found.len() as f64).sqrt();
    let cut: Vec<f64> =
        normalised(found).iter().map(|w| w.min(most)).collect();
    let total: f64 = cut.iter().sum();
    cut.into_iter().map(|w| w / total).collect()
}

fn normalised(particles: &[Particle]) -> Vec<f64> {
    let logs = particles.iter().map(Particle::log_weight);
    let total = super::log_sum_exp(logs.clone());
    logs.map(|l| (l - total).exp()).collect()
}

impl ImportanceSampling {
    /// Evidence and draws from weighted particles.
    pub(super) fn conclude(
        posterior: &Posterior<'_>,
        found: &[Particle],
        seed: Seed,
    ) -> Result<Inference> {
        let n = found.len() as f64;
        let logs: Vec<f64> = found.iter().map(Particle::log_weight).collect();
        let total = super::log_sum_exp(logs.iter().copied());
        let weights = normalised(found);
        let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let se = ((n / effective - 1.0) / (n - 1.0)).sqrt();
        let (_, k) = psis(&logs);
        let mut rng = seed.rng();
        let chosen =
            systematic(&weights, effective.max(100.0) as usize, &mut rng);
        let rows = chosen
            .par_iter()
            .map(|&i| posterior.natural(&found[i].z))
            .collect::<Result<Vec<_>>>()?
            .concat();
        let mut draws = draws_of(posterior)?;
        draws.push_chain(rows, None)?;
        Ok(Inference {
            draws: Some(draws),
            evidence: Some(Evidence {
                log: total - n.ln(),
                se,
                method: "importance sampling by a Student-t mixture".into(),
            }),
            warnings: warn(k, effective, n),
            ..Inference::default()
        })
    }
}

fn warn(k: f64, effective: f64, n: f64) -> Vec<String> {
    let mut warnings = Vec::new();
    if k > POOR {
        warnings.push(format!(
            "the importance weights have a heavy tail (Pareto k = {k:.2}, \
             above {POOR}): evidence and its error cannot be trusted; use smc"
        ));
    }
    if effective < 0.02 * n {
        warnings.push(format!(
            "only {effective:.0} of {n:.0} importance draws are effective: \
             the proposal fits the posterior poorly"
        ));
    }
    warnings
}
