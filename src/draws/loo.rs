//! Leave-one-out prediction by Pareto-smoothed importance sampling.
//!
//! After Vehtari, Gelman & Gabry (2017), "Practical Bayesian model evaluation
//! using leave-one-out cross-validation and WAIC", Statistics and Computing
//! 27; the smoothing as in Vehtari, Simpson, Gelman, Yao & Gabry (2024),
//! "Pareto smoothed importance sampling", JMLR 25; the fit of the tail after
//! Zhang & Stephens (2009), "A new and efficient estimation method for the
//! generalized Pareto distribution", Technometrics 51(3).

use super::spectrum::variance;

/// An estimate of how well a model predicts observations left out of its fit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Loo {
    /// The expected log predictive density, summed over observations.
    pub elpd: f64,
    /// Its standard error; NaN for one observation.
    pub se: f64,
    /// The effective number of parameters: the in-sample log predictive
    /// density less `elpd`.
    pub p_loo: f64,
    /// The part of `elpd` of each observation.
    pub pointwise: Vec<f64>,
    /// The Pareto shape of each observation's weights; to be trusted below
    /// [`k_threshold`], unknown where NaN.
    pub pareto_k: Vec<f64>,
}

/// Leave-one-out prediction from `log_likelihood`, draws x observations.
///
/// Nothing without draws or observations, or for rows of different lengths.
/// An observation with a non-finite log-likelihood makes the sums NaN.
///
/// ```
/// use couloir::draws::loo;
/// // A likelihood that no draw changes predicts as well as it fits.
/// let found = loo(&vec![vec![-1.5, -0.5]; 100]).expect("a full table");
/// assert!((found.elpd + 2.0).abs() < 1e-12);
/// assert!(found.p_loo.abs() < 1e-12);
/// ```
pub fn loo(log_likelihood: &[Vec<f64>]) -> Option<Loo> {
    loo_of_chains(log_likelihood, 1.0)
}

/// The same from draws that depend on each other, of which each is worth
/// `efficiency` independent ones (see
/// [`relative_efficiency`](super::relative_efficiency)).
///
/// ```
/// use couloir::draws::{loo, loo_of_chains};
/// let at = |i: i32| (f64::from(i) * 0.7).sin().powi(4);
/// let draw = |i: i32| vec![-0.5 - at(i), -0.7 - at(i + 1)];
/// let table: Vec<_> = (0..500).map(draw).collect();
/// assert_eq!(loo_of_chains(&table, 1.0), loo(&table));
/// assert_ne!(loo_of_chains(&table, 0.3), loo(&table));
/// ```
pub fn loo_of_chains(
    log_likelihood: &[impl AsRef<[f64]>],
    efficiency: f64,
) -> Option<Loo> {
    let rows = || log_likelihood.iter().map(AsRef::as_ref);
    let observations = rows().next()?.len();
    let ragged = rows().any(|row| row.len() != observations);
    if observations == 0 || ragged {
        return None;
    }
    let column = |i: usize| -> Vec<f64> { rows().map(|row| row[i]).collect() };
    let [mut pointwise, mut pareto_k] = [vec![], vec![]];
    let mut in_sample = 0.0;
    for observed in (0..observations).map(column) {
        let (elpd, k) = left_out(&observed, efficiency);
        pointwise.push(elpd);
        pareto_k.push(k);
        in_sample += log_sum_exp(observed.iter().copied())
            - (observed.len() as f64).ln();
    }
    let (elpd, se) = sum_and_error(&pointwise);
    Some(Loo { elpd, se, p_loo: in_sample - elpd, pointwise, pareto_k })
}

/// The sum of pointwise parts, and its standard error over observations that
/// count as independent; the error of one is NaN.
///
/// Of two models the parts are those of the same observations: the error of a
/// difference is that of the sum of their differences, which is smaller than
/// the two errors together say (Vehtari and others 2017, equation 24).
///
/// ```
/// use couloir::draws::sum_and_error;
/// let (sum, se) = sum_and_error(&[-1.0, -3.0]);
/// assert_eq!((sum, se), (-4.0, 2.0));
/// ```
pub fn sum_and_error(parts: &[f64]) -> (f64, f64) {
    let se = (parts.len() as f64 * variance(parts)).sqrt();
    (parts.iter().sum(), se)
}

/// The log predictive density of one observation without it, and the shape
/// of its weights.
fn left_out(log_likelihood: &[f64], efficiency: f64) -> (f64, f64) {
    let log_ratios: Vec<f64> = log_likelihood.iter().map(|l| -l).collect();
    let (log_weights, k) = psis_of_chains(&log_ratios, efficiency);
    let terms = log_weights.iter().zip(log_likelihood).map(|(w, l)| w + l);
    (log_sum_exp(terms), k)
}

/// The shape below which an importance-sampling estimate from `draws` draws
/// can be trusted: 1 - 1 / log10(draws), at most 0.7 (Vehtari and others
/// 2024).
pub fn k_threshold(draws: usize) -> f64 {
    (1.0 - 1.0 / (draws as f64).log10()).min(0.7)
}

/// Pareto-smoothed importance weights and the shape of their tail.
///
/// Takes log importance ratios up to a constant, returns log weights that sum
/// to 1 on the plain scale, in the same order, and the shape k of the
/// generalised Pareto distribution that fits the largest
/// min(S / 5, 3 sqrt(S)) of S ratios. These are replaced by that
/// distribution's quantiles, at most the largest ratio. Ratios count as
/// independent; a ratio of 0 (a log of minus infinity) is allowed.
///
/// k is NaN, and the weights are not smoothed, where the tail has fewer than
/// five ratios, that is below 21 draws. It is minus infinity where all of the
/// tail is equal, as for constant weights, and infinity, without smoothing,
/// where fewer than five are above the rest, since so many are equal. NaN or
/// infinite ratios make everything NaN.
///
/// ```
/// use couloir::draws::psis;
/// // Ratios u^(-0.5) of uniform u have a tail of shape 0.5.
/// let ratio = |i: i32| -0.5 * ((f64::from(i) + 0.5) / 1e4).ln();
/// let (log_weights, k) = psis(&(0..10_000).map(ratio).collect::<Vec<_>>());
/// assert!((k - 0.5).abs() < 0.05);
/// let sum: f64 = log_weights.iter().map(|w| w.exp()).sum();
/// assert!((sum - 1.0).abs() < 1e-12);
/// ```
pub fn psis(log_ratios: &[f64]) -> (Vec<f64>, f64) {
    psis_of_chains(log_ratios, 1.0)
}

/// The same for ratios that depend on each other, of which each is worth
/// `efficiency` independent ones.
///
/// Neighbours in a chain are large together, so that a tail of the same
/// number of them says less: it has min(S / 5, 3 sqrt(S / efficiency)) ratios
/// then (Vehtari and others 2024, appendix H).
///
/// ```
/// use couloir::draws::{psis, psis_of_chains};
/// let ratios: Vec<_> = (1..2000).map(|i| -0.5 * f64::from(i).ln()).collect();
/// assert_eq!(psis_of_chains(&ratios, 1.0), psis(&ratios));
/// assert_ne!(psis_of_chains(&ratios, 0.25), psis(&ratios));
/// ```
pub fn psis_of_chains(log_ratios: &[f64], efficiency: f64) -> (Vec<f64>, f64) {
    let largest = log_ratios.iter().copied().fold(f64::NAN, f64::max);
    let broken = log_ratios.iter().any(|r| r.is_nan());
    if broken || !largest.is_finite() {
        return (vec![f64::NAN; log_ratios.len()], f64::NAN);
    }
    let mut logs: Vec<f64> = log_ratios.iter().map(|r| r - largest).collect();
    let k = smooth_tail(&mut logs, efficiency);
    let norm = log_sum_exp(logs.iter().copied());
    logs.iter_mut().for_each(|log| *log -= norm);
    (logs, k)
}

/// The fewest ratios that a tail is fitted to.
const LEAST: usize = 5;

/// Smooths the tail of log ratios whose largest is 0, and gives its shape.
fn smooth_tail(logs: &mut [f64], efficiency: f64) -> f64 {
    let draws = logs.len() as f64;
    let tail = (0.2 * draws).min(3.0 * (draws / efficiency).sqrt());
    let tail = tail.ceil() as usize;
    if tail < LEAST {
        return f64::NAN;
    }
    let mut order: Vec<usize> = (0..logs.len()).collect();
    order.sort_unstable_by(|a, b| logs[*a].total_cmp(&logs[*b]));
    let (body, tail) = order.split_at(logs.len() - tail);
    let (Some(body), [least, .., most]) = (body.last(), tail) else {
        return f64::NAN;
    };
    if logs[*least] == logs[*most] {
        return f64::NEG_INFINITY;
    }
    // What equals the cut-off does not exceed it: of equal ratios, all are in
    // the tail or none, whichever way they were sorted.
    let cutoff = logs[*body];
    let ties = tail.partition_point(|at| logs[*at] <= cutoff);
    let tail = &tail[ties..];
    if tail.len() < LEAST {
        return f64::INFINITY;
    }
    let cutoff = cutoff.exp();
    let excess: Vec<f64> =
        tail.iter().map(|at| logs[*at].exp() - cutoff).collect();
    let Some((k, scale)) = generalised_pareto(&excess) else {
        return f64::NAN;
    };
    let count = tail.len() as f64;
    for (i, at) in tail.iter().enumerate() {
        let p = (i as f64 + 0.5) / count;
        logs[*at] = (cutoff + pareto_quantile(p, k, scale)).ln().min(0.0);
    }
    k
}

/// The shape and scale of a generalised Pareto distribution of excesses in
/// rising order.
///
/// The estimate of Zhang & Stephens: the posterior mean of the shape-to-scale
/// ratio under their data-dependent prior, by quadrature over 30 + sqrt(n)
/// points of its range, and the shape that is likeliest with it. The shape is
/// then drawn towards 0.5 as by ten more observations (Vehtari and others
/// 2024). A positive shape is a heavy tail, of which moments up
/// to 1 / shape exist; Zhang & Stephens have the other sign.
///
/// Nothing without a spread of positive excesses.
fn generalised_pareto(excess: &[f64]) -> Option<(f64, f64)> {
    let n = excess.len() as f64;
    let largest = *excess.last()?;
    let quartile = excess[((n / 4.0 + 0.5) as usize).max(1) - 1];
    // Zeros are ties with the cut-off and leave the first quartile only.
    let quartile = match excess.iter().find(|x| **x > 0.0) {
        Some(least) => quartile.max(*least),
        None => return None,
    };
    if !largest.is_finite() || excess.iter().any(|x| x.is_nan() || *x < 0.0) {
        return None;
    }
    let points = (30.0 + n.sqrt().floor()) as usize;
    let ratio = |j: usize| {
        let spread = (points as f64 / (j as f64 + 0.5)).sqrt();
        1.0 / largest + (1.0 - spread) / (3.0 * quartile)
    };
    // Minus the shape-to-scale ratio, and what it leaves for the shape.
    let ratios: Vec<f64> = (0..points).map(ratio).collect();
    let shape = |b: f64| mean_log_one_minus(b, excess);
    let likelihood = |b: &f64| {
        let k = shape(*b);
        n * ((-b / k).ln() - k - 1.0)
    };
    let logs: Vec<f64> = ratios.iter().map(likelihood).collect();
    let norm = log_sum_exp(logs.iter().copied());
    let weighted = ratios.iter().zip(&logs);
    let b: f64 = weighted.map(|(b, log)| b * (log - norm).exp()).sum();
    let k = shape(b);
    let (scale, k) = (-k / b, (n * k + 5.0) / (n + 10.0));
    (k.is_finite() && scale > 0.0).then_some((k, scale))
}

/// The mean of log(1 - b x).
fn mean_log_one_minus(b: f64, x: &[f64]) -> f64 {
    x.iter().map(|x| (-b * x).ln_1p()).sum::<f64>() / x.len() as f64
}

/// The quantile of a generalised Pareto distribution.
fn pareto_quantile(p: f64, k: f64, scale: f64) -> f64 {
    let exponential = -(-p).ln_1p();
    if k == 0.0 {
        return scale * exponential;
    }
    scale * (k * exponential).exp_m1() / k
}

/// The logarithm of a sum of exponentials; minus infinity for no terms.
pub(crate) fn log_sum_exp(logs: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = logs.clone().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY && !logs.clone().any(f64::is_nan) {
        return largest;
    }
    let sum: f64 = logs.map(|log| (log - largest).exp()).sum();
    largest + sum.ln()
}

/// The share of each in what logarithms add up to.
pub(crate) fn shares(logs: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
    let total = log_sum_exp(logs.clone());
    logs.map(|l| (l - total).exp()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::sample::{close, uniform};
    use statrs::distribution::{Continuous, ContinuousCDF, Normal};

    // Reference values from ArviZ (arviz-stats 0.8.0) on the same numbers.
    // It leaves out negligible points of the quadrature, hence the tolerance.
    const TOLERANCE: f64 = 1e-8;

    #[test]
    fn smoothing_agrees_with_arviz() {
        // k, the two greatest log weights, the 100th greatest, the first.
        let expected = [(0.3, 0.45162003547411017), (0.8, 1.0256250073353947)];
        let weights = [
            [-5.586007714073394, -5.631387291621612, -7.225437796012944],
            [-2.4704430331535217, -2.7741033850545573, -6.854895471680928],
        ];
        let first = [-5.985540794518776, -3.638415273638638];
        let u = uniform(99, 2500);
        for (i, (shape, k)) in expected.into_iter().enumerate() {
            let ratios: Vec<f64> = u.iter().map(|u| -shape * u.ln()).collect();
            let (mut found, found_k) = psis(&ratios);
            close(found_k, k, TOLERANCE);
            close(found[0], first[i], TOLERANCE);
            found.sort_unstable_by(|a, b| b.total_cmp(a));
            for (at, w) in [0, 1, 99].into_iter().zip(weights[i]) {
                close(found[at], w, TOLERANCE);
            }
        }
    }

    /// Twelve observations of a normal mean, one of them far out.
    const OBSERVED: [f64; 12] =
        [0.3, -1.2, 0.8, 1.9, -0.4, 0.1, 5.0, -0.9, 0.6, 1.1, -0.2, 0.5];

    /// Log-likelihoods of the observations under draws of their mean.
    fn table(draws: usize) -> Vec<Vec<f64>> {
        let n = OBSERVED.len() as f64;
        let centre = OBSERVED.iter().sum::<f64>() / n;
        let law = Normal::new(centre, 1.0 / n.sqrt()).unwrap();
        let row = |u: f64| {
            let law = Normal::new(law.inverse_cdf(u), 1.0).unwrap();
            OBSERVED.iter().map(|x| law.ln_pdf(*x)).collect()
        };
        uniform(4242, draws).into_iter().map(row).collect()
    }

    #[test]
    fn prediction_agrees_with_arviz() {
        let found = loo(&table(900)).unwrap();
        close(found.elpd, -27.344567040273255, TOLERANCE);
        close(found.se, 10.109139453323552, TOLERANCE);
        close(found.p_loo, 2.5659974543562853, 1e-7);
        close(found.pointwise[6], -11.354028271557892, TOLERANCE);
        close(found.pareto_k[6], 0.6507797466243039, TOLERANCE);
        close(found.pareto_k[0], 0.09307057552630017, TOLERANCE);
    }

    #[test]
    fn prediction_comes_near_the_exact_one() {
        // Without x the mean is N(m, 1/11), x is N(m, 12/11). The error of
        // 20 000 draws is 1 % of the variance of a weight or less, but for
        // the observation far out, whose weights have little more than a
        // variance.
        let found = loo(&table(20_000)).unwrap();
        let sum: f64 = OBSERVED.iter().sum();
        for (i, x) in OBSERVED.iter().enumerate() {
            let sd = (12.0_f64 / 11.0).sqrt();
            let law = Normal::new((sum - x) / 11.0, sd).unwrap();
            let allowed = if i == 6 { 0.3 } else { 0.02 };
            let error = found.pointwise[i] - law.ln_pdf(*x);
            assert!(error.abs() < allowed, "{i} {error}");
        }
    }

    #[test]
    fn shape_of_known_tails_is_found() {
        // Quantiles of the law itself; the prior of weight 10 moves k by
        // 10 / n of its distance to 0.5.
        for k in [-0.3, 0.0, 0.2, 0.7, 1.5] {
            let n = 2000;
            let at = |i| {
                pareto_quantile((f64::from(i) + 0.5) / f64::from(n), k, 2.0)
            };
            let excess: Vec<f64> = (0..n).map(at).collect();
            let (found, scale) = generalised_pareto(&excess).unwrap();
            assert!((found - k).abs() < 0.03, "{k} {found}");
            close(scale, 2.0, 0.03);
        }
    }

    #[test]
    fn quantiles_invert_the_distribution() {
        // 1 - (1 + k x / scale)^(-1/k)
        for k in [-0.4, 1e-9, 0.8] {
            let x = pareto_quantile(0.3, k, 2.0);
            let p = 1.0 - (-(k * x / 2.0).ln_1p() / k).exp();
            close(p, 0.3, 1e-12);
        }
        close(pareto_quantile(0.3, 0.0, 2.0), -2.0 * 0.7_f64.ln(), 1e-15);
    }

    #[test]
    fn constant_weights_are_best() {
        let (weights, k) = psis(&[3.0; 100]);
        assert_eq!(k, f64::NEG_INFINITY);
        assert!(k < k_threshold(100));
        weights.iter().for_each(|w| close(*w, -100.0_f64.ln(), 1e-12));
    }

    #[test]
    fn equal_ratios_have_equal_weights() {
        // The tail of 1000 begins at the 905th: within the draws from 900 to
        // 909, which a chain that stood still made equal.
        let ratio = |i: u32| f64::from(i / 10).powi(2) / 1e3;
        let ratios: Vec<f64> = (0..1000).map(ratio).collect();
        let (weights, k) = psis(&ratios);
        assert!(k.is_finite());
        let stood = &weights[900..910];
        assert!(stood.iter().all(|w| *w == stood[0]), "{stood:?}");
        // Two values alone are no tail.
        let ratios = [vec![0.0; 900], vec![1.0; 2]].concat();
        assert_eq!(psis(&ratios).1, f64::INFINITY);
    }

    #[test]
    fn few_draws_are_weighted_without_smoothing() {
        let (weights, k) = psis(&[0.0, 2.0_f64.ln(), f64::NEG_INFINITY]);
        assert!(k.is_nan());
        close(weights[1].exp(), 2.0 / 3.0, 1e-15);
        assert_eq!(weights[2], f64::NEG_INFINITY);
        assert!(psis(&[]).0.is_empty());
    }

    #[test]
    fn most_ratios_may_be_zero() {
        let mut ratios = vec![f64::NEG_INFINITY; 200];
        for (i, r) in ratios.iter_mut().take(20).enumerate() {
            *r = 0.1 * i as f64;
        }
        let (weights, _) = psis(&ratios);
        assert!(weights.iter().all(|w| !w.is_nan()));
        close(weights.iter().map(|w| w.exp()).sum(), 1.0, 1e-12);
    }

    #[test]
    fn threshold_grows_to_seven_tenths() {
        close(k_threshold(100), 0.5, 1e-15);
        assert_eq!(k_threshold(1_000_000), 0.7);
    }

    #[test]
    fn no_figure_is_nan_or_none() {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut ratios = vec![0.0; 50];
            ratios[7] = bad;
            let (weights, k) = psis(&ratios);
            assert!(k.is_nan() && weights.iter().all(|w| w.is_nan()));
            let found = loo(&[vec![1.0, bad], vec![1.0, 1.0]]).unwrap();
            assert!(found.elpd.is_nan());
        }
        let none = vec![f64::NEG_INFINITY; 50];
        assert!(psis(&none).1.is_nan());
        assert!(loo(&[]).is_none() && loo(&[vec![]]).is_none());
        assert!(loo(&[vec![1.0], vec![]]).is_none());
        assert!(loo(&[vec![1.0], vec![2.0]]).unwrap().se.is_nan());
        assert!(generalised_pareto(&[]).is_none());
        assert!(generalised_pareto(&[0.0, 0.0]).is_none());
        assert!(generalised_pareto(&[1.0, f64::NAN]).is_none());
    }
}
