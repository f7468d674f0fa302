//! `couloir diagnose`: where simulation and recording differ, and what was
//! left out.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::answer::{Answer, Strict, pretty};
use super::figures::{FOLDER, Figures};
use super::format::{Formats, Results, described};
use super::made::{Files, Made};
use super::progress::Told;
use super::results::Output;
use super::said::Said;
use super::study::Read;
use super::thin::Thin;
use super::{Subject, width};
use crate::calibrate::of_summary;
use crate::diagnosis::{
    Diagnosis, Odds, Options, Sharing, Together, diagnose, diagnose_together,
    page, pictures, summary,
};
use crate::draws::{Draws, summarise};
use crate::error::{Error, Result};
use crate::export::{InferenceData, of_draws};
use crate::infer::{Backend, LaplaceMixture, Progress, Quiet};
use crate::io::place;
use crate::model::Assembled;
use crate::observe::Series;
use crate::physics::friction::Laws;
use crate::report::{CalibrationReport, Origin};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Event folders, or their event.toml, several to be explained together;
    /// a passenger car coasting uphill, a real recording, with Coulomb
    /// friction alone, where none is given
    events: Vec<PathBuf>,
    /// Friction law instead of the event's
    #[arg(long, value_name = "LAW")]
    friction: Option<String>,
    /// Noise instead of the event's: iid, ar(k), student, or one or a sum of
    /// white, ou, matern32, ar(k), tails, growth, such as "matern32 + white";
    /// or infer: whichever is likely, none of them preferred
    #[arg(long, value_name = "NOISE")]
    noise: Option<String>,
    /// Prior odds of a mechanism against 1 for each other, such as
    /// friction-patch=3; `none` against all others together
    #[arg(long, value_name = "NAME=ODDS", value_parser = odds)]
    odds: Vec<(String, f64)>,
    /// One friction law for all events, instead of one for each
    #[arg(long)]
    one_law: bool,
    /// Let the amount of what is missing differ from event to event
    #[arg(long)]
    pooled: bool,
    #[command(flatten)]
    thin: Thin,
    /// Diagnose again at half the recordings' rate, and warn where that
    /// changes verdict or group; takes twice the time
    #[arg(long, conflicts_with = "quick")]
    check_rate: bool,
    /// Look quickly, to be confirmed later: at some 64 values, under one
    /// noise, at one mechanism at a time
    #[arg(long)]
    quick: bool,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1, value_parser = super::seed)]
    seed: u64,
    #[command(flatten)]
    strict: Strict,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    formats: Formats,
    #[command(flatten)]
    figures: Figures,
}

fn odds(text: &str) -> Result<(String, f64), String> {
    let expected = "expected NAME=ODDS with odds above 0, such as surge=0.5";
    let (name, number) = text.split_once('=').ok_or(expected)?;
    match number.trim().parse::<f64>() {
        Ok(odds) if odds > 0.0 && odds.is_finite() => {
            Ok((name.trim().to_owned(), odds))
        }
        _ => Err(expected.into()),
    }
}

/// The folder of the events with what was found, within that of the results,
/// where there is something to correct.
const CORRECTED: &str = "corrected/";

/// What a diagnosis writes in any case.
const FILES: [&str; 2] = ["report.html", "diagnosis.json"];

/// A diagnosis with what it is of.
struct Found {
    found: Diagnosis,
    /// What each of several events is called by.
    labels: Vec<String>,
}

impl Arguments {
    /// The events that are named.
    pub(super) fn paths(&self) -> &[PathBuf] {
        &self.events
    }

    pub(super) fn run(
        &self,
        laws: &Laws,
        told: &Told,
        typed: &str,
    ) -> Result<Answer> {
        self.refuse_for_one()?;
        let subjects = self.subjects(&self.thin.quickly(self.quick));
        let mut names =
            [&FILES[..], &self.formats.names(), &[FOLDER, CORRECTED]].concat();
        let results = self.output.ready(&names, &self.events)?;
        let Found { mut found, labels } = self.found(&subjects, laws, told)?;
        found.origin.command = typed.to_owned();
        told.finish();
        let json = found.json();
        let wrote = results.write(|| {
            let again = corrected(&subjects, &labels, &found, laws)?;
            if again.is_empty() {
                names.pop();
            }
            let data = draws_of(&found, &labels)?;
            let mut files = self.reports(&found, &json, &data)?;
            files.extend(again);
            Ok(files)
        });
        let text = match self.output.json {
            true => pretty(&json),
            false => {
                summary(&found, width())
                    + &results.told(&wrote, &names, width())
            }
        };
        Ok(self.strict.answer(text, &found.doubts).after(wrote))
    }

    /// The same without a folder or a terminal.
    pub(super) fn made(
        &self,
        laws: &Laws,
        progress: &dyn Progress,
        typed: &str,
    ) -> Result<Made> {
        let subjects = self.subjects(&self.thin.quickly(self.quick));
        let Found { mut found, labels } =
            self.found(&subjects, laws, progress)?;
        found.origin.command = typed.to_owned();
        let data = draws_of(&found, &labels);
        let none = InferenceData::default();
        let mut files = self.reports(
            &found,
            &found.json(),
            data.as_ref().unwrap_or(&none),
        )?;
        files.extend(corrected(&subjects, &labels, &found, laws)?);
        Ok(Made { files, reads: self.events.clone(), data })
    }

    /// `diagnosis.json` alone.
    pub(super) fn document(&self, laws: &Laws) -> Result<Value> {
        let subjects = self.subjects(&self.thin.quickly(self.quick));
        Ok(self.found(&subjects, laws, &Quiet)?.found.json())
    }

    fn reports(
        &self,
        found: &Diagnosis,
        json: &Value,
        data: &InferenceData,
    ) -> Result<Files> {
        let texts =
            [("report.html", page(found)), ("diagnosis.json", pretty(json))];
        let mut files: Files =
            texts.map(|(name, text)| (name.into(), text.into_bytes())).into();
        if let Some(draws) = &found.draws {
            let report = &corrected_report(found, draws);
            let results = Results { draws, report, data };
            files.extend(self.formats.files(&results)?);
        }
        files.extend(self.figures.files(pictures(found))?);
        Ok(files)
    }

    /// The diagnosis of the events and, where that was asked for, what
    /// another at half the rate makes of it.
    fn found(
        &self,
        subjects: &[Subject],
        laws: &Laws,
        progress: &dyn Progress,
    ) -> Result<Found> {
        let read = read_all(subjects, laws)?;
        // Looked at before the work and not after.
        let halved = self.subjects(&self.thin.halved());
        let halved =
            self.check_rate.then(|| read_all(&halved, laws)).transpose()?;
        let mut said = Said::of_all(read.iter().map(|one| &one.said));
        said.warnings.splice(..0, same_recordings(subjects, &read));
        // Summed before the work, as they were read.
        let sums =
            subjects.iter().map(Subject::inputs).collect::<Result<_>>()?;
        let (mut found, labels) = self.diagnose(read, progress)?;
        found.notes = said.notes;
        if let Some(read) = halved {
            let (again, _) = self.diagnose(read, progress)?;
            found.check_rate(&again);
        }
        found.warnings.splice(..0, said.warnings);
        let inputs = inputs(sums, &labels);
        found.origin = Origin { inputs, ..Origin::default() };
        Ok(Found { found, labels })
    }

    /// Each event with what the command line changes of it.
    fn subjects(&self, thin: &Thin) -> Vec<Subject> {
        let of = |event: Option<PathBuf>| Subject {
            friction: self
                .friction
                .clone()
                .or_else(|| event.is_none().then(|| "coulomb".to_owned())),
            noise: self.noise.clone(),
            thin: thin.clone(),
            event,
        };
        if self.events.is_empty() {
            return vec![of(None)];
        }
        self.events.iter().cloned().map(Some).map(of).collect()
    }

    /// Refuses what is for several events where there is one.
    fn refuse_for_one(&self) -> Result<()> {
        let asked = [("--one-law", self.one_law), ("--pooled", self.pooled)];
        match asked.into_iter().find(|(_, asked)| *asked) {
            Some((name, _)) if self.events.len() < 2 => {
                Err(Error::input(format!(
                    "{name} is of several events, and one is given; expected \
                     two at least: name the others, or drop {name}"
                )))
            }
            _ => Ok(()),
        }
    }

    /// The diagnosis, and what each of several events is called by.
    fn diagnose(
        &self,
        read: Vec<Read>,
        progress: &dyn Progress,
    ) -> Result<(Diagnosis, Vec<String>)> {
        let infers_noise = read.iter().all(|one| one.infers_noise);
        let mut models: Vec<Assembled> =
            read.into_iter().map(|one| one.model).collect();
        let odds = || self.odds.iter().cloned().collect::<Odds>();
        if models.len() > 1 {
            let together = match self.one_law {
                true => Together::with_one_law(models)?,
                false => Together::new(models)?,
            };
            let mut options = Options::of_all(&together, self.seed);
            (options.odds, options.infers_noise) = (odds(), infers_noise);
            options.quick = self.quick;
            let sharing =
                if self.pooled { Sharing::Pooled } else { Sharing::Shared };
            let found =
                diagnose_together(&together, sharing, &options, progress)?;
            return Ok((found, together.labels().to_vec()));
        }
        let model =
            models.pop().ok_or_else(|| Error::input("no event was given"))?;
        let mut options = Options::of(&model, self.seed);
        (options.odds, options.infers_noise) = (odds(), infers_noise);
        options.quick = self.quick;
        let found = diagnose(&model, model.event(), &options, progress)?;
        Ok((found, Vec::new()))
    }
}

fn read_all(subjects: &[Subject], laws: &Laws) -> Result<Vec<Read>> {
    subjects.iter().map(|event| event.read(laws)).collect()
}

/// A warning where a recording is given twice, by whatever path.
fn same_recordings(subjects: &[Subject], read: &[Read]) -> Option<String> {
    let of = |one: &Read| one.model.event().recordings().next().cloned();
    let all: Vec<Option<Series>> = read.iter().map(of).collect();
    let again = |i: usize| (0..i).find(|k| all[*k] == all[i]);
    let (i, k) = (0..all.len()).find_map(|i| Some((i, again(i)?)))?;
    let path = |at: usize| subjects[at].paths().first();
    let [first, second] = [k, i].map(|at| path(at).map(|path| place(path)));
    Some(format!(
        "{} and {} have the same recording: taken for two, it makes all that \
         is said surer than it is; give each recording once",
        first.unwrap_or_default(),
        second.unwrap_or_default()
    ))
}

/// The checksums of what was read, after the events' labels where there are
/// several.
fn inputs(
    sums: Vec<BTreeMap<String, String>>,
    labels: &[String],
) -> BTreeMap<String, String> {
    let labelled = |(i, sums): (usize, BTreeMap<String, String>)| {
        let label = labels.get(i).map_or(String::new(), |l| format!("{l}/"));
        let named = move |(name, sum)| (format!("{label}{name}"), sum);
        sums.into_iter().map(named)
    };
    sums.into_iter().enumerate().flat_map(labelled).collect()
}

/// The draws of the corrected model; without a group where there are none.
fn draws_of(found: &Diagnosis, labels: &[String]) -> Result<InferenceData> {
    let Some(draws) = &found.draws else {
        return Ok(InferenceData::default());
    };
    Ok(described(of_draws(draws, labels)?, &corrected_report(found, draws)))
}

/// The corrected model's figures, as those of a calibration are told.
fn corrected_report(found: &Diagnosis, draws: &Draws) -> CalibrationReport {
    CalibrationReport {
        origin: found.origin.clone(),
        event: found.event.clone(),
        friction: found.baseline.friction.clone(),
        noise: found.selected_noise.clone(),
        mechanisms: found.corrected.labels.clone(),
        backend: LaplaceMixture::default().name().to_owned(),
        seed: found.seed,
        parameters: summarise(draws).iter().map(of_summary).collect(),
        ..CalibrationReport::default()
    }
}

/// The events again, with the mechanisms that were found, each in a folder of
/// its own where there are several; none where nothing of the catalogue was
/// and the errors are those named.
fn corrected(
    subjects: &[Subject],
    labels: &[String],
    found: &Diagnosis,
    laws: &Laws,
) -> Result<Files> {
    let had = found.baseline.mechanisms.len();
    let added = found.corrected.labels.get(had..).unwrap_or_default();
    let other = found.corrected.noise.as_deref();
    if added.is_empty() && other.is_none() {
        return Ok(Files::new());
    }
    let mut files = Files::new();
    for (i, event) in subjects.iter().enumerate() {
        let mut folder = PathBuf::from(CORRECTED);
        folder.extend(labels.get(i));
        let event = event.corrected(laws, added, other)?.into_iter();
        files.extend(
            event.map(|(name, text)| (folder.join(name), text.into())),
        );
    }
    Ok(files)
}
