//! How well hidden effects were found.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::case::{Coordinate, Interval, Truth};
use super::effects::{CATALOGUE, Class};
use super::scatter::Scatter;
use crate::draws;

/// The word for nothing hidden, and the verdict that says so.
pub(super) const NONE: &str = "none";
const ADEQUATE: &str = "adequate";
/// The verdict that the errors are not as the event's file says.
const ERRORS: &str = "noise";
/// The name of what the catalogue does not explain.
pub(super) const UNKNOWN: &str = "unknown";
/// Effects that one recording hardly tells from a moved clock or another mu:
/// being in the group is all that is asked of them.
const BY_GROUP: [&str; 2] = ["slope-bias", "averaging-window"];
/// How much of the noise a good fit may leave.
const WITHIN: f64 = 1.15;
/// What the likelihood has to gain before an effect can come first: ln 20 for
/// the prior odds of a name against `none`, and 5 for its parameters, which a
/// diagnosis does not know beforehand.
const VISIBLE: f64 = 8.0;
/// What rounding may add to an error, as a share of it.
const ROUNDING: f64 = 1e-9;
/// How many bins calibration is measured in.
const BINS: usize = 5;

/// What a diagnosis answered, in the words of `diagnosis.json`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// `adequate`, `missing-physics`, `measurement`, `noise` or
    /// `unexplained`.
    pub verdict: String,
    /// Every candidate with its posterior probability.
    pub probabilities: Vec<(String, f64)>,
    /// The names that the recording cannot tell apart.
    pub group: Vec<String>,
    /// The noises that may have made the errors, most probable first, each
    /// with its probability.
    pub noises: Vec<(String, f64)>,
    /// Where simulation and recording differ.
    pub mismatch: Vec<Interval>,
    /// Root mean square error of the baseline \[m/s\].
    pub rmse_before: f64,
    /// The same with what was found \[m/s\].
    pub rmse_after: f64,
    /// The least error that the baseline's motion can have \[m/s\]; NaN where
    /// unknown.
    pub least_squares_before: f64,
    /// The same with what was found \[m/s\].
    pub least_squares_after: f64,
    /// The same on the stretch that was held out \[m/s\]; NaN where unknown.
    pub heldout_rmse_after: f64,
    /// Wall-clock time \[s\].
    pub seconds: f64,
}

impl Answer {
    /// The most probable name with its probability; no name and 0 where there
    /// are none.
    pub fn top(&self) -> (&str, f64) {
        let most =
            |a: &&(String, f64), b: &&(String, f64)| a.1.total_cmp(&b.1);
        let top = self.probabilities.iter().max_by(most);
        top.map_or(("", 0.0), |(name, p)| (name.as_str(), *p))
    }

    /// The noises that the recording cannot tell from the most probable.
    fn near_noises(&self) -> impl Iterator<Item = &str> {
        let best = self.noises.first().map_or(0.0, |(_, p)| *p);
        let near = self.noises.iter().filter(move |(_, p)| *p >= 0.1 * best);
        near.map(|(name, _)| name.as_str())
    }
}

/// A case with its answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The case's name.
    pub case: String,
    /// What was hidden.
    pub truth: Truth,
    /// What was answered.
    pub answer: Answer,
}

impl Outcome {
    /// Whether the truth is the most probable name; of the errors, whether the
    /// most probable noise is like it.
    pub fn first(&self) -> bool {
        match self.truth.class {
            Class::Errors => self.names_errors(),
            _ => self.answer.top().0 == self.truth.effect,
        }
    }

    /// Whether the truth has the most evidence, whatever the prior odds: the
    /// group begins with it.
    pub fn leads(&self) -> bool {
        if self.truth.class == Class::Errors {
            return self.first();
        }
        self.answer.group.first().is_some_and(|n| n == self.truth.effect)
    }

    /// Whether the truth is in the group, or like a noise that is nearly as
    /// probable as the first.
    pub fn in_group(&self) -> bool {
        if self.truth.class == Class::Errors {
            let mut near = self.answer.near_noises();
            return near.any(|noise| self.truth.scatter.is_named_by(noise));
        }
        self.answer.group.iter().any(|name| name == self.truth.effect)
    }

    /// Whether anything was found. Where the errors are not as the event's
    /// file says and that is not what is hidden, to say so is right, and
    /// finds nothing.
    pub fn detected(&self) -> bool {
        let beside = self.truth.class != Class::Errors
            && self.truth.scatter != Scatter::Independent;
        match self.answer.verdict.as_str() {
            ADEQUATE => false,
            ERRORS => !beside,
            _ => true,
        }
    }

    /// Whether the most probable noise is of the errors' kind.
    pub fn names_errors(&self) -> bool {
        let first = self.answer.noises.first();
        first.is_some_and(|(noise, _)| self.truth.scatter.is_named_by(noise))
    }

    /// Whether the posterior mean prediction got worse.
    pub fn worse(&self) -> bool {
        is_worse(self.answer.rmse_before, self.answer.rmse_after)
    }

    /// By what share of itself the error of that prediction grew.
    fn growth(&self) -> f64 {
        self.answer.rmse_after / self.answer.rmse_before - 1.0
    }

    /// Whether the least error of the motion did.
    pub fn worse_at_best(&self) -> bool {
        let Answer { least_squares_before, least_squares_after, .. } =
            self.answer;
        is_worse(least_squares_before, least_squares_after)
    }

    /// Whether the recording shows enough of the effect for it to come first.
    pub fn visible(&self) -> bool {
        self.truth.gain >= VISIBLE
    }

    /// Whether the fit leaves hardly more than the noise.
    pub fn within_noise(&self) -> bool {
        self.answer.rmse_after <= WITHIN * self.truth.noise_rms
    }

    /// Intersection over union of the located and the true stretch; nothing
    /// where the truth has none.
    pub fn overlap(&self) -> Option<f64> {
        let truth = self.truth.interval?;
        Some(overlap(&truth, &self.answer.mismatch))
    }

    /// Whether first place was asked for, and missed.
    fn failed(&self) -> bool {
        match self.truth.class {
            Class::None => self.detected(),
            Class::Outside => !self.fair(),
            _ if asks_group(&self.truth) => !self.in_group(),
            _ => !self.first(),
        }
    }

    /// For an effect that no catalogue has: called unknown, or explained down
    /// to the noise, on the held-out stretch too where that is known.
    fn fair(&self) -> bool {
        let held = self.answer.heldout_rmse_after;
        let holds = held.is_nan() || held <= 1.5 * self.truth.noise_rms;
        self.answer.top().0 == UNKNOWN || (self.within_noise() && holds)
    }
}

/// By what share of itself an error grew at the most, where it did.
fn most_worse(outcomes: &[Outcome]) -> f64 {
    let worse = outcomes.iter().filter(|outcome| outcome.worse());
    worse.map(Outcome::growth).fold(0.0, f64::max)
}

fn is_worse(before: f64, after: f64) -> bool {
    after > before * (1.0 + ROUNDING)
}

fn asks_group(truth: &Truth) -> bool {
    BY_GROUP.contains(&truth.effect)
}

/// Over places where both have them, over times otherwise.
fn overlap(truth: &Interval, located: &[Interval]) -> f64 {
    let place = |i: &Interval| i.coordinate == Coordinate::Arclength;
    let in_place = place(truth) && located.iter().all(place);
    let ends = |i: &Interval| {
        if in_place { (i.from, i.to) } else { (i.time_from, i.time_to) }
    };
    let found = merged(located.iter().map(ends).collect());
    let (from, to) = ends(truth);
    let length = |(a, b): (f64, f64)| (b - a).max(0.0);
    let common: f64 =
        found.iter().map(|f| length((f.0.max(from), f.1.min(to)))).sum();
    let all: f64 = found.iter().map(|f| length(*f)).sum();
    let union = all + length((from, to)) - common;
    if union > 0.0 { common / union } else { 0.0 }
}

/// The union of intervals, as intervals that do not touch.
fn merged(mut all: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut out: Vec<(f64, f64)> = Vec::new();
    for next in all {
        match out.last_mut() {
            Some(last) if next.0 <= last.1 => last.1 = last.1.max(next.1),
            _ => out.push(next),
        }
    }
    out
}

/// A count of successes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Share {
    /// How many succeeded.
    pub hits: usize,
    /// How many there were.
    pub of: usize,
}

impl Share {
    pub(super) fn count(outcomes: impl Iterator<Item = bool>) -> Self {
        outcomes.fold(Self::default(), |all, hit| Self {
            hits: all.hits + usize::from(hit),
            of: all.of + 1,
        })
    }

    /// The share; NaN of none.
    pub fn value(&self) -> f64 {
        self.hits as f64 / self.of as f64
    }

    /// Its binomial standard error, never that of a certainty: with one
    /// success and one failure more (Agresti, Coull 1998, in brief).
    pub fn se(&self) -> f64 {
        let n = self.of as f64;
        let share = (self.hits as f64 + 1.0) / (n + 2.0);
        (share * (1.0 - share) / n).sqrt()
    }
}

/// One bin of stated probabilities.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CalibrationBin {
    /// How many answers stated a probability in it.
    pub count: usize,
    /// Their share of all weight.
    pub weight: f64,
    /// The mean probability stated.
    pub stated: f64,
    /// The share of them that was right.
    pub right: f64,
}

/// The score of one effect.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectScore {
    /// Its name.
    pub name: &'static str,
    /// What it belongs to.
    pub class: Class,
    /// How often it was the most probable.
    pub first: Share,
    /// How often it was in the group.
    pub in_group: Share,
    /// How often anything was found.
    pub detected: Share,
    /// How many recordings show enough of it for it to come first.
    pub visible: Share,
    /// Detection for the small, the middle and the large third of sizes.
    pub by_size: [Share; 3],
    /// The median overlap of located and true stretch, where it has one.
    pub median_iou: Option<f64>,
}

/// What became of effects that no catalogue has.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OutsideScore {
    /// Any verdict but `adequate`.
    pub detected: Share,
    /// `unknown` is the most probable.
    pub unknown: Share,
    /// Other names are, and leave no more than the noise.
    pub explained: Share,
    /// The median overlap of located and true stretch, where there is one.
    pub median_iou: Option<f64>,
}

/// The score of the challenge.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// How many cases there were.
    pub cases: usize,
    /// The truth is most probable: effects of the catalogue without those
    /// that count by group only.
    pub top1: Share,
    /// The truth begins the group: the same effects, by evidence alone.
    pub leads: Share,
    /// The truth is in the group: effects of the catalogue.
    pub in_group: Share,
    /// A verdict other than `adequate` where nothing is hidden.
    pub false_alarms: Share,
    /// Anything was found: effects of the catalogue.
    pub detected: Share,
    /// As `top1`, of the effects that the recording shows enough of.
    pub top1_visible: Share,
    /// As `in_group`, of the effects that the recording shows enough of.
    pub in_group_visible: Share,
    /// The fit leaves at most 1.15 times the noise: effects of the catalogue.
    pub within_noise: Share,
    /// Expected calibration error of the top probability.
    pub expected_calibration_error: f64,
    /// What it is made of.
    pub bins: Vec<CalibrationBin>,
    /// The most probable noise is of the errors' kind: all cases.
    pub noise_kind: Share,
    /// The same for each kind of errors there was, in their order.
    pub noise_kinds: Vec<(Scatter, Share)>,
    /// The posterior mean prediction is further from the recording than
    /// before: all cases.
    pub worse: Share,
    /// By what share of itself its error grew at the most; 0 where none did.
    pub most_worse: f64,
    /// The least error of the motion is greater than before: all cases.
    pub worse_at_best: Share,
    /// The median overlap of located and true stretch; NaN of none.
    pub median_iou: f64,
    /// For each truth, how often each name was the most probable.
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// Effect by effect.
    pub effects: Vec<EffectScore>,
    /// Effects outside the catalogue.
    pub outside: OutsideScore,
    /// Median and greatest time of a diagnosis \[s\].
    pub seconds: (f64, f64),
}

impl Score {
    /// Scores answers.
    pub fn of(outcomes: &[Outcome]) -> Self {
        let hidden = || outcomes.iter().filter(|o| in_catalogue(&o.truth));
        let none = || outcomes.iter().filter(|o| o.truth.class == Class::None);
        let singly = || hidden().filter(|o| !asks_group(&o.truth));
        let seen = |o: &&Outcome| o.visible();
        let bins = bins(outcomes);
        let gap = |b: &CalibrationBin| b.weight * (b.stated - b.right).abs();
        let seconds = || outcomes.iter().map(|o| o.answer.seconds);
        let longest = seconds().fold(0.0, f64::max);
        Self {
            cases: outcomes.len(),
            top1: Share::count(singly().map(Outcome::first)),
            leads: Share::count(singly().map(Outcome::leads)),
            top1_visible: Share::count(
                singly().filter(seen).map(Outcome::first),
            ),
            in_group_visible: Share::count(
                hidden().filter(seen).map(Outcome::in_group),
            ),
            in_group: Share::count(hidden().map(Outcome::in_group)),
            false_alarms: Share::count(none().map(Outcome::detected)),
            detected: Share::count(hidden().map(Outcome::detected)),
            within_noise: Share::count(hidden().map(Outcome::within_noise)),
            noise_kind: Share::count(
                outcomes.iter().map(Outcome::names_errors),
            ),
            noise_kinds: noise_kinds(outcomes),
            worse: Share::count(outcomes.iter().map(Outcome::worse)),
            most_worse: most_worse(outcomes),
            worse_at_best: Share::count(
                outcomes.iter().map(Outcome::worse_at_best),
            ),
            expected_calibration_error: bins.iter().map(gap).sum(),
            bins,
            median_iou: median(hidden().filter_map(Outcome::overlap))
                .unwrap_or(f64::NAN),
            confusion: confusion(outcomes),
            effects: effects(outcomes),
            outside: outside(outcomes),
            seconds: (median(seconds()).unwrap_or(f64::NAN), longest),
        }
    }
}

/// The cases that did not come out as asked, in their order.
pub(super) fn failures(outcomes: &[Outcome]) -> Vec<&Outcome> {
    outcomes.iter().filter(|o| o.failed()).collect()
}

fn in_catalogue(truth: &Truth) -> bool {
    !matches!(truth.class, Class::None | Class::Outside)
}

/// The median of some numbers, where there are any.
fn median(all: impl Iterator<Item = f64>) -> Option<f64> {
    let all: Vec<f64> = all.collect();
    (!all.is_empty()).then(|| draws::median(&all))
}

/// Stated and true shares in equal bins of the top probability. Cases weigh
/// as the prior has it: half for nothing hidden, half shared evenly by the
/// effects of the catalogue.
fn bins(outcomes: &[Outcome]) -> Vec<CalibrationBin> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    // Probabilities of noises are another matter.
    let apart = [Class::Outside, Class::Errors];
    let counted =
        || outcomes.iter().filter(|o| !apart.contains(&o.truth.class));
    for o in counted() {
        *counts.entry(o.truth.effect).or_default() += 1;
    }
    let names = counts.keys().filter(|name| **name != NONE).count();
    let mut bins = vec![CalibrationBin::default(); BINS];
    for o in counted() {
        let share = match o.truth.class {
            Class::None => 0.5,
            _ => 0.5 / names as f64,
        };
        let weight = share / counts[o.truth.effect] as f64;
        let p = o.answer.top().1.clamp(0.0, 1.0);
        let bin = &mut bins[((p * BINS as f64) as usize).min(BINS - 1)];
        bin.count += 1;
        bin.weight += weight;
        bin.stated += weight * p;
        bin.right += weight * f64::from(o.first());
    }
    let total: f64 = bins.iter().map(|b| b.weight).sum();
    for bin in bins.iter_mut().filter(|b| b.weight > 0.0) {
        bin.stated /= bin.weight;
        bin.right /= bin.weight;
        bin.weight /= total;
    }
    bins
}

/// How often each kind of errors was named.
fn noise_kinds(outcomes: &[Outcome]) -> Vec<(Scatter, Share)> {
    let of = |scatter: Scatter| {
        let own = outcomes.iter().filter(|o| o.truth.scatter == scatter);
        (scatter, Share::count(own.map(Outcome::names_errors)))
    };
    let all = Scatter::ALL.into_iter().map(of);
    all.filter(|(_, share)| share.of > 0).collect()
}

fn confusion(
    outcomes: &[Outcome],
) -> BTreeMap<String, BTreeMap<String, usize>> {
    let mut all: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for o in outcomes {
        let row = all.entry(o.truth.effect.to_owned()).or_default();
        *row.entry(o.answer.top().0.to_owned()).or_default() += 1;
    }
    all
}

/// The names that occur among the truths, the catalogue's first.
fn truths(outcomes: &[Outcome]) -> Vec<&Truth> {
    let mut names: Vec<&Truth> = Vec::new();
    for o in outcomes {
        if names.iter().all(|t| t.effect != o.truth.effect) {
            names.push(&o.truth);
        }
    }
    let place = |t: &&Truth| {
        let known = CATALOGUE.iter().position(|k| k.name == t.effect);
        known.unwrap_or(CATALOGUE.len())
    };
    names.sort_by_key(place);
    names
}

fn effects(outcomes: &[Outcome]) -> Vec<EffectScore> {
    let score = |truth: &Truth| {
        let own =
            || outcomes.iter().filter(|o| o.truth.effect == truth.effect);
        let overlaps = own().filter_map(Outcome::overlap);
        EffectScore {
            name: truth.effect,
            class: truth.class,
            first: Share::count(own().map(Outcome::first)),
            in_group: Share::count(own().map(Outcome::in_group)),
            detected: Share::count(own().map(Outcome::detected)),
            visible: Share::count(own().map(Outcome::visible)),
            by_size: by_size(&own().collect::<Vec<_>>()),
            median_iou: median(overlaps),
        }
    };
    truths(outcomes).into_iter().map(score).collect()
}

/// Detection in thirds of the range of sizes.
fn by_size(own: &[&Outcome]) -> [Share; 3] {
    let third = |o: &Outcome| {
        let kind = CATALOGUE
            .into_iter()
            .chain(super::effects::OUTSIDE)
            .find(|k| k.name == o.truth.effect)?;
        let (low, high) = kind.range;
        let part = (o.truth.size.abs() - low) / (high - low);
        Some(((3.0 * part) as usize).min(2))
    };
    std::array::from_fn(|i| {
        let those = own.iter().filter(|o| third(o) == Some(i));
        Share::count(those.map(|o| o.detected()))
    })
}

fn outside(outcomes: &[Outcome]) -> OutsideScore {
    let own = || outcomes.iter().filter(|o| o.truth.class == Class::Outside);
    let unknown = |o: &Outcome| o.answer.top().0 == UNKNOWN;
    OutsideScore {
        detected: Share::count(own().map(Outcome::detected)),
        unknown: Share::count(own().map(unknown)),
        explained: Share::count(own().map(|o| !unknown(o) && o.fair())),
        median_iou: median(own().filter_map(Outcome::overlap)),
    }
}

#[cfg(test)]
pub(super) mod tests;
