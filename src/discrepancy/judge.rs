//! From evidence to probabilities: names, variants, odds and groups.

use std::collections::BTreeMap;
use std::f64::consts::LN_10;

use super::attribute::Attribution;
use super::diagnosis::{Judged, Told, Verdict};
use super::fit::Fit;
use super::locate::FreeForce;
use crate::change::{Candidate, Mechanism};
use crate::draws::{Summary, summarise};

/// What the user holds likely beforehand: odds by name, against 1 for every
/// name not in it; `none` against all the others together.
pub type Odds = BTreeMap<String, f64>;

/// ln of the mean of exp.
fn log_mean(logs: &[f64]) -> f64 {
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = logs.iter().map(|l| (l - top).exp()).sum();
    top + (sum / logs.len() as f64).ln()
}

/// Judges the model as it was, every mechanism and the free-form force; most
/// probable first.
pub(super) fn judge(
    found: &Attribution,
    catalogue: &[Box<dyn Mechanism>],
    forces: &[FreeForce],
    odds: &Odds,
) -> Vec<Judged> {
    let none = &found.none;
    let mut all = vec![Judged {
        name: "none".into(),
        kind: "none",
        log_evidence: none.log_evidence,
        se: none.se,
        says: "Nothing is missing: the model as it is.".into(),
        ..Judged::default()
    }];
    let mut names: Vec<&str> = Vec::new();
    for mechanism in catalogue {
        if !names.contains(&mechanism.name()) {
            names.push(mechanism.name());
        }
    }
    for name in names {
        all.push(judged(name, catalogue, &found.candidates));
    }
    all.push(unknown(forces, none));
    weigh(&mut all, odds);
    for one in &mut all {
        let gain = one.log_evidence - none.log_evidence;
        one.log10_bayes_factor = gain / LN_10;
    }
    all.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    all
}

/// One name, its variants averaged.
fn judged(
    name: &str,
    catalogue: &[Box<dyn Mechanism>],
    fits: &[Fit],
) -> Judged {
    let variants: Vec<(&dyn Candidate, &Fit)> = catalogue
        .iter()
        .zip(fits)
        .filter(|(m, _)| m.name() == name)
        .map(|(m, fit)| (m.as_ref() as &dyn Candidate, fit))
        .collect();
    let logs: Vec<f64> =
        variants.iter().map(|(_, fit)| fit.log_evidence).collect();
    let best = variants
        .iter()
        .max_by(|a, b| a.1.log_evidence.total_cmp(&b.1.log_evidence));
    let Some((mechanism, fit)) = best else { return Judged::default() };
    Judged {
        name: name.into(),
        kind: mechanism.family().name(),
        log_evidence: log_mean(&logs),
        se: fit.se,
        says: mechanism.says().into(),
        coordinate: mechanism.coordinate(),
        form: mechanism.form(),
        parameters: told(&summarise(&fit.draws)[..fit.added], Some(name)),
        variants: variants
            .iter()
            .map(|(m, fit)| (m.label(), fit.log_evidence))
            .collect(),
        ..Judged::default()
    }
}

fn unknown(forces: &[FreeForce], none: &Fit) -> Judged {
    let logs: Vec<f64> = forces
        .iter()
        .map(|force| none.log_evidence + force.log_bayes_factor)
        .collect();
    let best = forces
        .iter()
        .max_by(|a, b| a.log_bayes_factor.total_cmp(&b.log_bayes_factor));
    Judged {
        name: "unknown".into(),
        kind: "unknown",
        log_evidence: log_mean(&logs),
        se: none.se,
        says: "A force that none of the mechanisms describes acts on the \
               mass."
            .into(),
        coordinate: best.map(|force| force.axis),
        ..Judged::default()
    }
}

/// Half of the prior for `none`, half shared by the other names, times the
/// user's odds.
fn weigh(all: &mut [Judged], odds: &Odds) {
    let of = |name: &str| odds.get(name).copied().unwrap_or(1.0);
    let others: f64 =
        all.iter().filter(|m| m.name != "none").map(|m| of(&m.name)).sum();
    let logs: Vec<f64> = all
        .iter()
        .map(|m| {
            let prior = match m.name.as_str() {
                "none" => of("none"),
                name => of(name) / others,
            };
            prior.ln() + m.log_evidence
        })
        .collect();
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = logs.iter().map(|l| (l - top).exp()).sum();
    for (one, log) in all.iter_mut().zip(logs) {
        one.probability = (log - top).exp() / total;
    }
}

/// The kind with the largest summed probability.
pub(super) fn verdict(all: &[Judged]) -> Verdict {
    let kinds: [(&[&str], Verdict); 5] = [
        (&["none"], Verdict::Adequate),
        (&["physics"], Verdict::MissingPhysics),
        (&["measurement", "start"], Verdict::Measurement),
        (&["noise"], Verdict::Noise),
        (&["unknown"], Verdict::Unexplained),
    ];
    let mass = |kinds: &[&str]| -> f64 {
        let of = all.iter().filter(|m| kinds.contains(&m.kind));
        of.map(|m| m.probability).sum()
    };
    kinds
        .into_iter()
        .max_by(|a, b| mass(a.0).total_cmp(&mass(b.0)))
        .map_or(Verdict::Adequate, |(_, verdict)| verdict)
}

/// The names within 1 in log10 evidence of the best, at most three.
pub(super) fn group(all: &[Judged]) -> Vec<String> {
    let best = all
        .iter()
        .map(|m| m.log10_bayes_factor)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut near: Vec<&Judged> =
        all.iter().filter(|m| best - m.log10_bayes_factor < 1.0).collect();
    near.sort_by(|a, b| b.log10_bayes_factor.total_cmp(&a.log10_bayes_factor));
    near.into_iter().take(3).map(|m| m.name.clone()).collect()
}

/// Parameters in figures, without their mechanism's name before them.
pub(super) fn told(summaries: &[Summary], within: Option<&str>) -> Vec<Told> {
    summaries
        .iter()
        .map(|s| {
            let plain = within
                .and_then(|name| s.name.strip_prefix(name))
                .and_then(|rest| rest.strip_prefix('.'))
                .unwrap_or(&s.name);
            Told {
                name: plain.to_owned(),
                unit: s.unit.clone(),
                mean: s.mean,
                sd: s.sd,
                q05: s.q05,
                q50: s.q50,
                q95: s.q95,
            }
        })
        .collect()
}
