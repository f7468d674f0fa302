//! Mechanisms, places and figures in words.

use crate::diagnosis::{
    Baseline, Diagnosis, Hypothesis, Judged, JudgedNoise, Mismatch,
    ParameterSummary, Verdict,
};
use crate::physics::forces::Axis;
use crate::report::NoiseRow;
use crate::report::digits::{beside, short, significant};
use crate::report::text::{self, is_synthetic, plain, unit};

/// Whether there is a corrected model to compare with: something was added to
/// it, or its errors are taken for others.
pub(crate) fn is_corrected(d: &Diagnosis) -> bool {
    let errors = d.verdict == Verdict::Errors && d.withheld.is_none();
    errors || !d.selected.is_empty()
}

/// The probability that nothing is missing, where it was weighed.
pub(crate) fn of_baseline(d: &Diagnosis) -> Option<f64> {
    let baseline = |m: &&Judged| m.kind == Hypothesis::Baseline;
    d.mechanisms.iter().find(baseline).map(|m| m.probability)
}

/// Whether nothing in particular explains a recording better than the model
/// does, although it is more likely that something is missing than nothing.
pub(crate) fn is_unsure(d: &Diagnosis) -> bool {
    matches!(d.verdict, Verdict::Adequate | Verdict::Errors)
        && of_baseline(d).is_some_and(|p| p < 0.5)
}

/// A mechanism as a snow scientist would call it.
pub(crate) fn called(m: &Judged) -> String {
    plain(&m.noun.words)
}

/// The mechanism of that name, where it was weighed.
pub(crate) fn judged<'a>(d: &'a Diagnosis, name: &str) -> Option<&'a Judged> {
    d.mechanisms.iter().find(|m| m.name == name)
}

/// What the names stand for, joined: “a patch of higher friction together
/// with a clock that is off”.
pub(crate) fn all_called(
    d: &Diagnosis,
    names: &[String],
    last: &str,
) -> String {
    let word = |name: &String| {
        judged(d, name).map_or_else(|| format!("“{}”", plain(name)), called)
    };
    joined(&names.iter().map(word).collect::<Vec<_>>(), last)
}

/// `a, b and c`, with another word for `and`.
pub(crate) fn joined(parts: &[String], last: &str) -> String {
    match parts {
        [init @ .., end] if !init.is_empty() => {
            format!("{} {last} {end}", init.join(", "))
        }
        _ => parts.concat(),
    }
}

/// The friction of a model, before “gives”.
pub(crate) fn friction(b: &Baseline) -> String {
    let law = match b.friction.trim() {
        "" | "none" => "gravity alone".to_owned(),
        law => format!("{} friction", text::law(law)),
    };
    b.mechanisms.iter().fold(law, |law, had| law + " plus " + &plain(had))
}

/// The model as it was: “Voellmy friction with iid errors”.
pub(crate) fn model(b: &Baseline) -> String {
    match b.noise.trim() {
        "" => friction(b),
        _ if b.infers_noise => format!("{} with inferred errors", friction(b)),
        noise => format!("{} with {} errors", friction(b), plain(noise)),
    }
}

/// The event's name in quotes, and whether nature made it.
pub(crate) fn event(d: &Diagnosis) -> String {
    let origin = if is_synthetic(&d.event) { " (synthetic data)" } else { "" };
    match d.event.trim() {
        "" => format!("the recording{origin}"),
        name => format!("“{}”{origin}", plain(name)),
    }
}

/// The unit of the recording.
pub(crate) fn recorded_in(d: &Diagnosis) -> &str {
    d.pictured.first().map_or("", |p| p.unit.as_str())
}

/// A figure with its unit.
pub(crate) fn with_unit(number: &str, of: &str) -> String {
    match unit(of).as_str() {
        "" => number.to_owned(),
        unit => format!("{number} {unit}"),
    }
}

/// A probability: never 1 and never 0, since no evidence is that strong.
pub(crate) fn probability(p: f64) -> String {
    match p {
        p if p > 0.999 => "> 0.999".to_owned(),
        p if p > 0.99 => format!("{p:.3}"),
        p if p >= 0.01 => format!("{p:.2}"),
        p if p >= 0.001 => format!("{p:.3}"),
        p if p >= 0.0 => "< 0.001".to_owned(),
        _ => significant(p, 2),
    }
}

/// log10 of a Bayes factor, with the sign that tells for or against.
pub(crate) fn log10(x: f64) -> String {
    match x {
        x if !x.is_finite() => significant(x, 2),
        x if x.abs() < 0.05 => "0.0".to_owned(),
        x => format!("{x:+.1}"),
    }
}

/// A noise as tables have it.
pub(crate) fn noise_row(n: &JudgedNoise) -> NoiseRow {
    NoiseRow {
        name: n.name.clone(),
        probability: probability(n.probability),
        factor: log10(n.log10_bayes_factor),
    }
}

/// A parameter's median with its 90 % interval.
pub(crate) fn interval(p: &ParameterSummary) -> String {
    format!("{} to {}", beside(p.q05, p.sd), beside(p.q95, p.sd))
}

/// The parameter's own name, without that of its mechanism.
pub(crate) fn own_name<'a>(
    p: &'a ParameterSummary,
    mechanism: &str,
) -> &'a str {
    p.within(mechanism).unwrap_or(&p.name)
}

/// A selected mechanism's parameters: those of the corrected model where it
/// has them, else those that the mechanism had alone.
pub(crate) fn amounts<'a>(
    d: &'a Diagnosis,
    name: &str,
) -> Vec<&'a ParameterSummary> {
    let joint: Vec<&ParameterSummary> =
        d.parameters.iter().filter(|p| p.within(name).is_some()).collect();
    match judged(d, name) {
        Some(alone) if joint.is_empty() => alone.parameters.iter().collect(),
        _ => joint,
    }
}

/// `132 to 187 m`, digits as the length of the stretch allows.
pub(crate) fn range(from: f64, to: f64, unit: &str) -> String {
    let fine = (to - from).abs() < 10.0;
    let one = |x: f64| match x {
        x if !x.is_finite() => "n/a".to_owned(),
        x if fine => short((10.0 * x).round() / 10.0, 4),
        x => format!("{:.0}", x + 0.0),
    };
    format!("{} to {} {unit}", one(from), one(to))
}

/// `from 132 to 187 m (8.1 to 10.6 s)`.
pub(crate) fn stretch(m: &Mismatch) -> String {
    let unit = m.axis.unit();
    let main = range(m.from, m.to, unit);
    let known = |a: f64, b: f64| a.is_finite() && b.is_finite();
    let mut beside = Vec::new();
    if m.axis != Axis::Place && known(m.place_from, m.place_to) {
        beside.push(range(m.place_from, m.place_to, "m"));
    }
    if m.axis != Axis::Time && known(m.time_from, m.time_to) {
        beside.push(range(m.time_from, m.time_to, "s"));
    }
    let beside = match beside.join(", ") {
        none if none.is_empty() => none,
        some => format!(" ({some})"),
    };
    let at = if m.axis == Axis::Speed { "at speeds from" } else { "from" };
    format!("{at} {main}{beside}")
}
