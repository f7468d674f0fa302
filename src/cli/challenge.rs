//! `couloir challenge`: hidden effects, diagnosed without the answer.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use clap::Args;

use super::answer;
use super::answer::{pretty, wrapped};
use super::pace::Pace;
use super::progress::Told;
use super::results::{Results, folder};
use super::resumed::{Resumed, checkpoint, conclude};
use super::study::assemble;
use super::{at_least_one, width};
use crate::challenge::{
    Answer, Case, Coordinate, Errors, Interval, Mix, PowerTable, Scored,
    cases, challenge_json, page, power_cases, power_page, run, words,
};
use crate::checkpoint::Checkpoint;
use crate::diagnosis::{
    Diagnosis, Options, Sharing, Together, diagnose, diagnose_together,
};
use crate::error::{Error, Result};
use crate::infer::Quiet;
use crate::io::parse_event;
use crate::model::Assembled;
use crate::physics::forces::Axis;
use crate::physics::friction::Laws;
use crate::report::Origin;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// How many cases with an effect of the catalogue; half as many hide
    /// nothing, a fifth something outside the catalogue
    #[arg(long, default_value_t = 200, value_parser = at_least_one)]
    cases: usize,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1, value_parser = super::seed)]
    seed: u64,
    /// How many recordings, from different starts, share an effect: 1 or 2
    #[arg(long, default_value_t = 1, value_parser = one_or_two)]
    recordings: usize,
    /// Errors in the recordings: simple, independent and normal as the events
    /// say; or real, smooth, drifting, correlated, with outliers or growing,
    /// while the events say ar(1)
    #[arg(long, value_name = "simple|real", default_value = "simple",
          value_parser = errors, conflicts_with = "power")]
    errors: Errors,
    /// Study instead what size of this mechanism is seen in what noise
    #[arg(long, value_name = "MECHANISM")]
    power: Option<String>,
    /// Diagnose as --quick does, at the recordings' own rates
    #[arg(long)]
    quick: bool,
    /// Folder to write the page and challenge.json to
    #[arg(long, value_name = "DIR", value_parser = folder)]
    out: Option<PathBuf>,
    /// Print one JSON document instead of the words
    #[arg(long)]
    json: bool,
}

/// The sizes of the power study, as shares of the largest, and its noises
/// \[m/s\].
const SIZES: [f64; 5] = [0.1, 0.2, 0.4, 0.7, 1.0];
const NOISES: [f64; 3] = [0.1, 0.3, 0.9];

/// How long a case of one recording takes, and of two, on one processor of
/// 2026 \[s\]; what it takes here is told once some are done.
const SECONDS: [f64; 2] = [8.0, 20.0];
/// The same of a quick look.
const QUICK_SECONDS: [f64; 2] = [2.0, 5.0];

impl Arguments {
    pub(super) fn run(
        &self,
        told: &Told,
        typed: &str,
    ) -> Result<answer::Answer> {
        // It makes what it reads, by the seed.
        let command = typed.to_owned();
        let origin = Origin { command, ..Origin::default() };
        match &self.power {
            Some(mechanism) => self.study(mechanism, &origin, told),
            None => self.score(&origin, told),
        }
    }

    fn mix(&self) -> Mix {
        if self.recordings == 2 { Mix::Two } else { Mix::One }
    }

    /// What is kept of a run that was stopped.
    fn kept(&self, told: &Told) -> Result<Option<Checkpoint>> {
        let Self { cases, seed, recordings, errors, power, quick, .. } = self;
        let of = (cases, seed, recordings, errors, power, quick);
        checkpoint(self.out.as_deref(), &format!("challenge {of:?}"), told)
    }

    /// The diagnoses of all cases.
    fn scored(
        &self,
        all: &[Case],
        kept: Option<&Checkpoint>,
        told: &Told,
    ) -> Result<Scored> {
        let all_of = if self.quick { QUICK_SECONDS } else { SECONDS };
        let each = all_of[usize::from(self.recordings == 2)];
        let answered = kept.map_or(0, Checkpoint::parts);
        let pace = Pace::begun(all.len(), answered, each, told);
        let heard = Resumed { heard: &pace, checkpoint: kept };
        let answer = |case: &Case| answer(case, self.seed, self.quick);
        let scored = run(all, &answer, true, &heard);
        told.finish();
        scored
    }

    fn score(&self, origin: &Origin, told: &Told) -> Result<answer::Answer> {
        let files = ["challenge.html", "challenge.json"];
        let results = Results::ready(self.out.as_deref(), &files, &[])?;
        let all = cases(self.cases, self.seed, self.mix(), self.errors)?;
        let kept = self.kept(told)?;
        let scored = self.scored(&all, kept.as_ref(), told)?;
        let mut document = challenge_json(&scored);
        document["seed"] = self.seed.into();
        document["quick"] = self.quick.into();
        origin.write_to(&mut document);
        let json = pretty(&document);
        let wrote = results.write(|| {
            let (mix, errors) = (self.mix(), self.errors);
            let page = page(&scored, mix, errors, self.seed, origin);
            Ok(files.into_iter().zip([page, json.clone()]).collect())
        });
        conclude(kept, &wrote);
        if self.json {
            return Ok(answer::Answer::from(json).after(wrote));
        }
        let width = width();
        let mut text: String =
            words(&scored).iter().map(|s| wrapped(s, width)).collect();
        text.push_str(&results.told(&wrote, &files, width));
        Ok(answer::Answer::from(text).after(wrote))
    }

    fn study(
        &self,
        mechanism: &str,
        origin: &Origin,
        told: &Told,
    ) -> Result<answer::Answer> {
        let results =
            Results::ready(self.out.as_deref(), &["power.html"], &[])?;
        let count = self.cases.div_ceil(SIZES.len() * NOISES.len());
        let all = power_cases(mechanism, &SIZES, &NOISES, count, self.seed)?;
        let kept = self.kept(told)?;
        let scored = self.scored(&all, kept.as_ref(), told)?;
        let tables: Vec<PowerTable> = PowerTable::of(&scored.outcomes);
        let wrote = results.write(|| {
            Ok(vec![("power.html", power_page(&tables, self.seed, origin))])
        });
        conclude(kept, &wrote);
        let text: String = tables.iter().map(PowerTable::markdown).collect();
        Ok(answer::Answer::from(text).after(wrote))
    }
}

fn one_or_two(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 1..=2) => Ok(n),
        _ => Err("expected 1 or 2".into()),
    }
}

fn errors(text: &str) -> Result<Errors, String> {
    let expected = || format!("expected {}", Errors::NAMES.join(" or "));
    Errors::named(text).ok_or_else(expected)
}

/// What the diagnosis says of a case, from its recordings alone.
fn answer(case: &Case, seed: u64, quick: bool) -> Result<Answer> {
    let mut models = case
        .recordings
        .iter()
        .map(|recording| model_of(&recording.files))
        .collect::<Result<Vec<_>>>()?;
    let found = if models.len() > 1 {
        let together = Together::with_one_law(models)?;
        let mut options = Options::of_all(&together, seed);
        options.quick = quick;
        diagnose_together(&together, Sharing::Shared, &options, &Quiet)?
    } else {
        let model = models
            .pop()
            .ok_or_else(|| Error::input("a case without a recording"))?;
        let mut options = Options::of(&model, seed);
        options.quick = quick;
        diagnose(&model, model.event(), &options, &Quiet)?
    };
    Ok(answer_of(&found))
}

/// The model that an event folder's files ask for.
fn model_of(files: &[(&'static str, String)]) -> Result<Assembled> {
    let text = |name: &str| {
        files
            .iter()
            .find(|(file, _)| *file == name)
            .map(|(_, text)| text.clone())
            .ok_or_else(|| Error::input(format!("{name} is missing")))
    };
    let open = |name: &str| {
        text(name).map(|text| (Cursor::new(text), PathBuf::from(name)))
    };
    let laws = Laws::default();
    let event = text("event.toml")?;
    let file = parse_event(&event, Path::new("event.toml"), open, &laws)?;
    assemble(file, &laws, None, None, None)
}

fn answer_of(found: &Diagnosis) -> Answer {
    Answer {
        verdict: found.verdict.name().to_owned(),
        noises: found
            .noise
            .iter()
            .map(|n| (n.name.clone(), n.probability))
            .collect(),
        probabilities: found
            .mechanisms
            .iter()
            .map(|m| (m.name.clone(), m.probability))
            .collect(),
        group: found.group.clone(),
        mismatch: found
            .mismatch
            .iter()
            .map(|m| Interval {
                coordinate: match m.axis {
                    Axis::Time => Coordinate::Time,
                    _ => Coordinate::Arclength,
                },
                from: m.from,
                to: m.to,
                time_from: m.time_from,
                time_to: m.time_to,
            })
            .collect(),
        rmse_before: found.improvement.rmse.before,
        rmse_after: found.improvement.rmse.after,
        least_squares_before: found.improvement.least_squares.before,
        least_squares_after: found.improvement.least_squares.after,
        heldout_rmse_after: found.improvement.heldout_rmse.after,
        seconds: found.seconds,
    }
}
