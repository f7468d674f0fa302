//! The model as it was: what its residuals and its errors say of it.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::diagnosis::compare::checks::Checks;
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::findings::Baseline;
use crate::diagnosis::options::Options;
use crate::draws::normal_p;
use crate::observe::Event;

/// How the model as it was stands to the recording.
pub(crate) fn baseline(
    none: &Fit,
    old: &Checks,
    event: &Event,
    options: &Options,
) -> Baseline {
    let innovations = old.innovations.concat();
    Baseline {
        friction: options.friction.clone(),
        noise: options.noise.clone(),
        infers_noise: options.infers_noise,
        mechanisms: options.labels(),
        priors: options.priors.clone(),
        log_evidence: none.log_evidence,
        rmse: old.rmse,
        ljung_box_p: old.ljung_box_p,
        shapiro_wilk_p: normal_p(&innovations),
        predictive_p: largest_p(&innovations),
        stationary_sd: old.stationary.map(|errors| errors.error_sd),
        innovation_sd: old.stationary.map(|errors| errors.innovation_sd),
        instrument: instrument(event),
    }
}

/// The probability of an innovation as large as the largest among as many.
fn largest_p(innovations: &[f64]) -> f64 {
    let largest = innovations.iter().map(|d| d.abs()).fold(0.0, f64::max);
    let outside = 2.0 * Normal::standard().cdf(-largest);
    -(innovations.len() as f64 * (-outside).ln_1p()).exp_m1()
}

/// The mean known error of the recording's values.
fn instrument(event: &Event) -> Option<f64> {
    let errors = event.recordings().next()?.grid().standard_errors()?;
    Some(errors.iter().sum::<f64>() / errors.len() as f64)
}
