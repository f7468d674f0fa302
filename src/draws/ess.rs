//! Effective sample sizes, and the Monte Carlo errors that follow from them.
//!
//! After Vehtari, Gelman, Simpson, Carpenter & Buerkner (2021), Bayesian
//! Analysis 16(2), with the initial monotone sequence of Geyer (1992),
//! "Practical Markov chain Monte Carlo", Statistical Science 7(4).
//!
//! Every function takes one parameter's draws, chain by chain, and is NaN
//! below four iterations, for chains of different lengths, for non-finite
//! draws and for constants.

use statrs::distribution::{Beta, ContinuousCDF, Normal};

use super::Draws;
use super::quantile::{quantile, sorted};
use super::rhat::{rank_normalised, split};
use super::spectrum::{Autocovariances, mean, variance};

/// How many independent draws would place the bulk of the distribution as
/// well: the effective size of the rank-normalised draws.
///
/// ```
/// use couloir::draws::ess_bulk;
/// use couloir::Seed;
/// use rand::RngExt;
/// let mut rng = Seed::new(1).rng();
/// let independent: Vec<f64> = (0..1000).map(|_| rng.random()).collect();
/// assert!((ess_bulk(&[independent]) - 1000.0).abs() < 200.0);
/// ```
pub fn ess_bulk(chains: &[Vec<f64>]) -> f64 {
    let Some(halves) = split(chains) else { return f64::NAN };
    effective(&rank_normalised(&halves))
}

/// How many independent draws would place the tails as well: the smaller
/// effective size of the 5 % and 95 % quantiles, or the one that exists where
/// draws repeat so much that a quantile is the extreme value.
pub fn ess_tail(chains: &[Vec<f64>]) -> f64 {
    let pooled = sorted(chains.concat());
    let at = |p| ess_below(chains, quantile(&pooled, p));
    at(0.05).min(at(0.95))
}

/// The effective sample size for the mean.
pub fn ess_mean(chains: &[Vec<f64>]) -> f64 {
    split(chains).map_or(f64::NAN, |halves| effective(&halves))
}

/// The effective sample size for the quantile at probability `p`.
pub fn ess_quantile(chains: &[Vec<f64>], p: f64) -> f64 {
    ess_below(chains, quantile(&sorted(chains.concat()), p))
}

/// How many independent draws each draw is worth: the mean over parameters of
/// the effective size for the mean, over the number of draws. 1 where no
/// parameter has one.
///
/// It says how long the tail of importance weights is, by its square root
/// (see [`psis_of_chains`](super::psis_of_chains)); one number for all
/// observations is what ArviZ takes, too.
///
/// ```
/// use couloir::draws::{Draws, relative_efficiency};
/// let names = || vec!["mu".to_owned()];
/// let mut draws = Draws::new(names(), names())?;
/// // Each value stands ten times: a draw is worth a tenth.
/// let row = |i: u64| ((i / 10 * 7919) % 1009) as f64;
/// draws.push_chain((0..10_000).map(row).collect(), None)?;
/// assert!((relative_efficiency(&draws) - 0.1).abs() < 0.05);
/// # Ok::<(), couloir::Error>(())
/// ```
pub fn relative_efficiency(draws: &Draws) -> f64 {
    let sizes = (0..draws.dimension()).map(|i| ess_mean(&draws.column(i)));
    let sizes: Vec<f64> = sizes.filter(|size| size.is_finite()).collect();
    match sizes.len() {
        0 => 1.0,
        _ => mean(&sizes) / draws.total() as f64,
    }
}

/// The Monte Carlo standard error of the mean, in the parameter's unit.
pub fn mcse_mean(chains: &[Vec<f64>]) -> f64 {
    (variance(&chains.concat()) / ess_mean(chains)).sqrt()
}

/// The Monte Carlo standard error of the quantile at probability `p`, in the
/// parameter's unit: half the distance between the order statistics at the
/// ends of a one-sigma interval for `p`.
pub fn mcse_quantile(chains: &[Vec<f64>], p: f64) -> f64 {
    let pooled = sorted(chains.concat());
    let size = ess_below(chains, quantile(&pooled, p));
    let posterior = Beta::new(size * p + 1.0, size * (1.0 - p) + 1.0);
    let (Ok(beta), true) = (posterior, size.is_finite()) else {
        return f64::NAN;
    };
    let one_sigma = Normal::standard().cdf(1.0);
    let total = pooled.len() as f64;
    let last = pooled.len() - 1;
    let low = (beta.inverse_cdf(1.0 - one_sigma) * total - 1.0).floor();
    let high = (beta.inverse_cdf(one_sigma) * total - 1.0).ceil();
    (pooled[(high as usize).min(last)] - pooled[low.max(0.0) as usize]) / 2.0
}

/// The effective size of the indicator of draws at or below `threshold`.
pub(super) fn ess_below(chains: &[Vec<f64>], threshold: f64) -> f64 {
    let Some(halves) = split(chains) else { return f64::NAN };
    let below = |x: &f64| f64::from(u8::from(*x <= threshold));
    let indicators: Vec<Vec<f64>> =
        halves.iter().map(|half| half.iter().map(below).collect()).collect();
    effective(&indicators)
}

/// The effective size of split chains.
///
/// Autocorrelations combine the chains, so that chains which disagree count
/// as strongly correlated. At most n log10(n) draws are claimed for n.
pub(super) fn effective(chains: &[impl AsRef<[f64]>]) -> f64 {
    let mut covariances = Autocovariances::new(chains);
    let n = covariances.lags();
    let (count, draws) = (chains.len() as f64, n as f64);
    let at_zero = covariances.at(0);
    let means: Vec<f64> = chains.iter().map(|c| mean(c.as_ref())).collect();
    let between = if means.len() > 1 { variance(&means) } else { 0.0 };
    let pooled = at_zero / count + between;
    let within = at_zero / count * draws / (draws - 1.0);
    if pooled.is_nan() || pooled <= 0.0 {
        return f64::NAN;
    }
    let correlation = |lag: usize| match lag {
        0 => 1.0,
        _ => 1.0 - (within - covariances.at(lag) / count) / pooled,
    };
    let total = count * draws;
    let time = geyer(correlation, n);
    total / time.max(1.0 / total.log10())
}

/// The integrated autocorrelation time by Geyer's initial monotone sequence.
///
/// Sums of neighbouring pairs (even lag, odd lag) are positive and falling
/// for a reversible chain; the sum ends where they are not positive, and a
/// pair counts no more than that before it. The even lag of the first pair
/// left out counts once, which lowers the variance for antithetic chains.
fn geyer(mut correlation: impl FnMut(usize) -> f64, lags: usize) -> f64 {
    let mut time = -1.0;
    let mut previous = f64::INFINITY;
    let mut lag = 0;
    loop {
        let even = correlation(lag);
        let pair = even + correlation(lag + 1);
        if pair <= 0.0 || lag + 4 >= lags {
            return time + even.max(0.0);
        }
        previous = pair.min(previous);
        time += 2.0 * previous;
        lag += 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seed;
    use crate::draws::sample::{self, close};
    use rand_distr::{Distribution, StandardNormal};

    // Reference values from ArviZ (arviz-stats 0.8.0) on the same numbers,
    // printed to all digits; both follow the paper, so only round-off and
    // the two inverse normal distributions differ.
    const TOLERANCE: f64 = 1e-8;

    struct Expected {
        bulk: f64,
        tail: f64,
        mean: f64,
        quarter: f64,
        mcse_mean: f64,
        mcse_quarter: f64,
    }

    fn compare(chains: &[Vec<f64>], expected: &Expected) {
        close(ess_bulk(chains), expected.bulk, TOLERANCE);
        close(ess_tail(chains), expected.tail, TOLERANCE);
        close(ess_mean(chains), expected.mean, TOLERANCE);
        close(ess_quantile(chains, 0.25), expected.quarter, TOLERANCE);
        close(mcse_mean(chains), expected.mcse_mean, TOLERANCE);
        close(mcse_quantile(chains, 0.25), expected.mcse_quarter, TOLERANCE);
    }

    #[test]
    fn chains_apart_agree_with_arviz() {
        let mut chains = sample::chains(4, 250, 0.6);
        for (c, chain) in chains.iter_mut().enumerate() {
            chain.iter_mut().for_each(|x| *x += 0.1 * c as f64);
        }
        let expected = Expected {
            bulk: 46.250921804213526,
            tail: 323.0740663298981,
            mean: 47.33678008312226,
            quarter: 158.8898503859209,
            mcse_mean: 0.054957648123765156,
            mcse_quarter: 0.03872596830534507,
        };
        compare(&chains, &expected);
    }

    #[test]
    fn skew_and_odd_length_agree_with_arviz() {
        let mut chains = sample::chains(4, 251, 0.9);
        chains.iter_mut().flatten().for_each(|x| *x = x.exp());
        let expected = Expected {
            bulk: 74.10811354868262,
            tail: 175.73326516859626,
            mean: 76.22805388229395,
            quarter: 121.49741022247704,
            mcse_mean: 0.08907493996818705,
            mcse_quarter: 0.059002752853161644,
        };
        compare(&chains, &expected);
    }

    #[test]
    fn antithetic_chains_agree_with_arviz() {
        let expected = Expected {
            bulk: 2322.471989593555,
            tail: 744.7717833612479,
            mean: 2322.471989593555,
            quarter: 1509.9696697010595,
            mcse_mean: 0.006890100441902856,
            mcse_quarter: 0.007965034865003301,
        };
        compare(&sample::chains(2, 400, -0.5), &expected);
    }

    #[test]
    fn autoregression_has_its_known_time() {
        // An AR(1) of coefficient phi has time (1 + phi) / (1 - phi), here
        // 9. The error of Geyer's sum at 4 x 20 000 draws is near 4 %.
        let mut rng = Seed::new(7).rng();
        let mut chain = || {
            let mut x = 0.0;
            let mut step = || {
                let e: f64 = StandardNormal.sample(&mut rng);
                x = 0.8 * x + 0.6 * e;
                x
            };
            (0..20_000).map(|_| step()).collect::<Vec<f64>>()
        };
        let chains: Vec<_> = (0..4).map(|_| chain()).collect();
        close(ess_mean(&chains), 80_000.0 / 9.0, 0.12);
        close(ess_bulk(&chains), 80_000.0 / 9.0, 0.12);
    }

    #[test]
    fn stuck_chains_count_once_each_at_most() {
        let stuck = [vec![1.0; 100], vec![2.0; 100], vec![3.0; 100]];
        assert!(ess_mean(&stuck) < 4.0);
    }

    #[test]
    fn no_figure_is_nan() {
        let bad: [Vec<Vec<f64>>; 5] = [
            vec![],
            vec![vec![]],
            vec![vec![1.0; 50]; 2],
            vec![vec![1.0, f64::NAN, 2.0, 3.0]],
            vec![vec![1.0, 2.0, 3.0, 4.0], vec![1.0]],
        ];
        for chains in &bad {
            assert!(ess_bulk(chains).is_nan());
            assert!(ess_tail(chains).is_nan());
            assert!(mcse_mean(chains).is_nan());
            assert!(mcse_quantile(chains, 0.5).is_nan());
        }
        let fine = [vec![1.0, 3.0, 2.0, 4.0]];
        assert!(ess_bulk(&fine).is_finite());
        assert!(mcse_quantile(&fine, f64::NAN).is_nan());
    }
}
