//! Whether a model fits its recording.

use super::CalibrationReport;
use super::digits::significant;
use super::text::unit;

/// How many times as large as what is new in them from value to value the
/// misses of a flow that fits may be: errors of a receiver that smooths over
/// six of its values, or an AR(1) with a correlation of 0.97.
const SMOOTH: f64 = 6.0;
/// How much residuals may be correlated from one value to the next, less what
/// the noise says they are: at a half, values are worth a third of their number,
/// and intervals too narrow by a factor of 1.7.
const CORRELATED: f64 = 0.5;
/// The p-value above which such a correlation may be chance.
const CHANCE: f64 = 1e-3;
/// The log10 Bayes factor from which a force of free form is strong evidence
/// that the model lacks one (Kass, Raftery 1995).
const STRONG: f64 = 1.0;

/// Why the model does not fit, in a sentence; `None` where nothing says so.
///
/// ```
/// use couloir::report::{CalibrationReport, misfit};
/// assert_eq!(misfit(&CalibrationReport::default()), None);
/// ```
pub fn misfit(report: &CalibrationReport) -> Option<String> {
    let reason = swallowed(report)
        .or_else(|| forced(report))
        .or_else(|| correlated(report))?;
    Some(format!(
        "This model does not fit: {reason}; `couloir diagnose` says what may \
         be missing."
    ))
}

/// The flow misses the recording by far more than changes from one value to
/// the next: errors with a memory take a mismatch for their own.
fn swallowed(report: &CalibrationReport) -> Option<String> {
    if report.bands.times != report.times {
        return None;
    }
    let pairs = report.values.iter().zip(&report.bands.median);
    let misses: Vec<f64> = pairs.map(|(value, flow)| value - flow).collect();
    let news = misses.windows(2).map(|w| 0.5 * (w[1] - w[0]).powi(2));
    let news = news.sum::<f64>() / (misses.len() as f64 - 1.0);
    let rmse = report.bands.rmse(&report.values);
    let times = rmse / news.sqrt();
    (times.is_finite() && times > SMOOTH).then(|| {
        format!(
            "its flow misses the recording by {} {}, {} times what changes \
             from one value to the next",
            significant(rmse, 2),
            unit(&report.unit),
            significant(times, 2)
        )
    })
}

/// A force of free form beside it is likely.
fn forced(report: &CalibrationReport) -> Option<String> {
    let log10 = report.law.as_ref()?.log10_bayes_factor;
    (log10 > STRONG).then(|| {
        format!(
            "a force of free form beside it has a log10 Bayes factor of {}",
            significant(log10, 2)
        )
    })
}

/// Residuals are correlated beyond what the noise says.
fn correlated(report: &CalibrationReport) -> Option<String> {
    let next = *report.autocorrelation.first()?;
    let is_sure = report.checks.ljung_box_p < CHANCE;
    (next > CORRELATED && is_sure).then(|| {
        format!(
            "its residuals have a correlation of {} from one value to the next",
            significant(next, 2)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::misfit;
    use crate::report::{LawReport, fixture, in_words};

    #[test]
    fn a_mismatch_that_errors_hide_comes_first() {
        let mut report = fixture::calibration();
        let flow = report.bands.median.clone();
        let slow = |i: usize| 3.0 * (0.05 * i as f64).sin();
        let off = |(i, flow): (usize, &f64)| flow + slow(i);
        report.times = report.bands.times.clone();
        report.values = flow.iter().enumerate().map(off).collect();
        let words = in_words(&report);
        assert!(words[0].starts_with("This model does not fit"), "{words:?}");
        // As large, but new each time.
        let new = |(i, flow): (usize, &f64)| {
            flow + if i % 2 == 0 { 3.0 } else { -3.0 }
        };
        report.values = flow.iter().enumerate().map(new).collect();
        assert_eq!(misfit(&report), None);
    }

    #[test]
    fn a_likely_force_and_correlated_errors_are_misfits() {
        let mut report = fixture::calibration();
        assert_eq!(misfit(&report), None);
        report.autocorrelation[0] = 0.9;
        assert_eq!(misfit(&report), None, "where the test does not object");
        report.checks.ljung_box_p = 1e-6;
        let said = misfit(&report).unwrap();
        assert!(said.contains("a correlation of 0.9"), "{said}");
        report.law = Some(LawReport {
            log10_bayes_factor: 12.3,
            ..LawReport::default()
        });
        let said = misfit(&report).unwrap();
        assert!(said.contains("log10 Bayes factor of 12"), "{said}");
    }
}
