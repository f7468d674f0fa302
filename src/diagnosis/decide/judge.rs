//! From evidence to probabilities: names, variants, odds and groups.

use std::collections::BTreeMap;
use std::f64::consts::LN_10;

use crate::diagnosis::evidence::attribute::Attribution;
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::evidence::table::Row;
use crate::diagnosis::findings::{Judged, ParameterSummary, Variant, Verdict};
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

/// What the evidence says under one noise.
#[derive(Debug, Clone)]
pub(crate) struct Seen<'a> {
    none: &'a Fit,
    /// ln of the evidence of each mechanism.
    candidates: Vec<f64>,
    /// The same of a force of free form, where it was weighed.
    open: Option<f64>,
    /// All fits, where they were made.
    found: Option<&'a Attribution>,
}

impl<'a> Seen<'a> {
    pub(crate) fn of(row: &'a Row<'_>) -> Self {
        Self {
            none: &row.noisy.none,
            candidates: row.candidates.clone(),
            open: Some(row.open),
            found: row.found.as_ref(),
        }
    }

    fn alone(found: &'a Attribution) -> Self {
        let logs = found.candidates.iter().map(|fit| fit.log_evidence);
        Self {
            none: &found.none,
            candidates: logs.collect(),
            open: (!found.forces.is_empty()).then(|| found.open_log()),
            found: Some(found),
        }
    }

    /// ln of the evidence of each hypothesis, variants averaged, by its name.
    fn logs(
        &self,
        catalogue: &[Box<dyn Mechanism>],
    ) -> Vec<(&'static str, f64)> {
        let mut all = vec![(NONE, self.none.log_evidence)];
        for name in names(catalogue) {
            let own = catalogue.iter().zip(&self.candidates);
            let own = own.filter(|(m, _)| m.name() == name);
            let logs: Vec<f64> = own.map(|(_, log)| *log).collect();
            all.push((name, log_mean(&logs)));
        }
        all.extend(self.open.map(|log| (UNKNOWN, log)));
        all
    }
}

/// Judges the model as it was, every mechanism and the free-form force, where
/// it was inferred along any axis; most probable first.
pub fn judge(
    found: &Attribution,
    catalogue: &[Box<dyn Mechanism>],
    odds: &Odds,
) -> Vec<Judged> {
    judge_all(&[Seen::alone(found)], catalogue, odds)
}

/// The same averaged over noises that are even beforehand.
pub(crate) fn judge_all(
    rows: &[Seen<'_>],
    catalogue: &[Box<dyn Mechanism>],
    odds: &Odds,
) -> Vec<Judged> {
    let mut all = vec![none(rows)];
    for name in names(catalogue) {
        all.push(judged(name, catalogue, rows));
    }
    all.extend(unknown(rows));
    weigh(&mut all, odds);
    let before = all[0].log_evidence;
    for one in &mut all {
        one.log10_bayes_factor = (one.log_evidence - before) / LN_10;
    }
    all.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    all
}

/// ln of the probability of each noise and the recordings, up to a constant:
/// summed over what may be missing, noises being even beforehand.
pub(crate) fn log_of_noises(
    rows: &[Seen<'_>],
    catalogue: &[Box<dyn Mechanism>],
    odds: &Odds,
) -> Vec<f64> {
    let of = |row: &Seen<'_>| {
        let logs = row.logs(catalogue);
        let names = logs.iter().map(|(name, _)| *name);
        let beforehand = Beforehand::among(names, odds);
        let each = logs.iter().map(|(name, log)| beforehand.log(name) + log);
        log_sum_exp(each)
    };
    rows.iter().map(of).collect()
}

fn none(rows: &[Seen<'_>]) -> Judged {
    let fits: Vec<&Fit> = rows.iter().map(|row| row.none).collect();
    let logs: Vec<f64> = fits.iter().map(|fit| fit.log_evidence).collect();
    Judged {
        name: NONE.into(),
        noun: Noun::one("the model as it was"),
        kind: Hypothesis::Baseline,
        log_evidence: log_mean(&logs),
        se: most(&fits).map_or(f64::NAN, |fit| fit.se),
        says: "Nothing is missing: the model as it is.".into(),
        ..Judged::default()
    }
}

/// The fit with the most evidence.
fn most<'f>(fits: &[&'f Fit]) -> Option<&'f Fit> {
    let more =
        |a: &&&Fit, b: &&&Fit| a.log_evidence.total_cmp(&b.log_evidence);
    fits.iter().max_by(more).copied()
}

/// One name, its variants and the noises averaged.
fn judged(
    name: &str,
    catalogue: &[Box<dyn Mechanism>],
    rows: &[Seen<'_>],
) -> Judged {
    let fits = |i: usize| -> Vec<&Fit> {
        let found = rows.iter().filter_map(|row| row.found);
        found.map(|found| &found.candidates[i]).collect()
    };
    let mut best: Option<(&dyn Candidate, &Fit)> = None;
    for (i, mechanism) in catalogue.iter().enumerate() {
        if mechanism.name() != name {
            continue;
        }
        let Some(fit) = most(&fits(i)) else { continue };
        if best.is_none_or(|(_, b)| fit.log_evidence > b.log_evidence) {
            best = Some((mechanism.as_ref(), fit));
        }
    }
    let Some((mechanism, fit)) = best else { return Judged::default() };
    let variants = variants(name, catalogue, rows);
    let logs: Vec<f64> = variants.iter().map(|v| v.log_evidence).collect();
    let parameters: Vec<ParameterSummary> = summarise(&fit.draws)
        .iter()
        .take(fit.added)
        .map(|column| ParameterSummary::of(column).named_within(name))
        .collect();
    let amplitude = parameters.first().map_or(f64::NAN, |p| p.signed());
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
        variants,
        ..Judged::default()
    }
}

/// The variants of a name, the noises averaged.
fn variants(
    name: &str,
    catalogue: &[Box<dyn Mechanism>],
    rows: &[Seen<'_>],
) -> Vec<Variant> {
    let all = catalogue.iter().enumerate();
    let own = all.filter(|(_, mechanism)| mechanism.name() == name);
    own.map(|(i, mechanism)| {
        let logs: Vec<f64> =
            rows.iter().map(|row| row.candidates[i]).collect();
        Variant {
            label: mechanism.label(),
            coordinate: mechanism.coordinate(),
            log_evidence: log_mean(&logs),
        }
    })
    .collect()
}

fn unknown(rows: &[Seen<'_>]) -> Option<Judged> {
    let logs: Vec<f64> =
        rows.iter().map(|row| row.open).collect::<Option<_>>()?;
    let found = rows.iter().filter_map(|row| row.found);
    let forces = found.flat_map(|found| {
        found.forces.iter().map(|force| (force, found.none.se))
    });
    let more = |a: &(&FreeForce, f64), b: &(&FreeForce, f64)| {
        a.0.log_bayes_factor.total_cmp(&b.0.log_bayes_factor)
    };
    let best = forces.max_by(more);
    Some(Judged {
        name: UNKNOWN.into(),
        noun: Noun::one(NOUN),
        kind: Hypothesis::Unknown,
        log_evidence: log_mean(&logs),
        se: best.map_or(f64::NAN, |(force, none)| force.se.hypot(none)),
        says: SAYS.into(),
        coordinate: best.map(|(force, _)| force.axis),
        ..Judged::default()
    })
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
        Hypothesis::Mechanism(family) => verdict_of_family(family),
    }
}

/// The verdict that a mechanism of a family stands for.
pub(crate) fn verdict_of_family(family: Family) -> Verdict {
    match family {
        Family::Physics => Verdict::MissingPhysics,
        Family::Start | Family::Measurement => Verdict::Measurement,
    }
}

/// The verdict on everything that was weighed, most probable first: nothing is
/// missing where the model as it is comes first, and otherwise what the kind
/// with the largest summed probability stands for.
pub(crate) fn verdict(all: &[Judged]) -> Verdict {
    if all.first().is_none_or(|m| m.kind == Hypothesis::Baseline) {
        return Verdict::Adequate;
    }
    let verdicts =
        [Verdict::MissingPhysics, Verdict::Measurement, Verdict::Unexplained];
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

/// The recording that would tell most beside this one: what tells the members
/// of a group apart or, of one member, whether it is that.
pub(crate) fn next_recording(
    verdict: Verdict,
    group: &[String],
    judged: &[Judged],
) -> Option<String> {
    if group.len() > 1 {
        return Some(separating(group, judged));
    }
    let words = match verdict {
        Verdict::Adequate => return None,
        Verdict::MissingPhysics => {
            "A recording from another start over the same ground would show \
             whether it holds there too."
        }
        Verdict::Unexplained => {
            "A recording from another start over the same ground would show \
             whether that force belongs to a place, a moment or a speed."
        }
        Verdict::Measurement => {
            "A second recording with another sensor, or of a mass released \
             at a known place and moment, would show whether it is that."
        }
        Verdict::Errors => {
            "A second recording by the same sensor would show whether its \
             errors are always such ones."
        }
    };
    Some(words.to_owned())
}

/// The recording that would tell the members of a group apart.
fn separating(group: &[String], judged: &[Judged]) -> String {
    let of = |name: &String| judged.iter().find(|m| m.name == *name);
    let members: Vec<&Judged> = group.iter().filter_map(of).collect();
    let has = |verdict: Verdict| {
        members.iter().any(|m| verdict_of(m.kind) == verdict)
    };
    let along =
        |axis: Axis| members.iter().any(|m| m.coordinate == Some(axis));
    let words = if has(Verdict::Measurement) {
        "A second recording with another sensor, or of a mass released at a \
         known place and moment, would tell them apart."
    } else if along(Axis::Time) && along(Axis::Place) {
        "A recording from another start would tell them apart: what belongs \
         to a place stays there, what belongs to a moment moves along."
    } else {
        "A recording at other speeds over the same ground, from a higher \
         start or on another slope, would tell them apart."
    };
    words.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_verdict_but_adequate_says_what_to_record_next() {
        let judged = Judged { name: "surge".into(), ..Judged::default() };
        let next = |verdict, group: &[&str]| {
            let group: Vec<String> =
                group.iter().map(|&name| name.into()).collect();
            next_recording(verdict, &group, std::slice::from_ref(&judged))
        };
        assert_eq!(next(Verdict::Adequate, &["none"]), None);
        for verdict in [
            Verdict::MissingPhysics,
            Verdict::Unexplained,
            Verdict::Measurement,
            Verdict::Errors,
        ] {
            let alone = next(verdict, &["surge"]).unwrap();
            assert!(alone.contains("would show whether"), "{alone}");
            let two = next(verdict, &["surge", "cohesion"]).unwrap();
            assert!(two.contains("tell them apart"), "{two}");
        }
    }

    #[test]
    fn the_model_as_it_is_has_to_be_beaten_by_a_single_hypothesis() {
        let physics = Hypothesis::Mechanism(Family::Physics);
        let sensor = Hypothesis::Mechanism(Family::Measurement);
        let start = Hypothesis::Mechanism(Family::Start);
        let of =
            |all: &[(Hypothesis, f64)]| {
                let judged = |&(kind, probability): &(Hypothesis, f64)| {
                    Judged { kind, probability, ..Judged::default() }
                };
                verdict(&all.iter().map(judged).collect::<Vec<_>>())
            };
        let baseline = Hypothesis::Baseline;
        let all = [(baseline, 0.3), (physics, 0.28), (physics, 0.26)];
        assert_eq!(of(&all), Verdict::Adequate);
        let all = [(physics, 0.3), (baseline, 0.28), (sensor, 0.1)];
        assert_eq!(of(&all), Verdict::MissingPhysics);
        // The start counts with the measurement.
        let all = [(physics, 0.3), (sensor, 0.2), (start, 0.2)];
        assert_eq!(of(&all), Verdict::Measurement);
        let all = [(Hypothesis::Unknown, 0.5), (physics, 0.3)];
        assert_eq!(of(&all), Verdict::Unexplained);
    }

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
