//! Mechanisms, places and figures in words.

use super::{Baseline, Diagnosis, Judged, Mismatch, Told};
use crate::physics::forces::Axis;
use crate::report::digits::{beside, short, significant};
use crate::report::text::{plain, unit};

/// Mechanisms whose words are the same whatever their size.
const NAMES: [(&str, &str); 18] = [
    ("none", "the model as it was"),
    ("unknown", "a force that no mechanism of the catalogue describes"),
    ("turbulent-drag", "drag that grows with the square of the speed"),
    ("viscous-drag", "drag in proportion to the speed"),
    ("cohesion", "a constant resistance"),
    ("velocity-weakening", "dry friction that falls with speed"),
    ("curvature", "the load of the bends on the friction"),
    ("entrainment", "entrainment of snow along a stretch"),
    ("initial-velocity", "a start that was already moving"),
    ("release-position", "a release at another place"),
    ("clock-offset", "a clock that is off"),
    ("velocity-scale", "a reading off by a constant factor"),
    ("sensor-drift", "a sensor that drifts"),
    ("averaging-window", "values that are means over a while"),
    ("slope-bias", "a track whose slope is off"),
    ("ar1", "errors correlated in time"),
    ("heavy-tails", "outliers among the errors"),
    ("unequal-variance", "errors of unequal size"),
];

/// A mechanism as a snow scientist would call it; the sign of its amplitude
/// and along what it acts go into the words.
pub(super) fn called(m: &Judged) -> String {
    if let Some((_, words)) = NAMES.iter().find(|n| n.0 == m.name) {
        return (*words).to_owned();
    }
    let amount = m.parameters.first().map_or(f64::NAN, |p| p.q50);
    let or = |more: &'static str, less: &'static str, open: &'static str| {
        match amount {
            x if x > 0.0 => more,
            x if x < 0.0 => less,
            _ => open,
        }
    };
    let time = m.coordinate == Some(Axis::Time);
    match m.name.as_str() {
        "friction-patch" => {
            format!("a patch of {} friction", or("higher", "lower", "other"))
        }
        "friction-step" => {
            let step =
                if time { "from a moment on" } else { "beyond a place" };
            let how = or("higher", "lower", "different");
            format!("friction that is {how} {step}")
        }
        "friction-hardening" => {
            let along = if time { "time" } else { "distance" };
            let how = or("rises", "falls", "changes");
            format!("friction that {how} steadily with {along}")
        }
        "surge" => {
            let what = or("a push", "a brake", "a force");
            format!("{what} that lasts a while")
        }
        other => format!("“{}”", plain(other)),
    }
}

/// The mechanism of that name, where it was weighed.
pub(super) fn judged<'a>(d: &'a Diagnosis, name: &str) -> Option<&'a Judged> {
    d.mechanisms.iter().find(|m| m.name == name)
}

/// What the names stand for, joined: “a patch of higher friction together
/// with a clock that is off”.
pub(super) fn all_called(
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
pub(super) fn joined(parts: &[String], last: &str) -> String {
    match parts {
        [init @ .., end] if !init.is_empty() => {
            format!("{} {last} {end}", init.join(", "))
        }
        _ => parts.concat(),
    }
}

/// With a capital letter.
pub(super) fn capital(words: &str) -> String {
    let mut chars = words.chars();
    let first = chars.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + chars.as_str()
}

/// The friction of a model, before “gives”.
pub(super) fn friction(b: &Baseline) -> String {
    match b.friction.trim() {
        "" | "none" => "gravity alone".to_owned(),
        law => format!("{} friction", capital(&plain(law))),
    }
}

/// The model as it was: “Voellmy friction with iid errors”.
pub(super) fn model(b: &Baseline) -> String {
    match b.noise.trim() {
        "" => friction(b),
        noise => format!("{} with {} errors", friction(b), plain(noise)),
    }
}

/// The event's name in quotes, and whether nature made it.
pub(super) fn event(d: &Diagnosis) -> String {
    let origin = if is_synthetic(d) { " (synthetic data)" } else { "" };
    match d.event.trim() {
        "" => format!("the recording{origin}"),
        name => format!("“{}”{origin}", plain(name)),
    }
}

/// Whether the recording was computed: it says so in its name.
pub(super) fn is_synthetic(d: &Diagnosis) -> bool {
    d.event.to_lowercase().contains("synthetic")
}

/// A figure with its unit.
pub(super) fn with_unit(number: &str, of: &str) -> String {
    match unit(of).as_str() {
        "" => number.to_owned(),
        unit => format!("{number} {unit}"),
    }
}

/// A probability: never 1 and never 0, since no evidence is that strong.
pub(super) fn probability(p: f64) -> String {
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
pub(super) fn log10(x: f64) -> String {
    match x {
        x if !x.is_finite() => significant(x, 2),
        x if x.abs() < 0.05 => "0.0".to_owned(),
        x => format!("{x:+.1}"),
    }
}

/// A parameter's median with its 90 % interval.
pub(super) fn interval(p: &Told) -> String {
    format!("{} to {}", beside(p.q05, p.sd), beside(p.q95, p.sd))
}

/// The parameter's own name, without that of its mechanism.
pub(super) fn own_name<'a>(p: &'a Told, mechanism: &str) -> &'a str {
    let rest = p.name.strip_prefix(mechanism);
    rest.and_then(|rest| rest.strip_prefix('.')).unwrap_or(&p.name)
}

/// A selected mechanism's parameters: those of the corrected model where it
/// has them, else those that the mechanism had alone.
pub(super) fn amounts<'a>(d: &'a Diagnosis, name: &str) -> Vec<&'a Told> {
    let joint: Vec<&Told> = d
        .parameters
        .iter()
        .filter(|p| own_name(p, name).len() < p.name.len())
        .collect();
    match judged(d, name) {
        Some(alone) if joint.is_empty() => alone.parameters.iter().collect(),
        _ => joint,
    }
}

/// The unit of an axis.
pub(super) fn axis_unit(axis: Axis) -> &'static str {
    match axis {
        Axis::Place => "m",
        Axis::Time => "s",
        Axis::Speed => "m/s",
    }
}

/// `132 to 187 m`, digits as the length of the stretch allows.
pub(super) fn range(from: f64, to: f64, unit: &str) -> String {
    let fine = (to - from).abs() < 10.0;
    let one = |x: f64| match x {
        x if !x.is_finite() => "n/a".to_owned(),
        x if fine => short((10.0 * x).round() / 10.0, 4),
        x => format!("{:.0}", x + 0.0),
    };
    format!("{} to {} {unit}", one(from), one(to))
}

/// `from 132 to 187 m (8.1 to 10.6 s)`.
pub(super) fn stretch(m: &Mismatch) -> String {
    let unit = axis_unit(m.axis);
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
