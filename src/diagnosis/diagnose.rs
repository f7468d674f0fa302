//! The whole diagnosis: weigh, locate, decide, compare, tell.

use std::time::Instant;

use crate::diagnosis::compare::baseline::baseline;
use crate::diagnosis::compare::checks::{
    FittedModel, checks, improvement, pictured,
};
use crate::diagnosis::decide::choose::{Choice, Chosen};
use crate::diagnosis::decide::judge::{
    Beforehand, check_odds, group, judge, separating, verdict,
};
use crate::diagnosis::evidence::attribute::{Attribution, attribute};
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::findings::{
    Diagnosis, Judged, LawParameters, ParameterSummary, Verdict,
};
use crate::diagnosis::hypothesis::{NONE, UNKNOWN};
use crate::diagnosis::locate::{FreeForce, free_fit, own_draws};
use crate::diagnosis::options::Options;
use crate::diagnosis::tell::paste::corrected;
use crate::diagnosis::tell::place::{mark, mismatch};
use crate::diagnosis::together::Sharing;
use crate::draws::{Draws, summarise};
use crate::error::{Error, Result};
use crate::infer::Progress;
use crate::mechanism::Mechanism;
use crate::mechanism::catalogue::is_held;
use crate::model::{Member, Program, Together, declared_blocks};
use crate::observe::{Event, Extent};
use crate::seed::Seed;

/// Finds where a model and a recording differ and what was left out.
///
/// # Errors
/// An improper prior, odds of what is not weighed, a mechanism of one's own
/// that cannot be told from others, an event without a recording, or a model
/// that fails.
pub fn diagnose<P: Program>(
    program: &P,
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
struct Subject<'a, P> {
    program: &'a P,
    events: Vec<&'a Event>,
    extent: Extent,
    all: Vec<Box<dyn Mechanism>>,
}

/// What was decided from the evidence.
struct Decision {
    /// Everything that was weighed, most probable first.
    judged: Vec<Judged>,
    verdict: Verdict,
    /// What is added to the model.
    chosen: Option<Chosen>,
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
        check_odds(&options.odds, all)?;
        let seed_of = seed.child(0);
        let found =
            attribute(program, Some(&self.extent), all, seed_of, progress)?;
        progress.begin("weighing pairs", None);
        let Decision { judged, verdict, chosen } =
            self.decide(&found, options, seed)?;
        progress.begin("showing", None);
        let free = self.free_form(verdict, &found)?;
        let after = corrected_model(chosen.as_ref(), free.as_ref(), all, seed);
        let compared =
            self.compared(&found.none, after.as_ref(), options, seed)?;
        let law = self.law(&found, &compared, options)?;
        let group = group(&judged);
        let rivals = chosen.as_ref().map(|c| c.rivals(all, &found.none));
        let mut diagnosis = Diagnosis {
            verdict,
            rivals: rivals.unwrap_or_default(),
            separating: separating(&group, &judged),
            group,
            mechanisms: judged,
            law,
            ..compared
        };
        self.write_out(&mut diagnosis, chosen.as_ref(), &found, options);
        diagnosis.forces = found.forces;
        diagnosis.seconds = begun.elapsed().as_secs_f64();
        Ok(diagnosis)
    }

    /// From evidences to probabilities, a verdict, and what is added.
    fn decide(
        &self,
        found: &Attribution,
        options: &Options,
        seed: Seed,
    ) -> Result<Decision> {
        let (program, all) = (self.program, &self.all[..]);
        let mut judged = judge(found, all, &options.odds);
        let verdict = verdict(&judged);
        let beforehand = Beforehand::of(&judged, &options.odds);
        let choice =
            Choice { program, all, found, judged: &judged, beforehand, seed };
        let chosen = choice.choose(verdict)?;
        let (verdict, chosen) = choice.explained(verdict, chosen);
        if let Some(chosen) = &chosen {
            chosen.call(&mut judged, all);
        }
        Ok(Decision { judged, verdict, chosen })
    }

    /// Where the mismatch is, and what the corrected model is.
    fn write_out(
        &self,
        diagnosis: &mut Diagnosis,
        chosen: Option<&Chosen>,
        found: &Attribution,
        options: &Options,
    ) {
        let all = &self.all[..];
        let added = chosen.map(|c| c.mechanisms(all)).unwrap_or_default();
        let reaches = chosen.map(|c| c.reaches(all)).unwrap_or_default();
        let (verdict, pictured) = (diagnosis.verdict, &diagnosis.pictured);
        let quantity = pictured.first().map_or("", |p| &p.quantity);
        diagnosis.corrected = corrected(&added, options, quantity);
        diagnosis.mismatch =
            mismatch(verdict, &reaches, &found.forces, &self.events, pictured);
        mark(diagnosis, &self.events);
    }

    /// The fit of the likeliest free-form force, where nothing else explains
    /// the recordings.
    fn free_form(
        &self,
        verdict: Verdict,
        found: &Attribution,
    ) -> Result<Option<(Box<dyn Mechanism>, Fit)>> {
        if verdict != Verdict::Unexplained {
            return Ok(None);
        }
        let force = most_probable(&found.forces)?;
        free_fit(self.program, &self.extent, force, &found.none).map(Some)
    }

    /// The law's parameters as they were, corrected, and with the rest of the
    /// physics left open.
    fn law(
        &self,
        found: &Attribution,
        compared: &Diagnosis,
        options: &Options,
    ) -> Result<LawParameters> {
        let is_of_law = |p: &ParameterSummary| {
            // "mu" of "mu", of "mu[1]", and of an event's "C10.mu".
            let own = p.name.split('[').next().unwrap_or_default();
            let bare = own.rsplit('.').next().unwrap_or_default();
            let known = |law: &String| law == own || law == bare;
            options.law.is_empty() || options.law.iter().any(known)
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
        let open = own_draws(self.program, &found.forces)?;
        Ok(LawParameters {
            as_it_was: of(&found.none.draws),
            corrected: match added.is_empty() {
                true => Vec::new(),
                false => corrected.collect(),
            },
            with_free_form_force: of(&open),
        })
    }

    /// Before, after, and what both predict.
    fn compared(
        &self,
        none: &Fit,
        after: Option<&FittedModel<'_>>,
        options: &Options,
        seed: Seed,
    ) -> Result<Diagnosis> {
        let before = FittedModel {
            mechanisms: Vec::new(),
            fit: none,
            first: seed.child(30),
            rough: false,
        };
        let old = checks(self.program, &self.events, &before)?;
        let new = match after {
            Some(after) => checks(self.program, &self.events, after)?,
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
            warnings,
            ..Diagnosis::default()
        })
    }
}

/// What the corrected model is, to be shown.
fn corrected_model<'a>(
    chosen: Option<&'a Chosen>,
    free: Option<&'a (Box<dyn Mechanism>, Fit)>,
    all: &'a [Box<dyn Mechanism>],
    seed: Seed,
) -> Option<FittedModel<'a>> {
    let (mechanisms, fit, rough) = match (chosen, free) {
        (Some(chosen), _) => (chosen.mechanisms(all), &chosen.fit, false),
        (None, Some((force, fit))) => (vec![force.as_ref()], fit, true),
        (None, None) => return None,
    };
    Some(FittedModel { mechanisms, fit, first: seed.child(40), rough })
}

/// The free-form force along the axis with the most evidence.
fn most_probable(forces: &[FreeForce]) -> Result<&FreeForce> {
    forces
        .iter()
        .max_by(|a, b| a.log_bayes_factor.total_cmp(&b.log_bayes_factor))
        .ok_or_else(|| Error::inference("no free-form force was inferred"))
}
