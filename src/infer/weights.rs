//! Importance weights: their mean and its error, how many they are worth, how
//! heavy their tail is, and resampling by them.

use rand::RngExt;

use super::log_sum_exp;
use super::proposal::Particle;
use crate::draws::{psis, shares};
use crate::error::{Error, Result};
use crate::seed::{Rng, Seed};

/// A Pareto tail index above which the weights' mean cannot be trusted.
const POOR: f64 = 0.7;

/// About ln Z, from draws of a proposal.
pub(in crate::infer) fn log_mean_weight(particles: &[Particle]) -> f64 {
    let logs = particles.iter().map(Particle::log_weight);
    log_sum_exp(logs) - (particles.len() as f64).ln()
}

/// Shares in the weights, those above the square root of their number times the
/// mean cut there (Ionides 2008): what is left adds up to less than 1.
fn below_root(found: &[Particle]) -> impl Iterator<Item = f64> + use<> {
    let most = 1.0 / (found.len() as f64).sqrt();
    normalised(found).into_iter().map(move |w| w.min(most))
}

/// Weights that are cut there, adding up to 1, so that no single draw makes a
/// component.
pub(in crate::infer) fn cut(found: &[Particle]) -> Vec<f64> {
    let cut: Vec<f64> = below_root(found).collect();
    let total: f64 = cut.iter().sum();
    cut.into_iter().map(|w| w / total).collect()
}

/// Their importance weights, adding up to 1.
pub(in crate::infer) fn normalised(particles: &[Particle]) -> Vec<f64> {
    shares(particles.iter().map(Particle::log_weight))
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
        self.even(self.effective.max(100.0) as usize, seed)
    }

    /// So many even draws.
    pub(crate) fn even(&self, count: usize, seed: Seed) -> Vec<usize> {
        systematic(&self.weights, count, &mut seed.rng())
    }
}

/// The evidence that weighted particles give.
pub(in crate::infer) fn summed(found: &[Particle]) -> Result<Sum> {
    sum(&found.iter().map(Particle::log_weight).collect::<Vec<_>>())
}

/// The same with weights that are cut: of few draws one that weighs more than
/// all others would be the sum, which scatters less so.
pub(in crate::infer) fn summed_cut(found: &[Particle]) -> Result<Sum> {
    let total = log_mean_weight(found) + (found.len() as f64).ln();
    sum(&below_root(found).map(|w| w.ln() + total).collect::<Vec<_>>())
}

/// What logarithms of weights say.
fn sum(logs: &[f64]) -> Result<Sum> {
    let n = logs.len() as f64;
    let log = log_sum_exp(logs.iter().copied()) - n.ln();
    if !log.is_finite() {
        return Err(Error::inference(
            "no draw has a positive density: prior and recording contradict \
             each other",
        ));
    }
    let weights = shares(logs.iter().copied());
    let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
    let se = ((n / effective - 1.0) / (n - 1.0)).sqrt();
    let (_, k) = psis(logs);
    let warnings = warn(k, effective, n);
    Ok(Sum { log, se, weights, effective, warnings })
}

fn warn(k: f64, effective: f64, n: f64) -> Vec<String> {
    let mut warnings = Vec::new();
    if k > POOR {
        warnings.push(format!(
            "the importance weights have a heavy tail (Pareto k = {k:.3}, \
             above {POOR}): evidence and its error cannot be trusted; \
             `couloir compare` has the backend smc, which tempers"
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws with given importance weights, times e^`shift`.
    fn draws(weights: &[f64], shift: f64) -> Vec<Particle> {
        let draw = |(i, w): (usize, &f64)| {
            // ln p - ln q is the weight, whatever ln q is.
            let base = 0.3 * i as f64 - 1.0;
            Particle::new(vec![0.0], base, w.ln() + base + shift)
        };
        weights.iter().enumerate().map(draw).collect()
    }

    fn close(found: f64, expected: f64) {
        let limit = 1e-12 * expected.abs().max(1.0);
        assert!((found - expected).abs() < limit, "{found} for {expected}");
    }

    fn all_close(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        found.iter().zip(expected).for_each(|(f, e)| close(*f, *e));
    }

    #[test]
    fn weights_of_one_to_four_by_hand() {
        // Beyond what a number could hold that is not a logarithm.
        for shift in [0.0, -2000.0, 2000.0] {
            let found = draws(&[1.0, 2.0, 3.0, 4.0], shift);
            close(log_mean_weight(&found), 2.5_f64.ln() + shift);
            all_close(&normalised(&found), &[0.1, 0.2, 0.3, 0.4]);
            // (1 + 2 + 3 + 4)^2 / (1 + 4 + 9 + 16) of 4.
            close(quality(&found).0, 100.0 / 30.0 / 4.0);
            let sum = summed(&found).unwrap();
            close(sum.log, 2.5_f64.ln() + shift);
            // The standard deviation of the weights is sqrt(5/3).
            close(sum.se, (5.0_f64 / 3.0 / 4.0).sqrt() / 2.5);
            all_close(&sum.weights, &[0.1, 0.2, 0.3, 0.4]);
            close(sum.effective, 100.0 / 30.0);
        }
    }

    #[test]
    fn a_draw_without_density_counts_with_weight_zero() {
        let mut found = draws(&[1.0, 1.0], 0.0);
        found.push(Particle::without_density(1));
        found.push(Particle::without_density(1));
        close(log_mean_weight(&found), 0.5_f64.ln());
        all_close(&normalised(&found), &[0.5, 0.5, 0.0, 0.0]);
        // Weights 1, 1, 0, 0 have the variance 1/3.
        let sum = summed(&found).unwrap();
        close(sum.se, (1.0_f64 / 3.0 / 4.0).sqrt() / 0.5);
        let Err(error) = summed(&found[2..]) else {
            panic!("an evidence of draws without density");
        };
        assert!(error.to_string().contains("positive density"), "{error}");
    }

    #[test]
    fn a_weight_above_the_root_is_cut() {
        let mut weights = [1.0; 9];
        weights[8] = 92.0;
        // Of nine, at most a third: 0.92 becomes 1/3 beside eight of 0.01.
        let found = cut(&draws(&weights, 0.0));
        let total = 0.08 + 1.0 / 3.0;
        close(found[0], 0.01 / total);
        close(found[8], 1.0 / 3.0 / total);
        close(found.iter().sum(), 1.0);
    }

    #[test]
    fn a_weight_above_the_root_is_cut_in_the_sum() {
        // Of nine with a mean of 4, at most 12; what has no density has none.
        let mut weights = [1.0; 9];
        weights[8] = 28.0;
        let found = draws(&weights, -2000.0);
        let sum = summed_cut(&found).unwrap();
        close(sum.log, (20.0_f64 / 9.0).ln() - 2000.0);
        close(sum.weights[8], 12.0 / 20.0);
        all_close(&sum.weights, &cut(&found));
        assert!(summed_cut(&[Particle::without_density(1)]).is_err());
        // Even weights are as they were.
        let even = summed_cut(&draws(&[2.0; 4], 0.0)).unwrap();
        close(even.log, 2.0_f64.ln());
    }

    #[test]
    fn effective_numbers_of_powers_of_weights() {
        let logs = [1.0, 2.0, 3.0, 4.0].map(f64::ln);
        close(effective(&logs, 0.0), 4.0);
        close(effective(&logs, 1.0), 100.0 / 30.0);
        // Squares 1, 4, 9, 16 and fourth powers 1, 16, 81, 256.
        close(effective(&logs, 2.0), 900.0 / 354.0);
    }

    #[test]
    fn heavy_tails_are_known_and_warned_of() {
        // Weights u^-k of even u have the tail index k.
        let heavy = |k: f64| {
            let weight = |i: i32| ((f64::from(i) + 0.5) / 4000.0).powf(-k);
            draws(&(0..4000).map(weight).collect::<Vec<_>>(), 0.0)
        };
        for k in [0.3, 0.9] {
            assert!((quality(&heavy(k)).1 - k).abs() < 0.1);
        }
        let warnings = |k| summed(&heavy(k)).unwrap().warnings;
        assert!(warnings(0.3).is_empty());
        assert!(warnings(0.9)[0].contains("heavy tail"));
        // The thresholds themselves are still good.
        assert!(warn(0.7, 2.0, 100.0).is_empty());
        assert!(warn(0.71, 2.0, 100.0)[0].contains("k = 0.71"));
        assert!(warn(0.7, 1.4, 100.0)[0].contains("only 1 of 100"));
        assert_eq!(warn(0.71, 1.4, 100.0).len(), 2);
    }

    #[test]
    fn as_many_are_chosen_as_the_weights_are_worth() {
        let mut sum = summed(&draws(&[1.0, 3.0], 0.0)).unwrap();
        for (effective, count) in [(3.0, 100), (100.5, 100), (400.5, 400)] {
            sum.effective = effective;
            let chosen = sum.chosen(Seed::new(1));
            let second = chosen.iter().filter(|&&i| i == 1).count();
            assert_eq!((chosen.len(), second), (count, count * 3 / 4));
        }
    }

    #[test]
    fn systematic_resampling_is_even_and_unbiased() {
        // The sum is not 1, and some weigh nothing.
        let weights = [0.0, 1.0, 2.0, 0.0, 3.0, 4.5, 0.0];
        let (count, rounds) = (7, 4000);
        let expected = weights.map(|w| f64::from(count) * w / 10.5);
        let mut totals = [0.0; 7];
        for round in 0..rounds {
            let mut rng = Seed::new(round).rng();
            let chosen = systematic(&weights, count as usize, &mut rng);
            assert_eq!(chosen.len(), count as usize);
            assert!(chosen.is_sorted());
            for i in 0..7 {
                let found = chosen.iter().filter(|&&c| c == i).count() as f64;
                assert!((found - expected[i]).abs() < 1.0);
                totals[i] += found;
            }
        }
        for (total, expected) in totals.iter().zip(expected) {
            // Either of two whole numbers: a standard deviation of 1/2.
            let error = 0.5 / (rounds as f64).sqrt();
            assert!((total / rounds as f64 - expected).abs() < 4.5 * error);
        }
    }
}
