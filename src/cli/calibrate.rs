//! `couloir calibrate`: a friction law with its uncertainty.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::answer::{Answer, Strict};
use super::format::Formats;
use super::progress::Told;
use super::results::Output;
use super::study::Read;
use super::thin::Thin;
use super::{Subject, Work, backend_giving, width};
use crate::averaged::{Open, calibrate_open};
use crate::calibrate::Calibration;
use crate::error::Result;
use crate::infer::{Suited, suited};
use crate::model::Assembled;
use crate::physics::friction::Laws;
use crate::report::{
    PROGRAM, calibration_json, in_words, noises, page, picture, table,
};

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
}

fn with_draws(name: &str) -> Result<String, String> {
    let purpose = "yields no draws, which a calibration is made of";
    backend_giving(name, purpose, |gives| gives.draws)
}

/// What a calibration writes in any case.
const FILES: [&str; 2] = ["report.html", "calibration.json"];

/// A calibration with the model that it is of.
struct Found {
    found: Calibration,
    model: Assembled,
}

impl Arguments {
    pub(super) fn run(&self, laws: &Laws) -> Result<Answer> {
        let subject =
            Subject { thin: self.thin.clone(), ..self.subject.clone() };
        let names = [&FILES[..], &self.formats.names()].concat();
        let results = self.output.ready(&names, subject.paths())?;
        let read = subject.read(laws)?;
        // Summed before the work, as they were read.
        let inputs = json!(read.inputs);
        let Found { found, model } = self.found(read)?;
        let data = self.formats.data(&found, &model, &inputs);
        let mut json = calibration_json(&found.report);
        json["inputs"] = inputs;
        json["program"] = PROGRAM.into();
        if let Ok(Some(left_out)) = data.as_ref().map(|d| &d.left_out) {
            json["loo"] = left_out.json();
        }
        let json = pretty(&json);
        let wrote = data.and_then(|data| {
            results.write(|| {
                let texts = [page(&found.report), json.clone()];
                let texts = texts.map(String::into_bytes);
                let names = FILES.into_iter().map(PathBuf::from);
                let mut files: Vec<_> = names.zip(texts).collect();
                files.extend(self.formats.files(&found, &data)?);
                Ok(files)
            })
        });
        let text = match self.output.json {
            true => json,
            false => tell(&found) + &results.told(&wrote, &names, width()),
        };
        let answer = self.strict.answer(text, &found.report.doubts);
        Ok(answer.after(wrote))
    }

    fn found(&self, read: Read) -> Result<Found> {
        let Read { model, infers_noise, notes, warnings, .. } = read;
        let (backend, why) = match &self.backend {
            Some(name) => (self.work.backend(name)?, None),
            None => {
                let Suited { backend, why } =
                    suited(&model, infers_noise, &self.work.effort()?)?;
                (backend, Some(why.to_owned()))
            }
        };
        let mut open = Open::default();
        (open.noise, open.rest) = (infers_noise, self.rest);
        let (told, seed) = (Told::new(), self.work.seed);
        let mut found =
            calibrate_open(&model, open, backend.as_ref(), seed, &told)?;
        found.report.backend_why = why;
        found.report.notes = notes;
        found.report.warnings.splice(..0, warnings);
        Ok(Found { found, model })
    }
}

fn tell(found: &Calibration) -> String {
    let width = width();
    let mut text = String::new();
    text.push_str(&picture(&found.report, width, 16));
    text.push('\n');
    text.push_str(&table(&found.report, width));
    text.push('\n');
    let noises = noises(&found.report, width);
    if !noises.is_empty() {
        text.push_str(&noises);
        text.push('\n');
    }
    for sentence in in_words(&found.report) {
        text.push_str(&wrapped(&sentence, width));
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

/// What was noted and what was doubted of an event, behind an answer.
pub(super) fn doubted(notes: &[String], warnings: &[String]) -> String {
    let warnings = warnings.iter().map(|w| format!("Warning: {w}."));
    let all: Vec<String> = notes.iter().cloned().chain(warnings).collect();
    let width = width();
    let lines: String = all.iter().map(|said| wrapped(said, width)).collect();
    if lines.is_empty() { lines } else { format!("\n{lines}") }
}

/// A JSON document as it is printed and written.
pub(super) fn pretty(document: &serde_json::Value) -> String {
    format!("{document:#}\n")
}

/// A sentence broken into lines, the later ones indented.
pub(super) fn wrapped(sentence: &str, width: usize) -> String {
    let mut text = String::new();
    let mut column = 0;
    for word in sentence.split_whitespace() {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > width {
            text.push_str("\n  ");
            column = 2;
        } else if column > 0 {
            text.push(' ');
            column += 1;
        }
        text.push_str(word);
        column += length;
    }
    text.push('\n');
    text
}
