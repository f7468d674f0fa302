//! `couloir reproduce`: the paper's study, computed again.

use std::path::PathBuf;

use clap::Args;

use super::calibrate::{pretty, wrapped};
use super::progress::Told;
use super::{folder, width, written};
use crate::error::Result;
use crate::io::write_all;
use crate::report;
use crate::reproduce::{page, reproduce, reproduction_json, words};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder to write the page, its pictures and reproduction.json to
    #[arg(long, value_name = "DIR", value_parser = folder)]
    out: Option<PathBuf>,
    /// How many synthetic series
    #[arg(long, default_value_t = 100)]
    samples: usize,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON document instead of the words
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub(super) fn run(&self) -> Result<String> {
        let told = Told::new();
        let found = reproduce(self.samples, self.seed, &told)?;
        drop(told);
        let json = pretty(&reproduction_json(&found));
        if let Some(folder) = &self.out {
            let [m0, m1] = &found.case.reports;
            let files = [
                ("reproduction.json", json.clone()),
                ("reproduction.html", page(&found)),
                ("m0.html", report::page(m0)),
                ("m1.html", report::page(m1)),
            ];
            write_all(folder, &files)?;
        }
        if self.json {
            return Ok(json);
        }
        let width = width();
        let mut text: String =
            words(&found).iter().map(|s| wrapped(s, width)).collect();
        let files =
            ["reproduction.html", "reproduction.json", "m0.html", "m1.html"];
        text.push_str(&written(self.out.as_deref(), &files));
        Ok(text)
    }
}
