//! `couloir calibrate`: a friction law with its uncertainty.

use clap::Args;

use super::progress::Told;
use super::thin::Thin;
use super::{Output, Subject, Work, backend_name, width, written};
use crate::calibrate::{Calibration, calibrate};
use crate::error::Result;
use crate::infer::backend;
use crate::io::write_all;
use crate::physics::friction::Laws;
use crate::report::{calibration_json, in_words, page, picture, table};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    #[command(flatten)]
    thin: Thin,
    #[command(flatten)]
    work: Work,
    /// Backend: mh, random-walk, nuts (where built with it), smc, importance,
    /// laplace-mixture, bridge or reciprocal
    #[arg(long, default_value = "mh", value_parser = backend_name)]
    backend: String,
    #[command(flatten)]
    output: Output,
}

impl Arguments {
    pub(super) fn run(&self, laws: &Laws) -> Result<String> {
        let subject =
            Subject { thin: self.thin.clone(), ..self.subject.clone() };
        let (model, said) = subject.model_told(laws)?;
        let backend = backend(&self.backend, &self.work.effort()?)?;
        let told = Told::new();
        let mut found =
            calibrate(&model, backend.as_ref(), self.work.seed, &told)?;
        found.report.notes = said;
        drop(told);
        let json = pretty(&calibration_json(&found.report));
        if let Some(folder) = &self.output.out {
            let files = [
                ("calibration.json", json.clone()),
                ("draws.csv", found.draws.to_csv()),
                ("report.html", page(&found.report)),
            ];
            write_all(folder, &files)?;
        }
        if self.output.json {
            return Ok(json);
        }
        Ok(self.tell(&found))
    }

    fn tell(&self, found: &Calibration) -> String {
        let width = width();
        let mut text = String::new();
        text.push_str(&picture(&found.report, width, 16));
        text.push('\n');
        text.push_str(&table(&found.report, width));
        text.push('\n');
        for sentence in in_words(&found.report) {
            text.push_str(&wrapped(&sentence, width));
        }
        let report = &found.report;
        text.push_str(&format!(
            "\n{}: {} simulations, {:.2} s, seed {}\n",
            report.backend, report.simulations, report.seconds, report.seed
        ));
        let files = ["report.html", "calibration.json", "draws.csv"];
        text.push_str(&written(self.output.out.as_deref(), &files));
        text
    }
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
