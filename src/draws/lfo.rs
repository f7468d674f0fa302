//! Leave-future-out prediction by Pareto-smoothed importance sampling.
//!
//! After Buerkner, Gabry & Vehtari (2020), "Approximate leave-future-out
//! cross-validation for Bayesian time series models", Journal of Statistical
//! Computation and Simulation 90(14): each value of a series is predicted
//! from those before it. The draws of one fit are reweighted to each value
//! that comes to be known, until the shape of the weights' tail says that
//! they no longer can be; only then the model is fitted again.

use super::loo::{log_sum_exp, psis, sum_and_error};
use crate::error::{Error, Result};

/// An estimate of how well a model predicts the next value of a series.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Lfo {
    /// The expected log predictive density of the values from `least` on,
    /// each given all before it, summed.
    pub elpd: f64,
    /// Its standard error; NaN for one value.
    pub se: f64,
    /// How many values were known before the first prediction.
    pub least: usize,
    /// The part of `elpd` of each predicted value.
    pub pointwise: Vec<f64>,
    /// The Pareto shape of the weights of each prediction; minus infinity
    /// where the model had just been fitted, so that all weigh the same.
    pub pareto_k: Vec<f64>,
    /// After how many values the model was fitted, the first time included.
    pub fits: Vec<usize>,
}

/// Leave-future-out prediction of a series of `observations` values, from
/// the `least` first on.
///
/// `fit` is asked for a fit to so many first values: the log density of each
/// value of the whole series given those before it, draws of that fit x
/// observations. It is asked again where the Pareto shape of the weights is
/// above `threshold`, or unknown; a threshold of minus infinity fits at
/// every value.
///
/// ```
/// use couloir::draws::leave_future_out;
/// // A density that no draw changes is the prediction.
/// let found = leave_future_out(6, 2, 0.7, |_| Ok(vec![vec![-0.5; 6]; 100]))?;
/// assert!((found.elpd + 2.0).abs() < 1e-12);
/// assert_eq!(found.fits, [2]);
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// No value left to predict, whatever `fit` fails with, or a table of another
/// form.
pub fn leave_future_out(
    observations: usize,
    least: usize,
    threshold: f64,
    mut fit: impl FnMut(usize) -> Result<Vec<Vec<f64>>>,
) -> Result<Lfo> {
    if least >= observations {
        return Err(Error::input(format!(
            "leave-future-out from {least} values on has nothing to predict \
             in a series of {observations}; expected fewer"
        )));
    }
    let mut weighted = Weighted::new(fit(least)?, observations)?;
    let [mut pointwise, mut pareto_k] = [vec![], vec![]];
    let mut fits = vec![least];
    for known in least..observations {
        if known > least {
            weighted.learn(known - 1);
        }
        if known > least && !weighted.can_be_trusted(threshold) {
            weighted = Weighted::new(fit(known)?, observations)?;
            fits.push(known);
        }
        pointwise.push(weighted.predict(known));
        pareto_k.push(weighted.k);
    }
    let (elpd, se) = sum_and_error(&pointwise);
    Ok(Lfo { elpd, se, least, pointwise, pareto_k, fits })
}

/// The draws of a fit, weighted for the values that came to be known since.
struct Weighted {
    table: Vec<Vec<f64>>,
    log_ratios: Vec<f64>,
    log_weights: Vec<f64>,
    k: f64,
}

impl Weighted {
    fn new(table: Vec<Vec<f64>>, observations: usize) -> Result<Self> {
        let draws = table.len();
        if draws == 0 || table.iter().any(|row| row.len() != observations) {
            return Err(Error::inference(format!(
                "a fit for leave-future-out gave a table that is not draws \
                 x {observations} values"
            )));
        }
        let even = -(draws as f64).ln();
        Ok(Self {
            table,
            log_ratios: vec![0.0; draws],
            log_weights: vec![even; draws],
            k: f64::NEG_INFINITY,
        })
    }

    /// Takes a value as known: its density multiplies the ratios.
    fn learn(&mut self, value: usize) {
        for (ratio, row) in self.log_ratios.iter_mut().zip(&self.table) {
            *ratio += row[value];
        }
        (self.log_weights, self.k) = psis(&self.log_ratios);
    }

    /// A shape that is not known (NaN) is not trusted.
    fn can_be_trusted(&self, threshold: f64) -> bool {
        self.k <= threshold && threshold > f64::NEG_INFINITY
    }

    fn predict(&self, value: usize) -> f64 {
        let terms = self.log_weights.iter().zip(&self.table);
        log_sum_exp(terms.map(|(w, row)| w + row[value]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::sample::uniform;
    use statrs::distribution::{Continuous, ContinuousCDF, Normal};

    /// A normal mean with prior N(0, 2^2) and errors of 1; the last but two
    /// lies far out.
    const OBSERVED: [f64; 14] = [
        0.3, -1.2, 0.8, 1.9, -0.4, 0.1, 1.3, -0.9, 0.6, 1.1, -0.2, 3.5, 0.2,
        0.7,
    ];

    /// Mean and variance of the posterior given the first `n`.
    fn posterior(n: usize) -> (f64, f64) {
        let variance = 1.0 / (0.25 + n as f64);
        (variance * OBSERVED[..n].iter().sum::<f64>(), variance)
    }

    fn exact(n: usize) -> f64 {
        let (mean, variance) = posterior(n);
        let law = Normal::new(mean, (variance + 1.0).sqrt()).unwrap();
        law.ln_pdf(OBSERVED[n])
    }

    fn table(n: usize, draws: usize) -> Vec<Vec<f64>> {
        let (mean, variance) = posterior(n);
        let law = Normal::new(mean, variance.sqrt()).unwrap();
        let row = |u: f64| {
            let law = Normal::new(law.inverse_cdf(u), 1.0).unwrap();
            OBSERVED.iter().map(|x| law.ln_pdf(*x)).collect()
        };
        uniform(11 + n as u64, draws).into_iter().map(row).collect()
    }

    #[test]
    fn a_normal_mean_is_predicted_as_in_closed_form() {
        let draws = 20_000;
        let found =
            leave_future_out(14, 4, 0.7, |n| Ok(table(n, draws))).unwrap();
        for (i, value) in found.pointwise.iter().enumerate() {
            // The relative error of a mean of weights with k < 0.7 is a few
            // per cent of its size at 20 000 draws, of most far less.
            assert!((value - exact(4 + i)).abs() < 0.03, "{i}");
        }
        let sum: f64 = (4..14).map(exact).sum();
        assert!((found.elpd - sum).abs() < 0.1, "{} {sum}", found.elpd);
        assert!(found.fits.len() < 10, "{:?}", found.fits);
    }

    #[test]
    fn a_fit_at_every_value_has_even_weights() {
        let least = f64::NEG_INFINITY;
        let fit = |n| Ok(table(n, 5000));
        let found = leave_future_out(14, 4, least, fit).unwrap();
        assert_eq!(found.fits, (4..14).collect::<Vec<_>>());
        assert!(found.pareto_k.iter().all(|k| *k == f64::NEG_INFINITY));
        for (i, value) in found.pointwise.iter().enumerate() {
            // sd of p / mean p, at most about 0.6, over sqrt(5000) draws;
            // five of those.
            assert!((value - exact(4 + i)).abs() < 0.05, "{i}");
        }
    }

    #[test]
    fn weights_that_cannot_be_judged_lead_to_a_fit() {
        // Fewer than 21 draws have no tail.
        let found = leave_future_out(6, 2, 0.7, |n| Ok(table(n, 10)));
        assert!(found.is_err(), "rows of 14 for 6 values");
        let found =
            leave_future_out(14, 10, 0.7, |n| Ok(table(n, 10))).unwrap();
        assert_eq!(found.fits, [10, 11, 12, 13]);
        // Draws that a value excludes, all of them.
        let gone = |_| Ok(vec![vec![0.0, f64::NEG_INFINITY, 0.0]; 50]);
        let found = leave_future_out(3, 1, 0.7, gone).unwrap();
        assert_eq!(found.fits, [1, 2]);
        assert_eq!(found.elpd, f64::NEG_INFINITY);
    }

    #[test]
    fn nothing_to_predict_is_refused() {
        let fit = |n| Ok(table(n, 50));
        assert!(leave_future_out(14, 14, 0.7, fit).is_err());
        assert!(leave_future_out(0, 0, 0.7, fit).is_err());
        assert!(leave_future_out(14, 3, 0.7, |_| Ok(vec![])).is_err());
    }
}
