//! From evidence to probabilities: names, variants, odds and groups.

use std::collections::BTreeMap;
use std::f64::consts::LN_10;

use crate::diagnosis::evidence::attribute::Attribution;
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::findings::{Judged, ParameterSummary, Verdict};
use crate::diagnosis::hypothesis::{Hypothesis, NONE, UNKNOWN};
use crate::diagnosis::locate::{FreeForce, NOUN, SAYS};
use crate::draws::{log_sum_exp, summarise};
use crate::error::{Error, Result};
use crate::mechanism::{Candidate, Family, Mechanism, Noun};
use crate::physics::forces::Axis;

/// What the user holds likely beforehand: odds by name, against 1 for every
/// name not in it; `none` against all the others together.
pub type Odds = BTreeMap<String, f64>;

/// ln of the mean of exp.
fn log_mean(logs: &[f64]) -> f64 {
    log_sum_exp(logs.iter().copied()) - (logs.len() as f64).ln()
}

/// The names of a catalogue, each once.
fn names(catalogue: &[Box<dyn Mechanism>]) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for mechanism in catalogue {
        if !names.contains(&mechanism.name()) {
            names.push(mechanism.name());
        }
    }
    names
}

/// Refuses odds of what is not weighed.
pub(crate) fn check_odds(
    odds: &Odds,
    catalogue: &[Box<dyn Mechanism>],
) -> Result<()> {
    let known = [&[NONE, UNKNOWN], &names(catalogue)[..]].concat();
    match odds.keys().find(|name| !known.contains(&name.as_str())) {
        None => Ok(()),
        Some(name) => Err(Error::input(format!(
            "the odds of {name:?}: nothing of that name is weighed here; \
             expected one of {}: take one of them, or drop it",
            known.join(", ")
        ))),
    }
}

/// Judges the model as it was, every mechanism and the free-form force, where
/// it was inferred along any axis; most probable first.
pub fn judge(
    found: &Attribution,
    catalogue: &[Box<dyn Mechanism>],
    odds: &Odds,
) -> Vec<Judged> {
    let none = &found.none;
    let mut all = vec![Judged {
        name: NONE.into(),
        noun: Noun::one("the model as it was"),
        kind: Hypothesis::Baseline,
        log_evidence: none.log_evidence,
        se: none.se,
        says: "Nothing is missing: the model as it is.".into(),
        ..Judged::default()
    }];
    for name in names(catalogue) {
        all.push(judged(name, catalogue, &found.candidates));
    }
    if !found.forces.is_empty() {
        all.push(unknown(&found.forces, none));
    }
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
    let parameters: Vec<ParameterSummary> = summarise(&fit.draws)
        .iter()
        .take(fit.added)
        .map(|column| ParameterSummary::of(column).named_within(name))
        .collect();
    let amplitude = parameters.first().map_or(f64::NAN, |p| p.q50);
    Judged {
        name: name.into(),
        noun: mechanism.noun(amplitude),
        kind: Hypothesis::Mechanism(mechanism.family()),
        log_evidence: log_mean(&logs),
        se: fit.se,
        says: mechanism.says().into(),
        coordinate: mechanism.coordinate(),
        form: mechanism.form(),
        parameters,
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
        name: UNKNOWN.into(),
        noun: Noun::one(NOUN),
        kind: Hypothesis::Unknown,
        log_evidence: log_mean(&logs),
        se: best.map_or(none.se, |force| force.se.hypot(none.se)),
        says: SAYS.into(),
        coordinate: best.map(|force| force.axis),
        ..Judged::default()
    }
}

/// What is held likely before the recording is seen: half of it for `none`,
/// half shared by the other names, times the user's odds.
pub(crate) struct Beforehand<'a> {
    odds: &'a Odds,
    /// The odds of all names but `none`.
    others: f64,
}

impl<'a> Beforehand<'a> {
    pub(crate) fn of(all: &[Judged], odds: &'a Odds) -> Self {
        Self::among(all.iter().map(|m| m.name.as_str()), odds)
    }

    fn among<'n>(
        names: impl Iterator<Item = &'n str>,
        odds: &'a Odds,
    ) -> Self {
        let mut beforehand = Self { odds, others: 0.0 };
        let others = names.filter(|name| *name != NONE);
        beforehand.others = others.map(|name| beforehand.odds_of(name)).sum();
        beforehand
    }

    fn odds_of(&self, name: &str) -> f64 {
        self.odds.get(name).copied().unwrap_or(1.0)
    }

    /// ln of the prior probability of a name, up to a constant.
    fn log(&self, name: &str) -> f64 {
        match name {
            NONE => self.odds_of(NONE).ln(),
            name => (self.odds_of(name) / self.others).ln(),
        }
    }

    /// In ln, by how much less likely a term is than its absence.
    pub(crate) fn price(&self, name: &str) -> f64 {
        self.log(NONE) - self.log(name)
    }
}

/// The probability of each name before the recording is seen: that of the
/// model as it was, then those of a catalogue's names, each once.
pub fn prior_probabilities(
    catalogue: &[Box<dyn Mechanism>],
    odds: &Odds,
) -> Vec<(String, f64)> {
    let all = [&[NONE], &names(catalogue)[..]].concat();
    let beforehand = Beforehand::among(all.iter().copied(), odds);
    let logs: Vec<f64> = all.iter().map(|name| beforehand.log(name)).collect();
    let total = log_sum_exp(logs.iter().copied());
    all.into_iter()
        .zip(logs)
        .map(|(name, log)| (name.to_owned(), (log - total).exp()))
        .collect()
}

fn weigh(all: &mut [Judged], odds: &Odds) {
    let beforehand = Beforehand::of(all, odds);
    let logs: Vec<f64> =
        all.iter().map(|m| beforehand.log(&m.name) + m.log_evidence).collect();
    let total = log_sum_exp(logs.iter().copied());
    for (one, log) in all.iter_mut().zip(logs) {
        one.probability = (log - total).exp();
    }
}

/// The verdict that a hypothesis stands for.
fn verdict_of(kind: Hypothesis) -> Verdict {
    match kind {
        Hypothesis::Baseline => Verdict::Adequate,
        Hypothesis::Unknown => Verdict::Unexplained,
        Hypothesis::Mechanism(family) => match family {
            Family::Physics => Verdict::MissingPhysics,
            Family::Start | Family::Measurement => Verdict::Measurement,
            Family::Errors => Verdict::Errors,
        },
    }
}

/// The verdict with the largest summed probability.
pub(crate) fn verdict(all: &[Judged]) -> Verdict {
    let verdicts = [
        Verdict::Adequate,
        Verdict::MissingPhysics,
        Verdict::Measurement,
        Verdict::Errors,
        Verdict::Unexplained,
    ];
    let mass = |verdict: &Verdict| -> f64 {
        let of = all.iter().filter(|m| verdict_of(m.kind) == *verdict);
        of.map(|m| m.probability).sum()
    };
    let most = |a: &Verdict, b: &Verdict| mass(a).total_cmp(&mass(b));
    verdicts.into_iter().max_by(most).unwrap_or_default()
}

/// The names within 1 in log10 evidence of the best, at most three.
pub(crate) fn group(all: &[Judged]) -> Vec<String> {
    let best = all
        .iter()
        .map(|m| m.log10_bayes_factor)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut near: Vec<&Judged> =
        all.iter().filter(|m| best - m.log10_bayes_factor < 1.0).collect();
    near.sort_by(|a, b| b.log10_bayes_factor.total_cmp(&a.log10_bayes_factor));
    near.into_iter().take(3).map(|m| m.name.clone()).collect()
}

/// The recording that would tell the members of a group apart.
pub(crate) fn separating(
    group: &[String],
    judged: &[Judged],
) -> Option<String> {
    if group.len() < 2 {
        return None;
    }
    let of = |name: &String| judged.iter().find(|m| m.name == *name);
    let members: Vec<&Judged> = group.iter().filter_map(of).collect();
    let has = |verdict: Verdict| {
        members.iter().any(|m| verdict_of(m.kind) == verdict)
    };
    let along =
        |axis: Axis| members.iter().any(|m| m.coordinate == Some(axis));
    Some(if has(Verdict::Measurement) {
        "A second recording with another sensor, or of a mass released at a \
         known place and moment, would tell them apart."
            .into()
    } else if along(Axis::Time) && along(Axis::Place) {
        "A recording from another start would tell them apart: what belongs \
         to a place stays there, what belongs to a moment moves along."
            .into()
    } else if has(Verdict::Errors) {
        "A longer recording, or a second sensor on the same mass, would tell \
         them apart."
            .into()
    } else {
        "A recording at other speeds over the same ground, from a higher \
         start or on another slope, would tell them apart."
            .into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_further_term_costs_what_the_odds_say() {
        let names = ["none", "surge", "cohesion", "clock-offset", "unknown"];
        let named =
            |name: &str| Judged { name: name.into(), ..Judged::default() };
        let all = names.map(named);
        let even = Odds::new();
        let price = Beforehand::of(&all, &even).price("surge");
        assert!((price - 4.0_f64.ln()).abs() < 1e-12, "{price}");
        // Three times as likely as each of three others, which are half as
        // likely together as nothing.
        let odds = Odds::from([("surge".into(), 3.0), ("none".into(), 2.0)]);
        let price = Beforehand::of(&all, &odds).price("surge");
        assert!((price - (2.0 * 6.0 / 3.0_f64).ln()).abs() < 1e-12, "{price}");
    }
}
