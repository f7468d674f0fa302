//! The result in sentences that a snow scientist can check.

use super::digits::{beside, p_value, per_cent, significant};
use super::misfit::misfit;
use super::noises::averaged;
use super::text::{capital, law, unit};
use super::{CalibrationReport, LawReport, ParameterReport};

/// The largest R-hat of chains that agree (Vehtari and others, 2021).
const RHAT_AGREES: f64 = 1.01;
/// The smallest effective sample size to trust quantiles with, for each chain
/// (ibid.).
const ESS_ENOUGH: f64 = 100.0;
/// The level of the residual tests.
const LEVEL: f64 = 0.05;
/// How many parameters a sentence lists.
const LISTED: usize = 6;

/// The result in some plain sentences, and one for each warning; the
/// first says where the model does not fit.
///
/// ```
/// use couloir::report::{CalibrationReport, in_words};
/// let words = in_words(&CalibrationReport::default());
/// assert!(words[0].contains("0 values"));
/// ```
pub fn in_words(report: &CalibrationReport) -> Vec<String> {
    let mut words = sentences(report);
    let warnings = report.warnings.iter();
    words.extend(
        warnings.map(|w| format!("Warning: {}.", w.trim_end_matches('.'))),
    );
    words
}

/// The same without the warnings.
pub(super) fn sentences(report: &CalibrationReport) -> Vec<String> {
    [
        misfit(report),
        Some(subject(report)),
        friction(report),
        averaged(report),
        report.law.as_ref().and_then(LawReport::told),
        Some(errors(report)),
        Some(coverage(report)),
        Some(chains(report)),
        Some(residuals(report)),
        evidence(report),
    ]
    .into_iter()
    .flatten()
    .chain(report.notes.iter().cloned())
    .collect()
}

fn subject(report: &CalibrationReport) -> String {
    let times = || report.times.iter().copied().filter(|t| t.is_finite());
    let first = times().fold(f64::INFINITY, f64::min);
    let last = times().fold(f64::NEG_INFINITY, f64::max);
    let n = report.values.len();
    let values = if n == 1 { "value" } else { "values" };
    let span = match last - first {
        span if span > 0.0 => format!(" over {} s", significant(span, 3)),
        _ => String::new(),
    };
    let window = match report.window {
        w if w > 0.0 => {
            format!(", each a mean over {} s", significant(w, 2))
        }
        _ => String::new(),
    };
    let origin = if report.synthetic { " (synthetic data)" } else { "" };
    format!(
        "{} friction with {} errors{} was calibrated on {n} {values} of \
         {}{span}{window}, from the event “{}”{origin}.",
        capital(&law(&report.friction)),
        report.errors_told(),
        report.terms(),
        report.quantity,
        report.event,
    )
}

fn friction(report: &CalibrationReport) -> Option<String> {
    let all: Vec<_> =
        report.parameters.iter().filter(|p| !p.of_errors).collect();
    let first = all.first()?;
    let mut clauses =
        vec![format!("{} is {}", first.name, estimate(first, true))];
    for p in all.iter().take(LISTED).skip(1) {
        clauses.push(format!("{} is {}", p.name, estimate(p, false)));
    }
    let rest = match all.len().saturating_sub(LISTED) {
        0 => String::new(),
        n => format!("; the table has {n} more"),
    };
    Some(format!("By posterior median, {}{rest}.", listed(&clauses)))
}

fn listed(clauses: &[String]) -> String {
    match clauses {
        [init @ .., last] if !init.is_empty() => {
            format!("{} and {last}", init.join(", "))
        }
        _ => clauses.concat(),
    }
}

/// `0.34 (90 % interval 0.20 to 0.48)`.
fn estimate(p: &ParameterReport, first: bool) -> String {
    let unit = match p.unit_shown().as_str() {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    let interval = if first { "90 % interval " } else { "" };
    format!(
        "{}{unit} ({interval}{} to {})",
        beside(p.q50, p.sd),
        beside(p.q05, p.sd),
        beside(p.q95, p.sd)
    )
}

fn errors(report: &CalibrationReport) -> String {
    let mut out = match report.checks.rmse {
        rmse if rmse.is_finite() => format!(
            "The median flow misses the recording by {} {} (root mean square)",
            significant(rmse, 2),
            unit(&report.unit)
        ),
        _ => "How far the median flow is from the recording is not known"
            .to_owned(),
    };
    for p in report.parameters.iter().filter(|p| p.of_errors).take(LISTED) {
        out.push_str("; ");
        out.push_str(&error_clause(p, &report.noise, &unit(&report.unit)));
    }
    out + "."
}

/// The clause about a parameter of the errors: a variance is told as a
/// standard deviation, which a reader can hold against the instrument's.
fn error_clause(p: &ParameterReport, noise: &str, unit: &str) -> String {
    let of_white = p.name.starts_with("white.") || !noise.contains("ar(");
    let scattered = match (noise.contains('+'), of_white) {
        (true, true) => "errors without memory",
        (false, true) => "the errors",
        (_, false) => "the innovations of the errors",
    };
    // With heavy tails it is the scale of a Student-t distribution.
    let what = match noise.contains("tails") {
        true => "scale",
        false => "standard deviation",
    };
    let deviation = |of: &str, root: fn(f64) -> f64| {
        format!(
            "{of} have a {what} of {} {unit} ({} to {})",
            significant(root(p.q50), 2),
            significant(root(p.q05), 2),
            significant(root(p.q95), 2)
        )
    };
    match p.name.rsplit('.').next().unwrap_or_default() {
        "sigma2" => deviation(scattered, f64::sqrt),
        "sigma" => deviation(scattered, |x| x),
        "sd_matern" => deviation("smooth errors", |x| x),
        "sd_ou" => deviation("errors with a memory", |x| x),
        "time_matern" => {
            format!("smooth errors are alike over {}", estimate(p, false))
        }
        "time_ou" => format!("their memory lasts {}", estimate(p, false)),
        "phi" if noise.contains('+') => format!(
            "errors with a memory have a correlation of {} from one value to \
             the next",
            estimate(p, false)
        ),
        "phi" => format!(
            "the errors' correlation from one value to the next is {}",
            estimate(p, false)
        ),
        _ => format!("{} is {}", p.name, estimate(p, false)),
    }
}

fn coverage(report: &CalibrationReport) -> String {
    let share = report.checks.coverage90;
    if !share.is_finite() {
        return "How many values the 90 % predictive band holds is not known."
            .to_owned();
    }
    let n = report.values.len().max(1) as f64;
    let slack = (3.0 * (0.09 / n).sqrt()).max(0.02);
    let verdict = match share - 0.9 {
        d if d < -slack => ", fewer than it should",
        d if d > slack => ", more than it need hold",
        _ => ", about as many as it should",
    };
    format!(
        "The 90 % predictive band holds {} of the values{verdict}.",
        per_cent(share)
    )
}

fn chains(report: &CalibrationReport) -> String {
    let known = |f: fn(&ParameterReport) -> f64| {
        let all =
            report.parameters.iter().map(move |p| (f(p), p.name.as_str()));
        all.filter(|(v, _)| !v.is_nan())
    };
    let order = |a: &(f64, &str), b: &(f64, &str)| a.0.total_cmp(&b.0);
    let rhat = known(|p| p.rhat).max_by(order);
    let ess = known(|p| p.ess_bulk.min(p.ess_tail)).min_by(order);
    let (Some(rhat), Some(ess)) = (rhat, ess) else {
        return "Whether the chains agree is not known.".to_owned();
    };
    let chains = report.parameters.iter().map(|p| p.chains.len()).max();
    let enough = ESS_ENOUGH * chains.unwrap_or(1).max(1) as f64;
    let verdict = match (rhat.0 <= RHAT_AGREES, ess.0 >= enough) {
        (true, true) => "The chains agree",
        (true, false) => "The chains agree but are short: run longer",
        (false, _) => "The chains do not agree, so do not use this result",
    };
    format!(
        "{verdict}: the largest R-hat is {} ({}), the smallest effective \
         sample size {:.0} ({}).",
        match rhat.0.is_finite() {
            true => format!("{:.3}", rhat.0),
            false => "infinite".to_owned(),
        },
        rhat.1,
        ess.0,
        ess.1
    )
}

fn residuals(report: &CalibrationReport) -> String {
    let c = &report.checks;
    let tested = [
        (c.ljung_box_p, "Ljung-Box", "correlation left"),
        (c.shapiro_wilk_p, "Shapiro-Wilk", "a departure from normal"),
    ];
    let known: Vec<_> =
        tested.into_iter().filter(|t| t.0.is_finite()).collect();
    if known.is_empty() {
        return "The residuals were not tested.".to_owned();
    }
    let p: Vec<_> = known
        .iter()
        .map(|t| match p_value(t.0) {
            p if p.starts_with('<') => format!("{} p {p}", t.1),
            p => format!("{} p = {p}", t.1),
        })
        .collect();
    let found: Vec<_> =
        known.iter().filter(|t| t.0 < LEVEL).map(|t| t.2).collect();
    let verdict = if found.is_empty() {
        "do not object to the model".to_owned()
    } else {
        format!("object: they show {}", found.join(" and "))
    };
    format!("Tests of the residuals {verdict} ({}).", p.join(", "))
}

fn evidence(report: &CalibrationReport) -> Option<String> {
    let e = report.evidence.as_ref().filter(|e| e.value.is_finite())?;
    let error = match e.se {
        se if se.is_finite() => format!(" ± {}", beside(se, se)),
        _ => String::new(),
    };
    Some(format!(
        "The log evidence of this model is {}{error} (natural logarithm, {}).",
        beside(e.value, e.se),
        e.method
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture;

    #[test]
    fn the_sentences_of_a_good_run() {
        let words = in_words(&fixture::calibration());
        assert!((5..=8).contains(&words.len()), "{words:#?}");
        assert!(words[0].contains("synthetic data"));
        assert!(words[1].contains("mu is 0.3"));
        assert!(words[4].starts_with("The chains agree:"));
        assert!(words.iter().all(|w| w.ends_with('.')));
    }

    #[test]
    fn trouble_is_said() {
        let mut report = fixture::calibration();
        report.parameters[1].rhat = 1.2;
        report.checks.ljung_box_p = 1e-5;
        report.checks.coverage90 = 0.5;
        let all = in_words(&report).join(" ");
        for said in ["do not agree", "object", "< 0.001", "fewer than"] {
            assert!(all.contains(said), "{said}: {all}");
        }
    }
}
