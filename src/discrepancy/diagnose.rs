//! The whole diagnosis: check, locate, attribute, model, show.

use std::f64::consts::LN_10;
use std::time::Instant;

use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

use super::attribute::{Attribution, Known, attribute, extend, pair};
use super::before_and_after::{Figures, Shown, recordings, rows_of, show};
use super::diagnosis::{
    Baseline, Corrected, Diagnosis, Improvement, Judged, Pair, Pictured,
    Verdict,
};
use super::fit::Fit;
use super::judge::{Odds, group, judge, told, verdict};
use super::locate::{FreeForce, free_fit, locate};
use super::mechanisms::catalogue;
use super::paste::{declarations, model_text};
use super::place::mismatch;
use super::together::{Sharing, Together};
use crate::change::{Family, Mechanism};
use crate::draws::{self, summarise};
use crate::error::{Error, Result};
use crate::infer::Progress;
use crate::model::{Assembled, Program};
use crate::observe::{Event, Extent};
use crate::physics::forces::Axis;
use crate::predict::Bands;
use crate::seed::Seed;

/// What to know of a model before it is diagnosed.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Where all random numbers start.
    pub seed: u64,
    /// The user's odds.
    pub odds: Odds,
    /// The friction law's name, a sum of blocks: "coulomb + turbulent".
    pub friction: String,
    /// The noise's name: "ar(1)".
    pub noise: String,
    /// Friction and errors as `model!` declares them, where that is known.
    pub declarations: Option<[String; 2]>,
}

impl Options {
    /// Those of a model put together from an event file.
    pub fn of(model: &Assembled, seed: u64) -> Self {
        Self {
            seed,
            odds: Odds::new(),
            friction: model.friction(),
            noise: model.noise(),
            declarations: declarations(model),
        }
    }

    /// Those of several events under one model.
    pub fn of_all(together: &Together, seed: u64) -> Self {
        let mut all = Self { seed, ..Self::default() };
        for event in together.events() {
            for (text, own) in [
                (&mut all.friction, event.friction()),
                (&mut all.noise, event.noise()),
            ] {
                if !text.split(" | ").any(|known| known == own) {
                    let between = if text.is_empty() { "" } else { " | " };
                    text.push_str(between);
                    text.push_str(&own);
                }
            }
        }
        all
    }

    /// The blocks that the model already has, without their arguments.
    fn blocks(&self) -> Vec<String> {
        let noise = self.noise.split('(').next().unwrap_or_default();
        self.friction
            .split('+')
            .chain([noise])
            .map(|name| name.trim().to_owned())
            .collect()
    }
}

/// In log10: by how much a pair must beat the best single mechanism, and a
/// third one the pair.
const RISE: f64 = 1.0;
/// Of how many mechanisms all pairs are weighed.
const BEST: usize = 5;
/// A probability of `none` above which no pair is looked at.
const SURE: f64 = 0.9;

/// What was chosen to be added to the model.
struct Chosen {
    /// Which of the catalogue.
    which: Vec<usize>,
    fit: Fit,
}

/// The best pair with the best single mechanism in it, and the best without.
struct Pairs {
    nested: Option<Chosen>,
    other: Option<Chosen>,
}

/// Finds where a model and a recording differ and what was left out.
///
/// # Errors
/// An improper prior, an event without a recording, or a model that fails.
pub fn diagnose<P: Program>(
    program: &P,
    event: &Event,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Diagnosis> {
    let extent = event.extent();
    let all = catalogue(&extent, &options.blocks());
    Subject { program, events: vec![event], extent, all }
        .diagnose(options, progress)
}

/// Finds where several recordings differ from one model and what was left out
/// of all of them; evidence adds up.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_together(
    program: &Together,
    sharing: Sharing,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Diagnosis> {
    let events = program.events().iter().map(Assembled::event).collect();
    let (extent, all) = (program.extent(), program.catalogue(sharing));
    Subject { program, events, extent, all }.diagnose(options, progress)
}

/// A model with its events and what may be missing from it.
struct Subject<'a, P> {
    program: &'a P,
    events: Vec<&'a Event>,
    extent: Extent,
    all: Vec<Box<dyn Mechanism>>,
}

impl<P: Program> Subject<'_, P> {
    fn diagnose(
        &self,
        options: &Options,
        progress: &dyn Progress,
    ) -> Result<Diagnosis> {
        let begun = Instant::now();
        let seed = Seed::new(options.seed);
        let (program, all) = (self.program, &self.all[..]);
        let found = attribute(program, all, seed.child(0), progress)?;
        progress.begin("locating the mismatch", None);
        let forces = self.locate(&found, seed)?;
        let judged = judge(&found, all, &forces, &options.odds);
        let verdict = verdict(&judged);
        progress.begin("weighing pairs", None);
        let chosen = choose(program, all, &found, &judged, verdict, seed)?;
        let (verdict, chosen) = explained(verdict, chosen, &judged, all);
        progress.begin("showing", None);
        let free = match verdict {
            Verdict::Unexplained => {
                let force = most_probable(&forces)?;
                let seed = seed.child(20);
                let none = &found.none;
                Some(free_fit(program, &self.extent, force, none, seed)?)
            }
            _ => None,
        };
        let after = shown_after(chosen.as_ref(), free.as_ref(), all, seed);
        let mut diagnosis = self.told(&found.none, after.as_ref(), seed)?;
        diagnosis.baseline.friction.clone_from(&options.friction);
        diagnosis.baseline.noise.clone_from(&options.noise);
        diagnosis.verdict = verdict;
        diagnosis.group = group(&judged);
        let reaches = chosen.as_ref().map(|c| reaches(c, all));
        let reaches = reaches.unwrap_or_default();
        let (event, pictured) = (self.events[0], &diagnosis.pictured[0]);
        diagnosis.mismatch =
            mismatch(verdict, &reaches, &forces, event, pictured);
        mark(&mut diagnosis, &self.events);
        let quantity = diagnosis.pictured[0].quantity.clone();
        diagnosis.corrected =
            corrected(chosen.as_ref(), all, options, &quantity);
        diagnosis.separating = separating(&diagnosis.group, &judged);
        diagnosis.mechanisms = judged;
        diagnosis.forces = forces;
        diagnosis.seconds = begun.elapsed().as_secs_f64();
        Ok(diagnosis)
    }

    /// The free-form force along every axis.
    fn locate(
        &self,
        found: &Attribution,
        seed: Seed,
    ) -> Result<Vec<FreeForce>> {
        [Axis::Place, Axis::Time, Axis::Speed]
            .into_par_iter()
            .enumerate()
            .map(|(i, axis)| {
                let seed = seed.child(10 + i as u64);
                let own = found.none.own();
                locate(self.program, &self.extent, axis, own, seed)
            })
            .collect()
    }

    /// Before, after, and what both predict.
    fn told(
        &self,
        none: &Fit,
        after: Option<&Shown<'_>>,
        seed: Seed,
    ) -> Result<Diagnosis> {
        let before = Shown {
            mechanisms: Vec::new(),
            fit: none,
            first: seed.child(30),
            rough: false,
        };
        let old = show(self.program, &self.events, &before)?;
        let new = match after {
            Some(after) => show(self.program, &self.events, after)?,
            None => old.clone(),
        };
        let fit = after.map_or(none, |after| after.fit);
        let names: Vec<&str> =
            self.events.iter().map(|event| event.name()).collect();
        let mut warnings = none.warnings.clone();
        warnings.extend(fit.warnings.iter().cloned());
        warnings.dedup();
        Ok(Diagnosis {
            event: names.join(" + "),
            baseline: baseline(none, &old, self.events[0]),
            selected: after.map(Shown::names).unwrap_or_default(),
            improvement: improvement(none, fit, &old, &new),
            parameters: told(&summarise(&fit.draws), None)
                .into_iter()
                .filter(|p| !p.name.starts_with("unknown."))
                .collect(),
            pictured: pictured(&self.events, &old, &new, after.is_some()),
            warnings,
            ..Diagnosis::default()
        })
    }
}

/// What the corrected model is, to be shown.
fn shown_after<'a>(
    chosen: Option<&'a Chosen>,
    free: Option<&'a (Box<dyn Mechanism>, Fit)>,
    all: &'a [Box<dyn Mechanism>],
    seed: Seed,
) -> Option<Shown<'a>> {
    let (mechanisms, fit, rough) = match (chosen, free) {
        (Some(chosen), _) => {
            let which = chosen.which.iter().map(|&i| all[i].as_ref());
            (which.collect(), &chosen.fit, false)
        }
        (None, Some((force, fit))) => (vec![force.as_ref()], fit, true),
        (None, None) => return None,
    };
    Some(Shown { mechanisms, fit, first: seed.child(40), rough })
}

fn baseline(none: &Fit, old: &Figures, event: &Event) -> Baseline {
    let innovations = old.innovations.concat();
    Baseline {
        log_evidence: none.log_evidence,
        rmse: old.rmse,
        ljung_box_p: old.ljung_box_p,
        shapiro_wilk_p: shapiro_wilk(&innovations),
        predictive_p: largest_p(&innovations),
        stationary_sd: stationary_sd(&none.draws),
        innovation_sd: innovation_sd(&none.draws),
        instrument: instrument(event),
        ..Baseline::default()
    }
}

fn improvement(
    none: &Fit,
    fit: &Fit,
    old: &Figures,
    new: &Figures,
) -> Improvement {
    let pair =
        |of: fn(&Figures) -> f64| Pair { before: of(old), after: of(new) };
    let gain = fit.log_evidence - none.log_evidence;
    Improvement {
        log10_bayes_factor: gain / LN_10,
        rmse: pair(|f| f.rmse),
        elpd: pair(|f| f.elpd),
        heldout_rmse: pair(|f| f.heldout_rmse),
        coverage90: pair(|f| f.coverage90),
        ljung_box_p: pair(|f| f.ljung_box_p),
    }
}

/// The free-form force along the axis with the most evidence.
fn most_probable(forces: &[FreeForce]) -> Result<&FreeForce> {
    forces
        .iter()
        .max_by(|a, b| a.log_bayes_factor.total_cmp(&b.log_bayes_factor))
        .ok_or_else(|| Error::inference("no free-form force was inferred"))
}

/// Where the free-form force is more probable than any one mechanism, several
/// together may still explain as much and say more: they do where their
/// evidence is above that of the force.
fn explained(
    verdict: Verdict,
    chosen: Option<Chosen>,
    judged: &[Judged],
    all: &[Box<dyn Mechanism>],
) -> (Verdict, Option<Chosen>) {
    if verdict != Verdict::Unexplained {
        return (verdict, chosen);
    }
    let unknown = judged.iter().find(|m| m.name == "unknown");
    let Some((chosen, unknown)) = chosen.zip(unknown) else {
        return (verdict, None);
    };
    if chosen.fit.log_evidence <= unknown.log_evidence {
        return (verdict, None);
    }
    let family = chosen.which.iter().map(|&i| all[i].family()).min();
    let verdict = match family {
        Some(Family::Physics) => Verdict::MissingPhysics,
        Some(Family::Noise) | None => Verdict::Noise,
        Some(_) => Verdict::Measurement,
    };
    (verdict, Some(chosen))
}

/// The model to go on with: the best mechanism where there is one, or a pair
/// or three where the evidence rises.
fn choose<P: Program>(
    program: &P,
    all: &[Box<dyn Mechanism>],
    found: &Attribution,
    judged: &[Judged],
    verdict: Verdict,
    seed: Seed,
) -> Result<Option<Chosen>> {
    if verdict == Verdict::Adequate {
        return Ok(None);
    }
    let best = best_variants(all, found, judged);
    let Some(&first) = best.first() else { return Ok(None) };
    let single =
        Chosen { which: vec![first], fit: found.candidates[first].clone() };
    let none = judged.iter().find(|m| m.name == "none");
    if none.is_some_and(|m| m.probability > SURE) {
        return Ok(Some(single));
    }
    let pairs = best_pair(program, all, found, &best, &single.fit, seed)?;
    let two = match pairs.nested {
        Some(two) if rises(&two.fit, &single.fit) => two,
        _ => return Ok(Some(rivalled(single, pairs.other, all))),
    };
    let two = rivalled(two, pairs.other, all);
    let three = best_third(program, all, found, &best, &two, seed)?;
    match three {
        Some(three) if rises(&three.fit, &two.fit) => Ok(Some(three)),
        _ => Ok(Some(two)),
    }
}

/// The chosen, warned of where a pair of other mechanisms reaches further.
fn rivalled(
    mut chosen: Chosen,
    rival: Option<Chosen>,
    all: &[Box<dyn Mechanism>],
) -> Chosen {
    if let Some(rival) = rival.filter(|r| rises(&r.fit, &chosen.fit)) {
        let names: Vec<_> =
            rival.which.iter().map(|&i| all[i].name()).collect();
        let gain = rival.fit.log_evidence - chosen.fit.log_evidence;
        chosen.fit.warnings.push(format!(
            "{} together reach a higher evidence still, by {:.1} in log10",
            names.join(" and "),
            gain / LN_10
        ));
    }
    chosen
}

fn rises(more: &Fit, less: &Fit) -> bool {
    more.log_evidence - less.log_evidence > RISE * LN_10
}

/// The best variant of each of the best names, most evidence first.
fn best_variants(
    all: &[Box<dyn Mechanism>],
    found: &Attribution,
    judged: &[Judged],
) -> Vec<usize> {
    let mut names: Vec<&Judged> = judged
        .iter()
        .filter(|m| m.name != "none" && m.name != "unknown")
        .collect();
    names.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let evidence = |i: &usize| found.candidates[*i].log_evidence;
    names
        .iter()
        .take(BEST)
        .filter_map(|m| {
            (0..all.len())
                .filter(|&i| all[i].name() == m.name)
                .max_by(|a, b| evidence(a).total_cmp(&evidence(b)))
        })
        .collect()
}

fn best_pair<P: Program>(
    program: &P,
    all: &[Box<dyn Mechanism>],
    found: &Attribution,
    best: &[usize],
    single: &Fit,
    seed: Seed,
) -> Result<Pairs> {
    let pairs: Vec<(usize, usize)> = (0..best.len())
        .flat_map(|i| (i + 1..best.len()).map(move |j| (best[i], best[j])))
        .collect();
    let fits = pairs
        .into_par_iter()
        .map(|(a, b)| {
            let seed = seed.child(1000 + (a * all.len() + b) as u64);
            let mechanisms = [all[a].as_ref(), all[b].as_ref()];
            let fits = [&found.candidates[a], &found.candidates[b]];
            let hurdle = single.log_evidence + RISE * LN_10;
            let fit = pair(program, mechanisms, fits, hurdle, seed)?;
            Ok(fit.map(|fit| Chosen { which: vec![a, b], fit }))
        })
        .collect::<Result<Vec<_>>>()?;
    // A second term is added to the best one: a pair of two others that
    // reaches as far says less plainly what is missing.
    let (nested, others): (Vec<_>, Vec<_>) = fits
        .into_iter()
        .partition(|c| c.as_ref().is_some_and(|c| c.which.contains(&best[0])));
    Ok(Pairs { nested: most_evidence(nested), other: most_evidence(others) })
}

fn best_third<P: Program>(
    program: &P,
    all: &[Box<dyn Mechanism>],
    found: &Attribution,
    best: &[usize],
    two: &Chosen,
    seed: Seed,
) -> Result<Option<Chosen>> {
    let known: Vec<&dyn Mechanism> =
        two.which.iter().map(|&i| all[i].as_ref()).collect();
    let fits = best
        .par_iter()
        .filter(|i| !two.which.contains(i))
        .map(|&i| {
            let seed = seed.child(5000 + i as u64);
            let known = Known { mechanisms: &known, fit: &two.fit };
            let added = (all[i].as_ref(), &found.candidates[i]);
            let hurdle = two.fit.log_evidence + RISE * LN_10;
            let fit = extend(program, &known, added, hurdle, seed)?;
            let which = [two.which.clone(), vec![i]].concat();
            Ok(fit.map(|fit| Chosen { which, fit }))
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(most_evidence(fits))
}

fn most_evidence(fits: Vec<Option<Chosen>>) -> Option<Chosen> {
    fits.into_iter()
        .flatten()
        .max_by(|a, b| a.fit.log_evidence.total_cmp(&b.fit.log_evidence))
}

/// Where the chosen mechanisms are confined to, by the medians of their
/// edges.
fn reaches(
    chosen: &Chosen,
    all: &[Box<dyn Mechanism>],
) -> Vec<crate::change::Reach> {
    let rows = rows_of(&chosen.fit.draws);
    let mut first = 0;
    let mut reaches = Vec::new();
    for &i in &chosen.which {
        let count = all[i].unknowns().len();
        let edges: Vec<_> = rows
            .iter()
            .filter_map(|row| all[i].reach(&row[first..first + count]))
            .collect();
        first += count;
        let Some(one) = edges.first() else { continue };
        let median = |of: fn(&crate::change::Reach) -> f64| {
            let mut sorted: Vec<f64> = edges.iter().map(of).collect();
            sorted.sort_by(f64::total_cmp);
            sorted[sorted.len() / 2]
        };
        reaches.push(crate::change::Reach {
            axis: one.axis,
            from: median(|r| r.from),
            to: median(|r| r.to),
        });
    }
    reaches
}

/// Each recording with what both models predict of it.
fn pictured(
    events: &[&Event],
    before: &Figures,
    after: &Figures,
    corrected: bool,
) -> Vec<Pictured> {
    recordings(events)
        .into_iter()
        .enumerate()
        .map(|(i, (event, series))| {
            let (x, z) = event.track().points();
            Pictured {
                event: event.name().to_owned(),
                quantity: series.quantity().name().to_owned(),
                unit: series.quantity().unit().to_owned(),
                times: series.times().to_vec(),
                values: series.values().to_vec(),
                places: after.places[i].clone(),
                before: before.bands[i].clone(),
                after: if corrected {
                    after.bands[i].clone()
                } else {
                    Bands::default()
                },
                track: (x.to_vec(), z.to_vec()),
                ..Pictured::default()
            }
        })
        .collect()
}

fn shapiro_wilk(innovations: &[f64]) -> f64 {
    let most = innovations.len().min(5000);
    draws::shapiro_wilk(&innovations[..most]).map_or(f64::NAN, |test| test.p)
}

/// The probability of an innovation as large as the largest among as many.
fn largest_p(innovations: &[f64]) -> f64 {
    let largest = innovations.iter().map(|d| d.abs()).fold(0.0, f64::max);
    let outside = 2.0 * Normal::standard().cdf(-largest);
    -(innovations.len() as f64 * (-outside).ln_1p()).exp_m1()
}

/// The sd of AR(1) errors themselves, sqrt(sigma2/(1 - phi^2)): the median.
fn stationary_sd(draws: &draws::Draws) -> Option<f64> {
    let names = draws.names();
    let column = |name: &str| names.iter().position(|n| n == name);
    let (phi, sigma2) = (column("phi")?, column("sigma2")?);
    let mut sds: Vec<f64> = rows_of(draws)
        .iter()
        .map(|row| (row[sigma2] / (1.0 - row[phi].powi(2))).sqrt())
        .collect();
    sds.sort_by(f64::total_cmp);
    sds.get(sds.len() / 2).copied()
}

/// The sd of the innovations of AR(1) errors: the median.
fn innovation_sd(draws: &draws::Draws) -> Option<f64> {
    let names = draws.names();
    names.iter().position(|n| n == "phi")?;
    let sigma2 = names.iter().position(|n| n == "sigma2")?;
    let mut sds: Vec<f64> =
        rows_of(draws).iter().map(|row| row[sigma2].sqrt()).collect();
    sds.sort_by(f64::total_cmp);
    sds.get(sds.len() / 2).copied()
}

/// The mean known error of the recording's values.
fn instrument(event: &Event) -> Option<f64> {
    let errors = event.recordings().next()?.grid().standard_errors()?;
    Some(errors.iter().sum::<f64>() / errors.len() as f64)
}

/// Marks the mismatch on the tracks.
fn mark(diagnosis: &mut Diagnosis, events: &[&Event]) {
    let stretches: Vec<(f64, f64)> = diagnosis
        .mismatch
        .iter()
        .map(|m| (m.place_from, m.place_to))
        .collect();
    let owners = recordings(events);
    for (pictured, (event, _)) in diagnosis.pictured.iter_mut().zip(owners) {
        let track = event.track();
        for (from, to) in &stretches {
            let steps = 24;
            pictured.marked.extend((0..=steps).map(|i| {
                let share = f64::from(i) / f64::from(steps);
                let place = from + share * (to - from) - track.origin();
                track.position(place.max(0.0))
            }));
        }
    }
}

/// The corrected model, written out.
fn corrected(
    chosen: Option<&Chosen>,
    all: &[Box<dyn Mechanism>],
    options: &Options,
    quantity: &str,
) -> Corrected {
    let mut equation =
        vec![format!("du/dt = g sin(theta) - r, r of {}", options.friction)];
    let Some(chosen) = chosen else {
        return Corrected { equation, ..Corrected::default() };
    };
    let mechanisms: Vec<&dyn Mechanism> =
        chosen.which.iter().map(|&i| all[i].as_ref()).collect();
    for mechanism in &mechanisms {
        equation.push(format!(
            "{}: {}",
            mechanism.name(),
            mechanism.formula()
        ));
    }
    Corrected {
        equation,
        model: options.declarations.as_ref().map_or_else(String::new, |own| {
            model_text(&mechanisms, own, quantity)
        }),
        labels: mechanisms.iter().map(|m| m.label()).collect(),
    }
}

/// The recording that would tell the members of a group apart.
fn separating(group: &[String], judged: &[Judged]) -> Option<String> {
    if group.len() < 2 {
        return None;
    }
    let of = |name: &String| judged.iter().find(|m| m.name == *name);
    let members: Vec<&Judged> = group.iter().filter_map(of).collect();
    let has = |kind: &str| members.iter().any(|m| m.kind == kind);
    let along =
        |axis: Axis| members.iter().any(|m| m.coordinate == Some(axis));
    Some(if has("start") || has("measurement") {
        "A second recording with another sensor, or of a mass released at a \
         known place and moment, would tell them apart."
            .into()
    } else if along(Axis::Time) && along(Axis::Place) {
        "A recording from another start would tell them apart: what belongs \
         to a place stays there, what belongs to a moment moves along."
            .into()
    } else if has("noise") {
        "A longer recording, or a second sensor on the same mass, would tell \
         them apart."
            .into()
    } else {
        "A recording at other speeds over the same ground, from a higher \
         start or on another slope, would tell them apart."
            .into()
    })
}
