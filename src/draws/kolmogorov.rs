//! The two-sample test of Kolmogorov and Smirnov, between chains.

use std::f64::consts::PI;

use super::Draws;
use super::ess::ess_below;
use super::quantile::{quantile, sorted};

/// A two-sample test of Kolmogorov and Smirnov.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KolmogorovSmirnov {
    /// The largest distance between the two distribution functions.
    pub statistic: f64,
    /// The asymptotic probability of as large a distance between samples of
    /// one distribution.
    pub p: f64,
}

/// The two chains that agree least.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainComparison {
    /// Which chains, counted from 0.
    pub chains: (usize, usize),
    /// Their test; its p is the smallest of all pairs.
    pub test: KolmogorovSmirnov,
    /// How many pairs were compared.
    pub pairs: usize,
}

impl ChainComparison {
    /// The p-value with Bonferroni's allowance for having picked the
    /// smallest of `pairs`.
    pub fn p_adjusted(&self) -> f64 {
        (self.test.p * self.pairs as f64).min(1.0)
    }
}

/// The pair of chains whose draws of `parameter` agree least.
///
/// Draws of a chain are correlated, so each chain counts for the smallest
/// effective size of its three quartiles, though never for more draws than
/// it has. That keeps the test from rejecting chains of one law too often; it
/// rejects them less often than its level says, since in a slow chain all of
/// the distribution function swings together (for autoregressive chains of
/// coefficient 0.9, about 2 % at level 10 %).
///
/// Nothing below two chains, and for chains that have no effective size:
/// shorter than four iterations, constant or non-finite.
///
/// ```
/// use couloir::draws::{Draws, between_chains};
/// let mut draws = Draws::new(vec!["mu".into()], vec!["1".into()])?;
/// for shift in [0.0, 0.0, 3.0] {
///     let wave = (0..100).map(|i| (i as f64).sin() + shift);
///     draws.push_chain(wave.collect(), None)?;
/// }
/// let worst = between_chains(&draws, 0).expect("three proper chains");
/// assert_eq!(worst.chains.1, 2);
/// assert!(worst.p_adjusted() < 0.001);
/// # Ok::<(), couloir::Error>(())
/// ```
pub fn between_chains(
    draws: &Draws,
    parameter: usize,
) -> Option<ChainComparison> {
    let chains: Vec<(Vec<f64>, f64)> = draws
        .column(parameter)
        .into_iter()
        .map(|x| (sorted(x.clone()), x))
        .map(|(sorted, x)| {
            let size = effective_size(x, &sorted);
            (sorted, size)
        })
        .collect();
    let mut worst: Option<ChainComparison> = None;
    let pairs = chains.len() * chains.len().saturating_sub(1) / 2;
    for (j, (y, y_size)) in chains.iter().enumerate() {
        for (i, (x, x_size)) in chains[..j].iter().enumerate() {
            let test = of_sorted(x, y, *x_size, *y_size)?;
            if worst.is_none_or(|other| test.p < other.test.p) {
                worst = Some(ChainComparison { chains: (i, j), test, pairs });
            }
        }
    }
    worst
}

/// The smallest effective size of a chain's quartiles, at most its length;
/// NaN where one of them has none.
fn effective_size(chain: Vec<f64>, sorted: &[f64]) -> f64 {
    let length = chain.len() as f64;
    let chain = [chain];
    [0.25, 0.5, 0.75]
        .map(|p| ess_below(&chain, quantile(sorted, p)))
        .into_iter()
        .fold(length, |a, b| if b < a || b.is_nan() { b } else { a })
}

/// The test between two samples that are worth `x_size` and `y_size`
/// independent values, with the probability of the limit law at
/// D sqrt(x_size y_size / (x_size + y_size)).
///
/// For independent values the sizes are the samples' lengths. Nothing for an
/// empty sample, a NaN or a size that is not positive.
pub fn two_sample(
    x: &[f64],
    y: &[f64],
    x_size: f64,
    y_size: f64,
) -> Option<KolmogorovSmirnov> {
    of_sorted(&sorted(x.to_vec()), &sorted(y.to_vec()), x_size, y_size)
}

fn of_sorted(
    x: &[f64],
    y: &[f64],
    x_size: f64,
    y_size: f64,
) -> Option<KolmogorovSmirnov> {
    let broken = x.last()?.is_nan() || y.last()?.is_nan();
    if broken || !(x_size > 0.0 && y_size > 0.0) {
        return None;
    }
    let statistic = distance(x, y);
    let size = 1.0 / (1.0 / x_size + 1.0 / y_size);
    let p = kolmogorov_survival(size.sqrt() * statistic);
    Some(KolmogorovSmirnov { statistic, p })
}

/// The largest distance between the distribution functions of two samples in
/// rising order, taken after all copies of a value.
fn distance(x: &[f64], y: &[f64]) -> f64 {
    let (mut i, mut j, mut largest) = (0, 0, 0.0_f64);
    while i < x.len() && j < y.len() {
        let value = x[i].min(y[j]);
        i += x[i..].iter().take_while(|v| **v <= value).count();
        j += y[j..].iter().take_while(|v| **v <= value).count();
        let gap = i as f64 / x.len() as f64 - j as f64 / y.len() as f64;
        largest = largest.max(gap.abs());
    }
    largest
}

/// The probability that the limit law of Kolmogorov (1933) exceeds `t`.
///
/// By the alternating series for large `t`, and by its equal under Jacobi's
/// transformation of theta functions for small; both have converged to
/// round-off within six terms on their side of 1.
fn kolmogorov_survival(t: f64) -> f64 {
    const TERMS: std::ops::RangeInclusive<i32> = 1..=6;
    if t.is_nan() || t <= 0.0 {
        return if t <= 0.0 { 1.0 } else { f64::NAN };
    }
    if t < 1.0 {
        let exponent = |k| {
            let odd = f64::from(2 * k - 1) * PI / t;
            -odd * odd / 8.0
        };
        let sum: f64 = TERMS.map(|k| exponent(k).exp()).sum();
        return 1.0 - (2.0 * PI).sqrt() / t * sum;
    }
    let sign = |k| if k % 2 == 1 { 2.0 } else { -2.0 };
    let term = |k| sign(k) * (-2.0 * f64::from(k * k) * t * t).exp();
    TERMS.map(term).sum::<f64>().clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seed;
    use crate::draws::sample;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn limit_law_agrees_with_scipy() {
        // scipy.stats.kstwobign.sf of scipy 1.17.1.
        let expected = [
            (0.3, 0.9999906941986655),
            (0.5, 0.9639452436648751),
            (1.0, 0.26999967167735456),
            (1.1, 0.1777181926064012),
            (1.5, 0.022217962616525127),
            (2.0, 0.0006709252557796953),
        ];
        for (t, p) in expected {
            sample::close(kolmogorov_survival(t), p, 1e-12);
        }
        assert_eq!(kolmogorov_survival(0.0), 1.0);
        assert_eq!(kolmogorov_survival(1e-9), 1.0);
        assert_eq!(kolmogorov_survival(f64::INFINITY), 0.0);
        assert!(kolmogorov_survival(f64::NAN).is_nan());
    }

    #[test]
    fn statistic_agrees_with_scipy() {
        // scipy.stats.ks_2samp of scipy 1.17.1.
        let x = sample::ar1(1, 200, 0.3);
        let y: Vec<f64> =
            sample::ar1(2, 150, 0.3).iter().map(|v| v + 0.1).collect();
        let found = two_sample(&x, &y, 200.0, 150.0).unwrap();
        sample::close(found.statistic, 0.22333333333333338, 1e-12);
        // scipy takes the law of finite samples, 0.00030; the limit law
        // lies above it by a relative 2 / sqrt(n) or so.
        sample::close(found.p, 0.00030, 0.4);
    }

    #[test]
    fn ties_count_together() {
        let found = two_sample(&[1.0, 1.0, 2.0], &[1.0, 2.0, 2.0], 3.0, 3.0);
        sample::close(found.unwrap().statistic, 1.0 / 3.0, 1e-15);
        let equal = two_sample(&[1.0; 4], &[1.0; 2], 4.0, 2.0).unwrap();
        assert_eq!((equal.statistic, equal.p), (0.0, 1.0));
    }

    #[test]
    fn correlated_chains_of_one_law_are_rarely_rejected() {
        // 400 pairs of AR(1) chains with coefficient 0.9. At level 0.1 a
        // test of the right size rejects 40 with standard deviation 6, one
        // that ignores correlation rejects most. The slowest mode of such a
        // chain moves the whole distribution function, so its greatest
        // distance is near |N(0, 1)| / 2 instead of a Brownian bridge's,
        // which at the critical 1.224 gives a level of 0.014: 6 of 400.
        let mut rejected = 0;
        for pair in 0..400 {
            let mut rng = Seed::new(11).child(pair).rng();
            let mut chain = || {
                let mut x: f64 = StandardNormal.sample(&mut rng);
                let mut step = || {
                    let e: f64 = StandardNormal.sample(&mut rng);
                    x = 0.9 * x + 0.19_f64.sqrt() * e;
                    x
                };
                (0..1000).map(|_| step()).collect::<Vec<f64>>()
            };
            let draws = sample::draws(&[chain(), chain()]);
            let worst = between_chains(&draws, 0).unwrap();
            rejected += u32::from(worst.test.p < 0.1);
        }
        assert!((1..=58).contains(&rejected), "{rejected}");
    }

    #[test]
    fn the_chain_apart_is_found() {
        let mut chains = sample::chains(4, 200, 0.2);
        chains[2].iter_mut().for_each(|x| *x += 0.4);
        let draws = sample::draws(&chains);
        let worst = between_chains(&draws, 0).unwrap();
        assert!(worst.chains.0 == 2 || worst.chains.1 == 2);
        assert_eq!(worst.pairs, 6);
        assert!(worst.p_adjusted() < 1e-3);
    }

    #[test]
    fn no_figure_is_none() {
        let chain = sample::ar1(0, 20, 0.1);
        let of = |chains: &[Vec<f64>]| {
            between_chains(&sample::draws(chains), 0).is_none()
        };
        assert!(of(&[]) && of(std::slice::from_ref(&chain)));
        assert!(of(&[chain.clone(), vec![1.0; 20]]));
        assert!(of(&[chain.clone(), vec![f64::NAN; 20]]));
        assert!(between_chains(&sample::draws(&[chain]), 3).is_none());
        assert!(two_sample(&[], &[1.0], 1.0, 1.0).is_none());
        assert!(two_sample(&[1.0], &[2.0], 0.0, 1.0).is_none());
        assert!(two_sample(&[1.0], &[2.0], f64::NAN, 1.0).is_none());
    }
}
