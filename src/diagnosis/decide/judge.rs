//! From evidence to probabilities: names, variants and groups.

use std::f64::consts::LN_10;

use super::odds::{Beforehand, Odds, names};
use crate::diagnosis::evidence::attribute::Attribution;
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::evidence::table::Row;
use crate::diagnosis::findings::{Judged, ParameterSummary, Variant, Verdict};
use crate::diagnosis::hypothesis::{Hypothesis, NONE, UNKNOWN};
use crate::diagnosis::locate::{FreeForce, NOUN, SAYS};
use crate::draws::{log_sum_exp, shares, summarise};
use crate::mechanism::{Candidate, Family, Mechanism, Noun};

/// ln of the mean of exp.
fn log_mean(logs: &[f64]) -> f64 {
    log_sum_exp(logs.iter().copied()) - (logs.len() as f64).ln()
}

/// The same over noises, each as likely as it is beforehand.
fn over_noises(rows: &[Seen<'_>], log: impl Fn(&Seen<'_>) -> f64) -> f64 {
    let all = rows.iter().map(|row| row.beforehand + log(row));
    log_sum_exp(all) - log_sum_exp(rows.iter().map(|row| row.beforehand))
}

/// What the evidence says under one noise.
#[derive(Debug, Clone)]
pub(crate) struct Seen<'a> {
    /// ln of the probability of the noise beforehand, up to a constant.
    beforehand: f64,
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
            beforehand: row.noisy.beforehand(),
            none: &row.noisy.none,
            candidates: row.candidates.clone(),
            open: Some(row.open),
            found: row.found.as_ref(),
        }
    }

    fn alone(found: &'a Attribution) -> Self {
        let logs = found.candidates.iter().map(|fit| fit.log_evidence);
        Self {
            beforehand: 0.0,
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

/// The same averaged over noises.
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
/// summed over what may be missing.
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
        row.beforehand + log_sum_exp(each)
    };
    rows.iter().map(of).collect()
}

fn none(rows: &[Seen<'_>]) -> Judged {
    let fits: Vec<&Fit> = rows.iter().map(|row| row.none).collect();
    Judged {
        name: NONE.into(),
        noun: Noun::one("the model as it was"),
        kind: Hypothesis::Baseline,
        log_evidence: over_noises(rows, |row| row.none.log_evidence),
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
    own.map(|(i, mechanism)| Variant {
        label: mechanism.label(),
        coordinate: mechanism.coordinate(),
        log_evidence: over_noises(rows, |row| row.candidates[i]),
    })
    .collect()
}

fn unknown(rows: &[Seen<'_>]) -> Option<Judged> {
    if rows.iter().any(|row| row.open.is_none()) {
        return None;
    }
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
        log_evidence: over_noises(rows, |row| {
            row.open.unwrap_or(f64::NEG_INFINITY)
        }),
        se: best.map_or(f64::NAN, |(force, none)| force.se.hypot(none)),
        says: SAYS.into(),
        coordinate: best.map(|(force, _)| force.axis),
        ..Judged::default()
    })
}

fn weigh(all: &mut [Judged], odds: &Odds) {
    let beforehand = Beforehand::of(all, odds);
    let log = |m: &Judged| beforehand.log(&m.name) + m.log_evidence;
    let shares = shares(all.iter().map(log));
    for (one, share) in all.iter_mut().zip(shares) {
        one.probability = share;
    }
}

/// The verdict that a hypothesis stands for.
pub(crate) fn verdict_of(kind: Hypothesis) -> Verdict {
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
