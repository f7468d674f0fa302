//! Tests of residuals: are they uncorrelated, are they normal.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use super::quantile::sorted;
use super::spectrum::autocovariance_sum;

/// The autocorrelation of a series at lags 0 to `max_lag`, or to the last lag
/// there is.
///
/// With the series' length as divisor at every lag, so that the estimate is
/// positive definite. NaN for constant and non-finite series.
///
/// ```
/// use couloir::draws::autocorrelation;
/// let found = autocorrelation(&[1.0, -1.0, 1.0, -1.0], 1);
/// assert!((found[1] + 0.75).abs() < 1e-12);
/// ```
pub fn autocorrelation(x: &[f64], max_lag: usize) -> Vec<f64> {
    let covariances = autocovariance_sum(&[x]);
    let constant = x.iter().all(|v| Some(v) == x.first());
    let variance = match covariances.first() {
        Some(v) if !constant => *v,
        _ => f64::NAN,
    };
    let lags = covariances.iter().take(max_lag.saturating_add(1));
    lags.map(|covariance| covariance / variance).collect()
}

/// A test that a series is uncorrelated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LjungBox {
    /// The statistic Q.
    pub statistic: f64,
    /// The degrees of freedom: lags less fitted parameters.
    pub freedom: usize,
    /// The probability of a statistic as large from white noise.
    pub p: f64,
}

/// The test of Ljung & Box (1978), "On a measure of lack of fit in time
/// series models", over the first `lags` autocorrelations of residuals of a
/// model with `fitted` parameters.
///
/// Nothing unless `fitted < lags <` the length of the series, nor for a
/// constant or non-finite series.
pub fn ljung_box(x: &[f64], lags: usize, fitted: usize) -> Option<LjungBox> {
    if fitted >= lags || lags >= x.len() {
        return None;
    }
    let n = x.len() as f64;
    let correlations = autocorrelation(x, lags);
    let terms = correlations.iter().enumerate().skip(1);
    let sum: f64 = terms.map(|(lag, r)| r * r / (n - lag as f64)).sum();
    let statistic = n * (n + 2.0) * sum;
    let freedom = lags - fitted;
    let p = ChiSquared::new(freedom as f64).ok()?.sf(statistic);
    statistic.is_finite().then_some(LjungBox { statistic, freedom, p })
}

/// The p of [`ljung_box`] for innovations, NaN where there is none: over ten
/// lags, or a fifth of the length where that is less (Hyndman &
/// Athanasopoulos 2021, "Forecasting: Principles and Practice", section 5.4).
pub fn uncorrelated_p(innovations: &[f64]) -> f64 {
    let lags = (innovations.len() / 5).clamp(1, 10);
    ljung_box(innovations, lags, 0).map_or(f64::NAN, |test| test.p)
}

/// The p of [`shapiro_wilk`] for innovations, NaN where there is none: of the
/// first 5000, for which its approximations hold.
pub fn normal_p(innovations: &[f64]) -> f64 {
    let first = &innovations[..innovations.len().min(MOST)];
    shapiro_wilk(first).map_or(f64::NAN, |test| test.p)
}

/// The longest sample that Royston's approximations hold for.
const MOST: usize = 5000;

/// A test that a sample is normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapiroWilk {
    /// The statistic W, at most 1.
    pub w: f64,
    /// The probability of a statistic as small from a normal distribution.
    pub p: f64,
}

/// The test of Shapiro & Wilk (1965) by the approximations of Royston (1995),
/// "Remark AS R94: a remark on algorithm AS 181", Applied Statistics 44(4).
///
/// Nothing outside 3 to 5000 values, nor for a constant or non-finite sample.
///
/// ```
/// use couloir::draws::shapiro_wilk;
/// let skewed: Vec<f64> = (0..50).map(|i| (0.1 * i as f64).exp()).collect();
/// assert!(shapiro_wilk(&skewed).is_some_and(|test| test.p < 1e-3));
/// assert!(shapiro_wilk(&[1.0, 2.0]).is_none());
/// ```
pub fn shapiro_wilk(x: &[f64]) -> Option<ShapiroWilk> {
    let n = x.len();
    let finite = x.iter().all(|v| v.is_finite());
    if !(3..=MOST).contains(&n) || !finite {
        return None;
    }
    let x = sorted(x.to_vec());
    let range = x[n - 1] - x[0];
    if range <= 0.0 || !range.is_finite() {
        return None;
    }
    // Free of location and scale, as the statistic is.
    let z: Vec<f64> = x.iter().map(|v| (v - x[0]) / range).collect();
    let weights = shapiro_weights(n);
    let spread = weights.iter().enumerate();
    let best: f64 = spread.map(|(i, a)| a * (z[n - 1 - i] - z[i])).sum();
    let mean = z.iter().sum::<f64>() / n as f64;
    let total: f64 = z.iter().map(|v| (v - mean) * (v - mean)).sum();
    let w = (best * best / total).min(1.0);
    Some(ShapiroWilk { w, p: shapiro_p(w, n) })
}

/// The weights of the upper half of a sample, from the largest value down
/// (Royston 1995).
fn shapiro_weights(n: usize) -> Vec<f64> {
    if n == 3 {
        return vec![std::f64::consts::FRAC_1_SQRT_2];
    }
    let normal = Normal::standard();
    let score =
        |i: usize| -normal.inverse_cdf((i as f64 + 0.625) / (n as f64 + 0.25));
    let mut weights: Vec<f64> = (0..n / 2).map(score).collect();
    let squares = 2.0 * weights.iter().map(|m| m * m).sum::<f64>();
    let u = 1.0 / (n as f64).sqrt();
    let norm = squares.sqrt();
    const LAST: [f64; 6] =
        [0.0, 0.221157, -0.147981, -2.071190, 4.434685, -2.706056];
    const NEXT: [f64; 6] =
        [0.0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633];
    let corrections = if n > 5 { &[LAST, NEXT][..] } else { &[LAST] };
    let (mut rest, mut share) = (squares, 1.0);
    for (m, correction) in weights.iter_mut().zip(corrections) {
        let a = *m / norm + polynomial(correction, u);
        rest -= 2.0 * *m * *m;
        share -= 2.0 * a * a;
        *m = a;
    }
    let scale = (share / rest).sqrt();
    weights.iter_mut().skip(corrections.len()).for_each(|m| *m *= scale);
    weights
}

/// The probability of a statistic at most `w` (Royston 1995; exact for three
/// values).
fn shapiro_p(w: f64, n: usize) -> f64 {
    if n == 3 {
        let angle = w.sqrt().asin() - 0.75_f64.sqrt().asin();
        return (6.0 / std::f64::consts::PI * angle).clamp(0.0, 1.0);
    }
    let size = n as f64;
    let lack = (1.0 - w).ln();
    let (y, mean, log_sd) = if n <= 11 {
        let bound = polynomial(&[-2.273, 0.459], size);
        if lack >= bound {
            return 0.0;
        }
        (
            -(bound - lack).ln(),
            polynomial(&[0.5440, -0.39978, 0.025054, -0.0006714], size),
            polynomial(&[1.3822, -0.77857, 0.062767, -0.0020322], size),
        )
    } else {
        let x = size.ln();
        (
            lack,
            polynomial(&[-1.5861, -0.31082, -0.083751, 0.0038915], x),
            polynomial(&[-0.4803, -0.082676, 0.0030302], x),
        )
    };
    Normal::standard().sf((y - mean) / log_sd.exp())
}

/// A polynomial by its coefficients, constant first.
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::sample::{ar1, close, uniform};

    // Reference values from statsmodels 0.15.0 (acf, acorr_ljungbox) and
    // scipy 1.17.1 (shapiro) on the same numbers.

    #[test]
    fn autocorrelation_agrees_with_statsmodels() {
        let expected = [
            1.0,
            0.30036788706005263,
            0.05409002942612763,
            -0.10317774666009714,
            0.01726622639328631,
        ];
        let found = autocorrelation(&ar1(0, 60, 0.4), 4);
        assert_eq!(found.len(), 5);
        for (x, y) in found.iter().zip(expected) {
            close(*x, y, 1e-12);
        }
    }

    #[test]
    fn ljung_box_agrees_with_statsmodels() {
        let x = ar1(0, 60, 0.4);
        let five = ljung_box(&x, 5, 0).unwrap();
        close(five.statistic, 7.002513957216716, 1e-12);
        close(five.p, 0.22045340888788786, 1e-10);
        let ten = ljung_box(&x, 10, 2).unwrap();
        assert_eq!(ten.freedom, 8);
        close(ten.statistic, 12.77143829172754, 1e-12);
        close(ten.p, 0.11995941383305629, 1e-10);
    }

    #[test]
    fn shapiro_wilk_agrees_with_scipy() {
        // Sizes on either side of every change of formula: W and p of
        // uniform numbers, then of exponential ones.
        let expected = [
            (3, 0.9999993768637729, 0.9984923764145401),
            (4, 0.9837391149526793, 0.9235791116756881),
            (5, 0.8556473367206693, 0.21303807989396922),
            (8, 0.919106961240964, 0.42265907540098824),
            (11, 0.9121448612311434, 0.258527014656064),
            (12, 0.9330981428636936, 0.41411052737923504),
            (50, 0.937823203493586, 0.011059699084531421),
            (1000, 0.9502240499464455, 6.995695109062553e-18),
            (5000, 0.95340429446916, 3.151308286923179e-37),
        ];
        let skewed = [
            (3, 0.8858519223809277, 0.3417856689470353),
            (5, 0.9143429809309666, 0.4941235978986976),
            (8, 0.850547270746402, 0.0964925884565724),
            (50, 0.77903799796412, 2.9800365326364267e-7),
            (1000, 0.8149525540626731, 2.279134428392539e-32),
        ];
        // The published algorithm has coefficients of six digits and its own
        // normal quantiles; scipy's differ from ours in the ninth digit.
        let compare = |x: &[f64], w, p| {
            let found = shapiro_wilk(x).unwrap();
            close(found.w, w, 1e-7);
            close(found.p, p, 1e-4);
        };
        for (n, w, p) in expected {
            compare(&uniform(777, n), w, p);
        }
        for (n, w, p) in skewed {
            let exponential = uniform(777, n).into_iter().map(|u| -u.ln());
            compare(&exponential.collect::<Vec<_>>(), w, p);
        }
    }

    #[test]
    fn shapiro_wilk_ignores_location_and_scale() {
        let x = uniform(5, 40);
        let moved: Vec<f64> = x.iter().map(|v| 1e3 + 1e-3 * v).collect();
        let (one, other) = (shapiro_wilk(&x), shapiro_wilk(&moved));
        // Moving by 1e6 times the scale costs that many digits.
        close(one.unwrap().w, other.unwrap().w, 1e-9);
    }

    #[test]
    fn no_figure_is_none() {
        for x in [&[][..], &[1.0; 9], &[1.0, f64::NAN, 3.0, 4.0]] {
            assert!(shapiro_wilk(x).is_none());
            assert!(ljung_box(x, 2, 0).is_none());
            assert!(autocorrelation(x, 2).iter().all(|r| r.is_nan()));
        }
        let fine = uniform(5, 10);
        assert!(ljung_box(&fine, 10, 0).is_none());
        assert!(ljung_box(&fine, 3, 3).is_none());
        assert!(ljung_box(&fine, 0, 0).is_none());
        assert_eq!(autocorrelation(&fine, usize::MAX).len(), 10);
        assert!(shapiro_wilk(&[f64::MAX, -f64::MAX, 0.0]).is_none());
    }
}
