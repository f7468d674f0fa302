//! The model as it was: what its residuals and its errors say of it.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::diagnosis::compare::before_and_after::{Figures, rows_of};
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::findings::Baseline;
use crate::diagnosis::options::Options;
use crate::draws::{Draws, median, normal_p};
use crate::observe::Event;

/// How the model as it was stands to the recording.
pub(crate) fn baseline(
    none: &Fit,
    old: &Figures,
    event: &Event,
    options: &Options,
) -> Baseline {
    let innovations = old.innovations.concat();
    Baseline {
        friction: options.friction.clone(),
        noise: options.noise.clone(),
        mechanisms: options.labels(),
        log_evidence: none.log_evidence,
        rmse: old.rmse,
        ljung_box_p: old.ljung_box_p,
        shapiro_wilk_p: normal_p(&innovations),
        predictive_p: largest_p(&innovations),
        stationary_sd: stationary_sd(&none.draws),
        innovation_sd: innovation_sd(&none.draws),
        instrument: instrument(event),
    }
}

/// The probability of an innovation as large as the largest among as many.
fn largest_p(innovations: &[f64]) -> f64 {
    let largest = innovations.iter().map(|d| d.abs()).fold(0.0, f64::max);
    let outside = 2.0 * Normal::standard().cdf(-largest);
    -(innovations.len() as f64 * (-outside).ln_1p()).exp_m1()
}

/// The sd of AR(1) errors themselves, sqrt(sigma2/(1 - phi^2)): the median.
pub(crate) fn stationary_sd(draws: &Draws) -> Option<f64> {
    middle(draws, |phi, sigma2| (sigma2 / (1.0 - phi.powi(2))).sqrt())
}

/// The sd of the innovations of AR(1) errors: the median.
fn innovation_sd(draws: &Draws) -> Option<f64> {
    middle(draws, |_, sigma2| sigma2.sqrt())
}

/// The median of a function of phi and sigma2, where the noise has both.
fn middle(draws: &Draws, of: impl Fn(f64, f64) -> f64) -> Option<f64> {
    let column = |name: &str| draws.names().iter().position(|n| n == name);
    let (phi, sigma2) = (column("phi")?, column("sigma2")?);
    let values: Vec<f64> =
        rows_of(draws).iter().map(|row| of(row[phi], row[sigma2])).collect();
    Some(median(&values))
}

/// The mean known error of the recording's values.
fn instrument(event: &Event) -> Option<f64> {
    let errors = event.recordings().next()?.grid().standard_errors()?;
    Some(errors.iter().sum::<f64>() / errors.len() as f64)
}
