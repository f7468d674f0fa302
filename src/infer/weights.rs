//! Importance weights: their mean and its error, how many they are worth, how
//! heavy their tail is, and resampling by them.

use rand::RngExt;

use super::log_sum_exp;
use super::proposal::Particle;
use crate::draws::psis;
use crate::error::{Error, Result};
use crate::seed::{Rng, Seed};

/// A Pareto tail index above which the weights' mean cannot be trusted.
const POOR: f64 = 0.7;

/// About ln Z, from draws of a proposal.
pub(in crate::infer) fn log_mean_weight(particles: &[Particle]) -> f64 {
    let logs = particles.iter().map(Particle::log_weight);
    log_sum_exp(logs) - (particles.len() as f64).ln()
}

/// Weights that are cut at the square root of their number times the mean
/// (Ionides 2008), so that no single draw makes a component.
pub(in crate::infer) fn cut(found: &[Particle]) -> Vec<f64> {
    let most = 1.0 / (found.len() as f64).sqrt();
    let cut: Vec<f64> =
        normalised(found).iter().map(|w| w.min(most)).collect();
    let total: f64 = cut.iter().sum();
    cut.into_iter().map(|w| w / total).collect()
}

/// Their importance weights, adding up to 1.
pub(in crate::infer) fn normalised(particles: &[Particle]) -> Vec<f64> {
    let logs = particles.iter().map(Particle::log_weight);
    let total = log_sum_exp(logs.clone());
    logs.map(|l| (l - total).exp()).collect()
}

/// The effective share of particles, and the Pareto tail index of their
/// weights.
pub(in crate::infer) fn quality(found: &[Particle]) -> (f64, f64) {
    let logs: Vec<f64> = found.iter().map(Particle::log_weight).collect();
    let (_, tail) = psis(&logs);
    (effective(&logs, 1.0) / logs.len() as f64, tail)
}

/// What weighted particles say.
pub(crate) struct Sum {
    /// ln of the mean weight, and its standard error.
    pub(crate) log: f64,
    pub(crate) se: f64,
    /// The weights, adding up to 1, and how many even ones they are worth.
    weights: Vec<f64>,
    effective: f64,
    pub(crate) warnings: Vec<String>,
}

impl Sum {
    /// As many even draws as the weights are worth, and a hundred at least.
    pub(crate) fn chosen(&self, seed: Seed) -> Vec<usize> {
        let count = self.effective.max(100.0) as usize;
        systematic(&self.weights, count, &mut seed.rng())
    }
}

/// The evidence that weighted particles give.
pub(in crate::infer) fn summed(found: &[Particle]) -> Result<Sum> {
    let n = found.len() as f64;
    let logs: Vec<f64> = found.iter().map(Particle::log_weight).collect();
    let log = log_mean_weight(found);
    if !log.is_finite() {
        return Err(Error::inference(
            "no draw has a positive density: prior and recording contradict \
             each other",
        ));
    }
    let weights = normalised(found);
    let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
    let se = ((n / effective - 1.0) / (n - 1.0)).sqrt();
    let (_, k) = psis(&logs);
    let warnings = warn(k, effective, n);
    Ok(Sum { log, se, weights, effective, warnings })
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

/// The number of effective particles after a tempering step.
pub(in crate::infer) fn effective(logs: &[f64], step: f64) -> f64 {
    let once = log_sum_exp(logs.iter().map(|l| step * l));
    let twice = log_sum_exp(logs.iter().map(|l| 2.0 * step * l));
    (2.0 * once - twice).exp()
}

/// Systematic resampling: one uniform draw places an even comb on the
/// cumulated weights.
pub(crate) fn systematic(
    weights: &[f64],
    count: usize,
    rng: &mut Rng,
) -> Vec<usize> {
    let offset: f64 = rng.random();
    let total: f64 = weights.iter().sum();
    let mut chosen = Vec::with_capacity(count);
    let (mut i, mut cumulated) = (0, weights[0]);
    for k in 0..count {
        let tooth = (k as f64 + offset) / count as f64 * total;
        while cumulated < tooth && i + 1 < weights.len() {
            i += 1;
            cumulated += weights[i];
        }
        chosen.push(i);
    }
    chosen
}
