//! `couloir calibrate`: a friction law with its uncertainty.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::answer::{Answer, Strict, pretty, wrapped};
use super::figures::{FOLDER, Figures};
use super::format::{Formats, Results, described};
use super::made::{Files, Made};
use super::progress::Told;
use super::results::Output;
use super::resumed::{Resumed, checkpoint, conclude};
use super::study::Read;
use super::thin::Thin;
use super::{Subject, Work, backend_giving, width};
use crate::averaged::{Open, calibrate_open};
use crate::calibrate::Calibration;
use crate::error::Result;
use crate::export::{InferenceData, Scope, gather, of_draws};
use crate::infer::{Progress, Quiet, Suited, suited};
use crate::model::{Assembled, Posterior};
use crate::physics::friction::Laws;
use crate::report::{
    calibration_json, in_words, misfit, noises, page, picture, pictures, table,
};
use crate::seed::Seed;
use crate::sweep::DRAWS;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    #[command(flatten)]
    thin: Thin,
    #[command(flatten)]
    work: Work,
    /// Backend: mh, random-walk, nuts (where built with it), smc, importance,
    /// laplace-mixture, bridge or reciprocal; where not given, mh, or
    /// laplace-mixture for an event with mechanisms, which may have several
    /// modes
    #[arg(long, value_parser = with_draws)]
    backend: Option<String>,
    /// Look quickly, to be confirmed later: at some 64 values, with
    /// 2500 draws of each chain where --draws says nothing else
    #[arg(long)]
    quick: bool,
    /// Say what is known of the law's parameters when the rest of the physics
    /// is left open, too: with a force of free form in the model
    #[arg(long)]
    rest: bool,
    #[command(flatten)]
    strict: Strict,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    formats: Formats,
    #[command(flatten)]
    figures: Figures,
}

fn with_draws(name: &str) -> Result<String, String> {
    let purpose = "yields no draws, which a calibration is made of";
    backend_giving(name, purpose, |gives| gives.draws)
}

/// What is said of a calibration with few values and draws.
const QUICK: &str = "This is a quick look, to be confirmed without --quick.";

/// What a calibration writes in any case.
const FILES: [&str; 2] = ["report.html", "calibration.json"];

/// A calibration with the model that it is of.
struct Found {
    found: Calibration,
    model: Assembled,
}

impl Arguments {
    /// The events that are named.
    pub(super) fn paths(&self) -> &[PathBuf] {
        self.subject.paths()
    }

    pub(super) fn run(
        &self,
        laws: &Laws,
        told: &Told,
        typed: &str,
    ) -> Result<Answer> {
        let mut names = [&FILES[..], &self.formats.names()].concat();
        names.extend(self.figures.figures.then_some(FOLDER));
        let results = self.output.ready(&names, self.subject.paths())?;
        let out = self.output.out.as_deref();
        let kept = checkpoint(out, &self.computed(), told)?;
        let heard = Resumed { heard: told, checkpoint: kept.as_ref() };
        let Found { found, model } = self.found(laws, &heard, typed)?;
        told.finish();
        let data = match self.formats.have_data() {
            true => gathered(&found, &model),
            false => Ok(described(InferenceData::default(), &found.report)),
        };
        let left_out = data.as_ref().ok();
        let json = self.json(&found, left_out);
        let wrote = data.and_then(|data| {
            results.write(|| self.files(&found, &json, &data))
        });
        conclude(kept, &wrote);
        let text = match self.output.json {
            true => json,
            false => tell(&found) + &results.told(&wrote, &names, width()),
        };
        let answer = self.strict.answer(text, &found.report.doubts);
        Ok(answer.after(wrote))
    }

    /// All that the calibration follows from.
    fn computed(&self) -> String {
        let options = (&self.work, &self.backend, self.quick, self.rest);
        // What is wrong with them is told where the event is read.
        let inputs = self.subject.inputs().ok();
        format!("{:?} {:?} {options:?} {inputs:?}", self.subject, self.thin)
    }

    /// The same without a folder or a terminal.
    pub(super) fn made(
        &self,
        laws: &Laws,
        progress: &dyn Progress,
        typed: &str,
    ) -> Result<Made> {
        let Found { found, model } = self.found(laws, progress, typed)?;
        let json = self.json(&found, None);
        let files = self.files(&found, &json, &InferenceData::default())?;
        let reads = self.subject.paths().to_vec();
        Ok(Made { files, reads, data: gathered(&found, &model) })
    }

    /// `calibration.json` alone, with draws of the law's parameters.
    pub(super) fn document(&self, laws: &Laws) -> Result<Value> {
        let Found { found, model } = self.found(laws, &Quiet, "")?;
        let mut value = self.value(&found, None);
        value[DRAWS] = draws_of_law(&found, &model);
        Ok(value)
    }

    /// The event's calibration, with where it comes from.
    fn found(
        &self,
        laws: &Laws,
        progress: &dyn Progress,
        typed: &str,
    ) -> Result<Found> {
        let thin = self.thin.quickly(self.quick);
        let subject = Subject { thin, ..self.subject.clone() };
        let mut read = subject.read(laws)?;
        if self.quick {
            read.said.note([QUICK.to_owned()]);
        }
        // Summed before the work, as they were read.
        let origin = subject.origin(typed)?;
        let mut found = self.calibrated(read, progress)?;
        found.found.report.origin = origin;
        Ok(found)
    }

    /// `calibration.json`.
    fn json(
        &self,
        found: &Calibration,
        data: Option<&InferenceData>,
    ) -> String {
        pretty(&self.value(found, data))
    }

    fn value(
        &self,
        found: &Calibration,
        data: Option<&InferenceData>,
    ) -> Value {
        let mut json = calibration_json(&found.report);
        json["quick"] = self.quick.into();
        if let Some(left_out) = data.and_then(|d| d.left_out.as_ref()) {
            json["loo"] = left_out.json();
        }
        json
    }

    fn files(
        &self,
        found: &Calibration,
        json: &str,
        data: &InferenceData,
    ) -> Result<Files> {
        let texts = [page(&found.report), json.to_owned()];
        let texts = texts.map(String::into_bytes);
        let names = FILES.into_iter().map(PathBuf::from);
        let mut files: Files = names.zip(texts).collect();
        let (draws, report) = (&found.draws, &found.report);
        files.extend(self.formats.files(&Results { draws, report, data })?);
        if self.figures.figures {
            let all = pictures(report).into_iter();
            let all =
                all.map(|picture| (picture.name.to_owned(), picture.svg));
            files.extend(self.figures.files(all)?);
        }
        Ok(files)
    }

    fn calibrated(
        &self,
        read: Read,
        progress: &dyn Progress,
    ) -> Result<Found> {
        let Read { model, infers_noise, said } = read;
        let work = self.work.quickly(self.quick);
        let (backend, why) = match &self.backend {
            Some(name) => (work.backend(name)?, None),
            None => {
                let Suited { backend, why } =
                    suited(&model, infers_noise, &work.effort()?)?;
                (backend, Some(why.to_owned()))
            }
        };
        let mut open = Open::default();
        (open.noise, open.rest) = (infers_noise, self.rest);
        let seed = self.work.seed;
        let mut found =
            calibrate_open(&model, open, backend.as_ref(), seed, progress)?;
        found.report.backend_why = why;
        found.report.notes = said.notes;
        found.report.warnings.splice(..0, said.warnings);
        Ok(Found { found, model })
    }
}

/// How many draws a document has of each parameter: what a population of
/// events says is then off by less than a tenth of its standard deviation
/// (docs/population.md), at 6 kB for two parameters.
const KEPT: usize = 300;

/// Some of the draws of the law's parameters, by their names, to six digits:
/// more than a draw is worth.
fn draws_of_law(found: &Calibration, model: &Assembled) -> Value {
    let rows = found.draws.thinned(KEPT);
    let column = |name: String| {
        let at = found.draws.names().iter().position(|own| *own == name)?;
        let six = |x: f64| format!("{x:.5e}").parse().unwrap_or(x);
        let values: Vec<f64> = rows.iter().map(|row| six(row[at])).collect();
        Some((name, Value::from(values)))
    };
    model.law_names().into_iter().filter_map(column).collect()
}

/// The draws with what they say of the data.
///
/// Draws averaged over noises are of no single model, and stay alone.
fn gathered(found: &Calibration, model: &Assembled) -> Result<InferenceData> {
    let draws = &found.draws;
    let data = match found.report.noises.is_empty() {
        false => of_draws(draws, &[])?,
        true => {
            let posterior = Posterior::new(model)?;
            let seed = Seed::new(found.report.seed).called("export");
            gather(&posterior, draws, &Scope::default(), seed)?
        }
    };
    Ok(described(data, &found.report))
}

fn tell(found: &Calibration) -> String {
    let width = width();
    let mut text = String::new();
    let words = in_words(&found.report);
    let misfits = usize::from(misfit(&found.report).is_some());
    // Whether the model fits stands above all.
    for sentence in &words[..misfits] {
        text.push_str(&wrapped(sentence, width));
        text.push('\n');
    }
    text.push_str(&picture(&found.report, width, 16));
    text.push('\n');
    text.push_str(&table(&found.report, width));
    text.push('\n');
    let noises = noises(&found.report, width);
    if !noises.is_empty() {
        text.push_str(&noises);
        text.push('\n');
    }
    for sentence in &words[misfits..] {
        text.push_str(&wrapped(sentence, width));
    }
    let report = &found.report;
    let run = format!(
        "{}: {} simulations, {:.2} s, seed {}",
        report.backend_told(),
        report.simulations,
        report.seconds,
        report.seed
    );
    text.push('\n');
    text.push_str(&wrapped(&run, width));
    text
}
