//! The whole diagnosis: weigh, locate, decide, compare, tell.

use std::time::Instant;

use crate::diagnosis::compare::baseline::baseline;
use crate::diagnosis::compare::checks::{
    FittedModel, checks, improvement, pictured, posterior_rmse,
};
use crate::diagnosis::compare::scored::check_scored;
use crate::diagnosis::decide::choose::{Choice, Explained};
use crate::diagnosis::decide::chosen::Chosen;
use crate::diagnosis::decide::decision::Decision;
use crate::diagnosis::decide::judge::{
    Seen, group, judge_all, log_of_noises, verdict,
};
use crate::diagnosis::decide::noise::{judged_noises, taken};
use crate::diagnosis::decide::odds::{Beforehand, check_odds};
use crate::diagnosis::evidence::attribute::Care;
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::evidence::noises::{named_alone, noises};
use crate::diagnosis::evidence::table::{Row, Table};
use crate::diagnosis::findings::{
    BeforeAfter, Diagnosis, LawParameters, ParameterSummary, Rest, Verdict,
    Withheld,
};
use crate::diagnosis::hypothesis::{NONE, UNKNOWN};
use crate::diagnosis::locate::{
    FORMULA, FreeForce, Open, free_fit, left, left_open, no_density,
};
use crate::diagnosis::options::Options;
use crate::diagnosis::tell::next::next_recording;
use crate::diagnosis::tell::noise::is_other;
use crate::diagnosis::tell::paste::corrected;
use crate::diagnosis::tell::place::{mark, mismatch};
use crate::diagnosis::tell::weak::is_weak;
use crate::diagnosis::together::Sharing;
use crate::draws::{Draws, summarise};
use crate::error::Result;
use crate::infer::Progress;
use crate::mechanism::Mechanism;
use crate::mechanism::catalogue::is_held;
use crate::model::{AnyProgram, Member, Together, declared_blocks};
use crate::observe::{Event, Extent};
use crate::physics::forces::Axis;
use crate::seed::Seed;

/// Finds where a model and a recording differ and what was left out.
///
/// # Errors
/// An improper prior, odds of what is not weighed, a mechanism of one's own
/// that cannot be told from others, an event without a recording, a model that
/// scores other series than its event has, or in another order than
/// [`Event::recordings`], or one that fails.
pub fn diagnose(
    program: &dyn AnyProgram,
    event: &Event,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Diagnosis> {
    let extent = event.extent();
    options.catalogue.check(&extent, &[NONE, UNKNOWN])?;
    let own = declared_blocks(program)?;
    let held = [&own[..], &options.blocks].concat();
    let all = options.catalogue.of(&extent, &held);
    Subject { program, events: vec![event], extent, all }
        .diagnose(&options.of_blocks(&own), progress)
}

/// Finds where several recordings differ from their models and what was left
/// out of all of them; evidence adds up.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_together<M: Member>(
    program: &Together<M>,
    sharing: Sharing,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Diagnosis> {
    let (events, extent) = (program.events().collect(), program.extent());
    options.catalogue.check(&extent, &[NONE, UNKNOWN])?;
    let mut all = program.catalogue(&options.catalogue, sharing);
    all.retain(|m| !is_held(m.as_ref(), &options.blocks));
    let own = declared_blocks(program)?;
    Subject { program, events, extent, all }
        .diagnose(&options.of_blocks(&own), progress)
}

/// A model with its events and what may be missing from it.
struct Subject<'a> {
    program: &'a dyn AnyProgram,
    events: Vec<&'a Event>,
    extent: Extent,
    all: Vec<Box<dyn Mechanism>>,
}

/// How sure, in ln, an evidence is that was carried over to another noise: one
/// gets fits of its own only where it promises more by so much.
const UNSURE: f64 = 1.0;

impl Subject<'_> {
    fn diagnose(
        &self,
        options: &Options,
        progress: &dyn Progress,
    ) -> Result<Diagnosis> {
        let begun = Instant::now();
        let seed = Seed::new(options.seed);
        check_odds(&options.odds, &self.all)?;
        check_scored(self.program, &self.events)?;
        let mut table = self.table(options, seed, progress)?;
        let row = self.taken(&mut table, options, seed, progress)?;
        progress.begin("weighing several together", None);
        let mut decision = self.decide(&table, row, options, seed)?;
        decision.withheld = self.withheld(&table, &decision)?;
        if decision.withheld.is_some() {
            decision.chosen = None;
        }
        progress.begin("showing", None);
        let mut diagnosis = self.shown(&table, &decision, options, seed)?;
        diagnosis.seconds = begun.elapsed().as_secs_f64();
        Ok(diagnosis)
    }

    /// Every mechanism under every noise that is kept.
    fn table(
        &self,
        options: &Options,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Table<'_>> {
        progress.begin("weighing noises", None);
        let (program, extent) = (self.program, &self.extent);
        let (named, survey) = (&options.noise, seed.child(1));
        let (noises, care) = match options.quick {
            true => {
                (named_alone(program, named, extent, survey)?, Care::QUICK)
            }
            false => (noises(program, named, extent, survey)?, Care::DECIDING),
        };
        Table::of(noises, extent, &self.all, care, seed.child(0), progress)
    }

    /// The row of the noise that the model goes on with, all fits made.
    fn taken(
        &self,
        table: &mut Table<'_>,
        options: &Options,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<usize> {
        let named = table.named().filter(|_| !options.infers_noise);
        let mut logs = self.log_of_noises(table, options);
        for (i, log) in logs.iter_mut().enumerate() {
            if table.rows[i].found.is_none() && named != Some(i) {
                *log -= UNSURE;
            }
        }
        let row = taken(named, &logs);
        let seed = seed.child(2);
        let (extent, care) = (&self.extent, Care::DECIDING);
        table.fill(row, extent, &self.all, care, seed, progress)?;
        // Of those that have all fits by now.
        let mut logs = self.log_of_noises(table, options);
        for (log, row) in logs.iter_mut().zip(&table.rows) {
            if row.found.is_none() {
                *log = f64::NEG_INFINITY;
            }
        }
        Ok(taken(named, &logs))
    }

    fn log_of_noises(&self, table: &Table<'_>, options: &Options) -> Vec<f64> {
        let rows: Vec<Seen<'_>> = table.rows.iter().map(Seen::of).collect();
        log_of_noises(&rows, &self.all, &options.odds)
    }

    /// What was found and decided, as plain data.
    fn shown(
        &self,
        table: &Table<'_>,
        decision: &Decision,
        options: &Options,
        seed: Seed,
    ) -> Result<Diagnosis> {
        let Decision { judged, chosen, verdict, .. } = decision;
        let (row, all) = (&table.rows[decision.row], &self.all[..]);
        let free = self.free_form(*verdict, row)?;
        let after = corrected_model(decision, free.as_ref(), row, all, seed);
        let compared =
            self.compared(table, row, after.as_ref(), options, seed)?;
        let open = self.left_open(row, options, seed)?;
        let mut law = self.law(table, open.as_ref(), &compared, options)?;
        if after.is_none() {
            law.corrected.clear();
        }
        let group = group(judged);
        let mut diagnosis = Diagnosis {
            verdict: *verdict,
            quick: options.quick,
            odds: options.odds.clone(),
            seed: options.seed,
            rivals: decision.rivals(all, &table.as_it_was()?.none),
            separating: next_recording(*verdict, &group, judged),
            group,
            mechanisms: judged.clone(),
            withheld: decision.withheld.clone(),
            noise: decision.noises.clone(),
            selected_noise: decision.noise(row, options),
            law,
            ..compared
        };
        let forces = &row.found()?.forces;
        if !options.quick {
            (diagnosis.rest, diagnosis.left) =
                self.rest(row, after.as_ref(), seed)?;
        }
        self.write_out(&mut diagnosis, chosen.as_ref(), forces, options);
        diagnosis.forces = completed(forces, open);
        diagnosis.doubt();
        diagnosis.weak = is_weak(&diagnosis);
        Ok(diagnosis)
    }

    /// The force that is left beside what was selected.
    fn rest(
        &self,
        row: &Row<'_>,
        after: Option<&FittedModel<'_>>,
        seed: Seed,
    ) -> Result<(Option<Rest>, Option<FreeForce>)> {
        let program = row.noisy.program();
        match after {
            Some(after) if after.rough => Ok((None, None)),
            Some(FittedModel { mechanisms, fit, .. }) => {
                let seed = seed.child(50);
                let force =
                    left(program, mechanisms, fit, &self.extent, seed)?;
                Ok((force.as_ref().map(Rest::of), force))
            }
            None => {
                let forces = &row.found()?.forces;
                let over = forces.iter().find(|f| f.axis == Axis::Place);
                Ok((over.map(Rest::of), None))
            }
        }
    }

    /// From evidences to probabilities, a verdict, and what is added.
    fn decide(
        &self,
        table: &Table<'_>,
        row: usize,
        options: &Options,
        seed: Seed,
    ) -> Result<Decision> {
        let all = &self.all[..];
        let rows: Vec<Seen<'_>> = table.rows.iter().map(Seen::of).collect();
        let mut judged = judge_all(&rows, all, &options.odds);
        let verdict = verdict(&judged);
        let beforehand = Beforehand::of(&judged, &options.odds);
        let logs = log_of_noises(&rows, all, &options.odds);
        // Under its noise: what others make likely is not looked for there.
        let alone = [Seen::of(&table.rows[row])];
        let own = judge_all(&alone, all, &options.odds);
        let choice = Choice {
            noisy: &table.rows[row].noisy,
            all,
            found: table.rows[row].found()?,
            open: table.rows[row].open,
            own: &own,
            judged: &judged,
            beforehand,
            elsewhere: table.beside(row),
            singly: options.quick,
            seed,
        };
        let chosen = choice.choose(verdict)?;
        let Explained { mut verdict, chosen, equal } =
            choice.explained(verdict, chosen);
        if let Some(chosen) = &chosen {
            chosen.call(&mut judged, all);
        }
        let named_is_wrong = !table.keeps_named() && !options.infers_noise;
        if verdict == Verdict::Adequate && named_is_wrong {
            verdict = Verdict::Errors;
        }
        let noises = judged_noises(table, &logs)?;
        let withheld = None;
        Ok(Decision { judged, noises, verdict, row, chosen, equal, withheld })
    }

    /// What was chosen, terms or another noise alone, where the posterior mean
    /// with it misses the recording by more than without: then it explains the
    /// errors rather than the motion, and a corrected model must not fit
    /// worse.
    fn withheld(
        &self,
        table: &Table<'_>,
        decision: &Decision,
    ) -> Result<Option<Withheld>> {
        let (events, none) = (&self.events, &table.as_it_was()?.none);
        let noisy = &table.rows[decision.row].noisy;
        let (mechanisms, fit) = match &decision.chosen {
            Some(chosen) => (chosen.mechanisms(&self.all), &chosen.fit),
            None if decision.verdict == Verdict::Errors => {
                (Vec::new(), &noisy.none)
            }
            None => return Ok(None),
        };
        let rmse = BeforeAfter {
            before: posterior_rmse(self.program, events, &[], none)?,
            after: posterior_rmse(noisy.program(), events, &mechanisms, fit)?,
        };
        if !rmse.grows() {
            return Ok(None);
        }
        let names = mechanisms.iter().map(|m| m.name().to_owned()).collect();
        let noise = noisy.name.clone();
        Ok(Some(Withheld { names, noise, rmse }))
    }

    /// Where the mismatch is, and what the corrected model is.
    fn write_out(
        &self,
        diagnosis: &mut Diagnosis,
        chosen: Option<&Chosen>,
        forces: &[FreeForce],
        options: &Options,
    ) {
        let all = &self.all[..];
        let added = chosen.map(|c| c.mechanisms(all)).unwrap_or_default();
        let terms = chosen.map(|c| c.added(all)).unwrap_or_default();
        let (verdict, pictured) = (diagnosis.verdict, &diagnosis.pictured);
        let quantities: Vec<&str> =
            pictured.iter().map(|p| &p.quantity[..]).collect();
        // A force of free form is in no event file, nor what goes with it.
        let is_whole = chosen.is_some() || verdict == Verdict::Errors;
        let noise = (is_whole && is_other(diagnosis))
            .then(|| diagnosis.selected_noise.clone());
        diagnosis.corrected = corrected(&added, noise, options, &quantities);
        if verdict == Verdict::Unexplained {
            let line = format!("{UNKNOWN}: {FORMULA}");
            diagnosis.corrected.equation.push(line);
        }
        diagnosis.mismatch =
            mismatch(verdict, &terms, forces, &self.events, pictured);
        mark(diagnosis, &self.events);
    }

    /// The fit of the likeliest free-form force, where nothing else explains
    /// the recordings.
    fn free_form(
        &self,
        verdict: Verdict,
        row: &Row<'_>,
    ) -> Result<Option<(Box<dyn Mechanism>, Fit)>> {
        if verdict != Verdict::Unexplained {
            return Ok(None);
        }
        let (program, found) = (row.noisy.program(), row.found()?);
        let force = FreeForce::likeliest(&found.forces);
        let force = force.ok_or_else(no_density)?;
        free_fit(program, &self.extent, force, &found.none).map(Some)
    }

    /// The friction law with the rest of the physics left open; `None` of a
    /// model without friction.
    fn left_open(
        &self,
        row: &Row<'_>,
        options: &Options,
        seed: Seed,
    ) -> Result<Option<Open>> {
        if options.law.as_ref().is_some_and(Vec::is_empty) {
            return Ok(None);
        }
        let (program, forces) = (row.noisy.program(), &row.found()?.forces);
        left_open(program, &self.extent, forces, seed.child(60))
    }

    /// The law's parameters as they were, corrected, and with the rest of the
    /// physics left open.
    fn law(
        &self,
        table: &Table<'_>,
        open: Option<&Open>,
        compared: &Diagnosis,
        options: &Options,
    ) -> Result<LawParameters> {
        let Some(open) = open else { return Ok(LawParameters::default()) };
        let is_of_law = |p: &ParameterSummary| {
            // "mu" of "mu", of "mu[1]", and of an event's "C10.mu".
            let own = p.name.split('[').next().unwrap_or_default();
            let bare = own.rsplit('.').next().unwrap_or_default();
            let known = |law: &String| law == own || law == bare;
            options.law.as_ref().is_none_or(|law| law.iter().any(known))
        };
        let of = |draws: &Draws| -> Vec<ParameterSummary> {
            let all = summarise(draws);
            let all = all.iter().map(ParameterSummary::of);
            all.filter(|p| is_of_law(p)).collect()
        };
        let added = &compared.selected;
        let is_own = |p: &&ParameterSummary| {
            !added.iter().any(|name| p.within(name).is_some())
        };
        let corrected = compared.parameters.iter().filter(is_own);
        let corrected = corrected.filter(|p| is_of_law(p)).cloned();
        Ok(LawParameters {
            as_it_was: of(&table.as_it_was()?.none.draws),
            corrected: corrected.collect(),
            with_free_form_force: of(&open.own),
        })
    }

    /// Before, after, and what both predict.
    fn compared(
        &self,
        table: &Table<'_>,
        row: &Row<'_>,
        after: Option<&FittedModel<'_>>,
        options: &Options,
        seed: Seed,
    ) -> Result<Diagnosis> {
        let none = &table.as_it_was()?.none;
        let before = FittedModel {
            mechanisms: Vec::new(),
            fit: none,
            first: seed.child(30),
            rough: false,
        };
        let old = checks(self.program, &self.events, &before, None)?;
        let new = match after {
            Some(after) => {
                // Another noise has the same motion.
                let is_same = after.mechanisms.is_empty();
                let known = is_same.then_some(old.least_squares);
                checks(row.noisy.program(), &self.events, after, known)?
            }
            None => old.clone(),
        };
        let fit = after.map_or(none, |after| after.fit);
        let names: Vec<&str> =
            self.events.iter().map(|event| event.name()).collect();
        Ok(Diagnosis {
            event: names.join(" + "),
            baseline: baseline(none, &old, self.events[0], options),
            selected: after.map(FittedModel::names).unwrap_or_default(),
            improvement: improvement(none, fit, &old, &new),
            parameters: summarise(&fit.draws)
                .iter()
                .map(ParameterSummary::of)
                .filter(|p| p.within(UNKNOWN).is_none())
                .collect(),
            pictured: pictured(&self.events, &old, &new, after.is_some()),
            draws: Some(fit.draws.clone()),
            warnings: warnings(none, fit),
            ..Diagnosis::default()
        })
    }
}

/// What two fits warn of, each once.
fn warnings(none: &Fit, fit: &Fit) -> Vec<String> {
    let others = fit.warnings.iter().filter(|w| !none.warnings.contains(w));
    none.warnings.iter().chain(others).cloned().collect()
}

/// What the corrected model is, to be shown.
fn corrected_model<'a>(
    decision: &'a Decision,
    free: Option<&'a (Box<dyn Mechanism>, Fit)>,
    row: &'a Row<'_>,
    all: &'a [Box<dyn Mechanism>],
    seed: Seed,
) -> Option<FittedModel<'a>> {
    let (mechanisms, fit, rough) = match (&decision.chosen, free) {
        (Some(chosen), _) => (chosen.mechanisms(all), &chosen.fit, false),
        (None, Some((force, fit))) => (vec![force.as_ref()], fit, true),
        (None, None) if decision.takes_noise() => {
            (Vec::new(), &row.noisy.none, false)
        }
        (None, None) => return None,
    };
    Some(FittedModel { mechanisms, fit, first: seed.child(40), rough })
}

/// Forces with what is known of each as a whole.
fn completed(forces: &[FreeForce], open: Option<Open>) -> Vec<FreeForce> {
    let mut all = forces.to_vec();
    let bands = open.into_iter().flat_map(|open| open.bands);
    for (force, band) in all.iter_mut().zip(bands) {
        force.whole = band;
    }
    all
}
