//! The noises that a calibration was averaged over.

use super::text::{plain, shorten};
use super::{CalibrationReport, ParameterReport};

/// A noise that may have made the errors.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct NoiseReport {
    /// Its name, as in `event.toml`.
    pub name: String,
    /// Its probability among those that were kept.
    pub probability: f64,
    /// Against the noise that stands where none is named.
    pub log10_bayes_factor: f64,
    /// Its parameters; none where it is too improbable for a calibration.
    pub parameters: Vec<ParameterReport>,
}

impl NoiseReport {
    /// Its probability in two digits.
    fn probability_told(&self) -> String {
        match self.probability {
            p if p < 0.001 => "< 0.001".to_owned(),
            p => format!("{p:.3}"),
        }
    }

    /// As tables have it, its Bayes factor to a tenth of a power of ten.
    pub(super) fn row(&self) -> NoiseRow {
        NoiseRow {
            name: self.name.clone(),
            probability: self.probability_told(),
            factor: format!("{:+.1}", self.log10_bayes_factor),
        }
    }
}

/// What was averaged over, and what was not.
pub(super) fn averaged(report: &CalibrationReport) -> Option<String> {
    let likeliest = report.noises.first()?;
    let name = plain(&likeliest.name);
    if report.noises.len() == 1 {
        return Some(format!(
            "No noise was named: {name} is by far the likeliest."
        ));
    }
    Some(format!(
        "No noise was named: the motion's parameters are averaged over those \
         that may have made the errors. Figures of the errors, checks and \
         predictions are those of the likeliest, {name} (probability {}).",
        likeliest.probability_told()
    ))
}

/// The noises with their probabilities, at most `width` characters a line;
/// empty where the noise was named.
///
/// ```
/// use couloir::report::{CalibrationReport, noises};
/// assert!(noises(&CalibrationReport::default(), 80).is_empty());
/// ```
pub fn noises(report: &CalibrationReport, width: usize) -> String {
    if report.noises.is_empty() {
        return String::new();
    }
    let rows: Vec<NoiseRow> =
        report.noises.iter().map(NoiseReport::row).collect();
    let mut text = noise_lines(&rows, width).join("\n");
    text.push('\n');
    text
}

/// A noise as tables have it, the figures as text.
pub(crate) struct NoiseRow {
    pub(crate) name: String,
    pub(crate) probability: String,
    pub(crate) factor: String,
}

/// The lines of a table of noises, at most `width` characters each.
pub(crate) fn noise_lines(rows: &[NoiseRow], width: usize) -> Vec<String> {
    let name = width.saturating_sub(20).clamp(8, 40);
    let line = |noise: &str, p: &str, factor: &str| {
        format!("{:<name$}  {p:>7}  {factor:>8}", shorten(noise, name))
    };
    let head = line("noise", "prob.", "log10 BF");
    let mut lines = vec![head, "─".repeat(name + 19)];
    lines.extend(
        rows.iter().map(|r| line(&plain(&r.name), &r.probability, &r.factor)),
    );
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{calibration_json, fixture, in_words};

    /// The fixture, averaged over two noises.
    fn averaged() -> CalibrationReport {
        let mut report = fixture::calibration();
        assert!(noises(&report, 80).is_empty());
        let named = report.noise.clone();
        for (name, probability, factor) in
            [(named.as_str(), 0.97, 0.0), ("ou + white", 0.03, -1.51)]
        {
            report.noises.push(NoiseReport {
                name: name.to_owned(),
                probability,
                log10_bayes_factor: factor,
                parameters: vec![report.parameters[0].clone()],
                ..NoiseReport::default()
            });
        }
        report
    }

    #[test]
    fn the_noises_are_told_with_their_probabilities() {
        let report = averaged();
        for width in [44, 80] {
            let text = noises(&report, width);
            let widest = text.lines().map(|line| line.chars().count()).max();
            assert!(widest.unwrap() <= width, "{text}");
            assert!(text.contains("0.970") && text.contains("-1.5"), "{text}");
        }
        let said = in_words(&report).join(" ");
        assert!(said.contains("with inferred errors"), "{said}");
        assert!(said.contains("No noise was named: the motion"), "{said}");
        let json = calibration_json(&report);
        assert_eq!(json["model"]["noise"], "infer");
        assert_eq!(json["noise"][1]["name"], "ou + white");
        assert_eq!(json["noise"][1]["probability"], 0.03);
        assert!(json["noise"][0]["parameters"]["mu"]["q05"].is_number());
    }

    #[cfg(feature = "pages")]
    #[test]
    fn the_page_has_the_noises() {
        let html = crate::report::page(&averaged());
        assert!(html.contains("What made the errors"));
        assert!(html.contains("ou + white") && html.contains("−1.5"));
    }
}
