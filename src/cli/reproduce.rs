//! `couloir reproduce`: the paper's study, computed again.

use std::path::PathBuf;

use clap::Args;

use super::answer::{Answer, pretty, wrapped};
use super::progress::Told;
use super::results::{Results, folder};
use super::resumed::{Resumed, checkpoint, conclude};
use super::width;
use crate::error::Result;
use crate::report;
use crate::reproduce::{page, reproduce, reproduction_json, words};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder to write the page, its pictures and reproduction.json to
    #[arg(long, value_name = "DIR", value_parser = folder)]
    out: Option<PathBuf>,
    /// How many synthetic series
    #[arg(long, default_value_t = 100, value_parser = super::whole)]
    samples: usize,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1, value_parser = super::seed)]
    seed: u64,
    /// Print one JSON document instead of the words
    #[arg(long)]
    json: bool,
}

/// What it writes.
const FILES: [&str; 4] =
    ["reproduction.html", "reproduction.json", "m0.html", "m1.html"];

impl Arguments {
    pub(super) fn run(&self, told: &Told, typed: &str) -> Result<Answer> {
        let results = Results::ready(self.out.as_deref(), &FILES, &[])?;
        let out = self.out.as_deref();
        let run = format!("reproduce {} {}", self.samples, self.seed);
        let kept = checkpoint(out, &run, told)?;
        let heard = Resumed { heard: told, checkpoint: kept.as_ref() };
        let mut found = reproduce(self.samples, self.seed, &heard)?;
        told.finish();
        // It makes what it reads, by the seed.
        found.origin.command = typed.to_owned();
        for report in &mut found.case.reports {
            report.origin = found.origin.clone();
        }
        let json = pretty(&reproduction_json(&found));
        let wrote = results.write(|| {
            let [m0, m1] = found.case.reports.each_ref().map(report::page);
            let texts = [page(&found), json.clone(), m0, m1];
            Ok(FILES.into_iter().zip(texts).collect())
        });
        conclude(kept, &wrote);
        if self.json {
            return Ok(Answer::from(json).after(wrote));
        }
        let width = width();
        let mut text: String =
            words(&found).iter().map(|s| wrapped(s, width)).collect();
        text.push_str(&results.told(&wrote, &FILES, width));
        Ok(Answer::from(text).after(wrote))
    }
}
