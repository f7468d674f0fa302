//! `couloir diagnose`: where simulation and recording differ, and what was
//! left out.

use std::path::PathBuf;

use clap::Args;

use super::calibrate::pretty;
use super::progress::Told;
use super::{Output, Subject, width};
use crate::discrepancy::{Odds, Options, diagnose, page, summary};
use crate::error::Result;
use crate::io::write_all;
use crate::physics::friction::Laws;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Event folders, or their event.toml; a passenger car coasting uphill,
    /// a real recording, with Coulomb friction alone, where none is given
    event: Option<PathBuf>,
    /// Friction law instead of the event's
    #[arg(long, value_name = "LAW")]
    friction: Option<String>,
    /// Noise instead of the event's: iid, ar(k), student
    #[arg(long, value_name = "NOISE")]
    noise: Option<String>,
    /// Prior odds of a mechanism against 1 for each other, such as
    /// friction-patch=3; `none` against all others together
    #[arg(long, value_name = "NAME=ODDS", value_parser = odds)]
    odds: Vec<(String, f64)>,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    output: Output,
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

impl Arguments {
    pub(super) fn run(&self, laws: &Laws) -> Result<String> {
        let alone = self.event.is_none().then(|| "coulomb".to_owned());
        let subject = Subject {
            event: self.event.clone(),
            friction: self.friction.clone().or(alone),
            noise: self.noise.clone(),
        };
        let model = subject.model(laws)?;
        let mut options = Options::of(&model, self.seed);
        options.odds = self.odds.iter().cloned().collect::<Odds>();
        let told = Told::new();
        let found = diagnose(&model, model.event(), &options, &told)?;
        drop(told);
        let json = pretty(&found.json());
        if let Some(folder) = &self.output.out {
            let files = [
                ("diagnosis.json", json.clone()),
                ("report.html", page(&found)),
            ];
            write_all(folder, &files)?;
        }
        if self.output.json {
            return Ok(json);
        }
        let mut text = summary(&found, width());
        if let Some(folder) = &self.output.out {
            text.push_str(&format!(
                "\nWritten to {}: report.html, diagnosis.json\n",
                folder.display()
            ));
        }
        Ok(text)
    }
}
