//! How well evidences repeat, and whether stated errors hold: every candidate
//! of an event weighed with several seeds. Arguments: how many seeds, values a
//! second, and event folders or cases of the challenge, such as
//! `challenge:9931:3` for the third by seed 9931 of those with one recording;
//! without any, two seeds of the built-in event.
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::Instant;

use couloir::challenge::{Errors, Mix, cases};
use couloir::diagnosis::attribute;
use couloir::io;
use couloir::mechanism::catalogue::catalogue;
use couloir::model::{Assembled, declared_blocks};
use couloir::prelude::*;

/// Candidates further below the best, in ln, are not looked at.
const FAR: f64 = 10.0;

/// An event's model, of so many values a second.
fn model(file: io::EventFile, rate: f64) -> Result<Assembled> {
    let series = file.event.recordings().next();
    let series = series.ok_or_else(|| Error::input("no recording"))?;
    let times = series.times();
    let step = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
    let every = (1.0 / (rate * step)).round().max(1.0) as usize;
    let of = |all: &[f64]| -> Vec<f64> {
        all.iter().skip(every - 1).step_by(every).copied().collect()
    };
    let quantity = series.quantity();
    let thin = Series::new(quantity, of(times), of(series.values()))?;
    let event = file.event.with_recording(thin)?;
    Assembled::new(event, file.friction, file.noise, &file.priors)
}

/// How many effects are drawn: cases are numbered through them, as in the
/// whole challenge.
const EFFECTS: usize = 200;

/// A case of the challenge by the seed and the number, counted from 1, in
/// `seed:number`.
fn challenge_case(text: &str, laws: &Laws) -> Result<io::EventFile> {
    let wrong = || {
        Error::input(format!(
            "challenge:{text}: expected a seed and a case's number from 1 on, \
             such as challenge:9931:3"
        ))
    };
    let (seed, number) = text.split_once(':').ok_or_else(wrong)?;
    let seed = seed.parse().map_err(|_| wrong())?;
    let number: usize = number.parse().map_err(|_| wrong())?;
    let all = cases(EFFECTS, seed, Mix::One, Errors::Simple)?;
    let index = number.checked_sub(1).ok_or_else(wrong)?;
    let case = all.get(index).ok_or_else(wrong)?;
    println!("\n{} of seed {seed}: {}", case.name, case.truth.effect);
    let files = &case.recordings[0].files;
    let open = |name: &str| {
        let file = files.iter().find(|(file, _)| *file == name);
        let (_, text) = file.ok_or_else(wrong)?;
        Ok((Cursor::new(text.clone()), PathBuf::from(name)))
    };
    let event = files.iter().find(|(file, _)| *file == "event.toml");
    let (name, event) = event.ok_or_else(wrong)?;
    io::parse_event(event, Path::new(name), open, laws)
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// What each seed says of one candidate.
struct Repeats {
    log_evidence: Vec<f64>,
    stated: Vec<f64>,
}

impl Repeats {
    /// How far each seed is off their mean, in ln.
    fn off(&self) -> Vec<f64> {
        let middle = mean(&self.log_evidence);
        self.log_evidence.iter().map(|log| log - middle).collect()
    }

    /// A row of the table.
    fn row(&self, label: &str) -> String {
        let (middle, stated) = (mean(&self.log_evidence), mean(&self.stated));
        let off = self.off();
        let by_size =
            |a: &usize, b: &usize| off[*a].abs().total_cmp(&off[*b].abs());
        let most = (0..off.len()).max_by(by_size).unwrap_or_default();
        let (seed, most) = (most + 1, off[most]);
        let square = off.iter().map(|x| x * x).sum::<f64>();
        let sd = (square / (off.len() as f64 - 1.0)).sqrt();
        format!(
            "| {label} | {middle:.2} | {most:+.2} | {seed} | {sd:.3} | \
             {stated:.3} |"
        )
    }

    /// How far each seed is off, in stated errors.
    fn scores(&self) -> Vec<f64> {
        // The mean of n takes a degree of freedom away.
        let n = self.stated.len() as f64;
        let scale = (n / (n - 1.0)).sqrt();
        let off = self.off().into_iter().zip(&self.stated);
        off.map(|(x, se)| scale * x / se).collect()
    }
}

/// ln evidence, its stated error, and how far each seed is off, by candidate.
fn study(name: &str, model: &Assembled, seeds: u64) -> Result<()> {
    let blocks = declared_blocks(model)?;
    let extent = model.event().extent();
    let all = catalogue(&extent, &blocks);
    let begun = Instant::now();
    let found = (1..=seeds)
        .map(|seed| {
            attribute(model, Some(&extent), &all, Seed::new(seed), &Quiet)
        })
        .collect::<Result<Vec<_>>>()?;
    let seconds = begun.elapsed().as_secs_f64() / seeds as f64;
    let repeats = |i: usize| {
        let of = found.iter().map(|found| &found.candidates[i]);
        let (log_evidence, stated) =
            of.map(|one| (one.log_evidence, one.se)).unzip();
        Repeats { log_evidence, stated }
    };
    let repeats: Vec<Repeats> = (0..all.len()).map(repeats).collect();
    let middle = |of: &Repeats| mean(&of.log_evidence);
    let best = repeats.iter().map(middle).fold(f64::NEG_INFINITY, f64::max);
    println!("\n{name}, {seconds:.2} s a seed");
    println!("| candidate | ln evidence | most off | by seed | sd | stated |");
    println!("|---|---|---|---|---|---|");
    let mut scores = Vec::new();
    for (of, mechanism) in repeats.iter().zip(&all) {
        if middle(of) >= best - FAR {
            println!("{}", of.row(&mechanism.label()));
            scores.extend(of.scores());
        }
    }
    let square = scores.iter().map(|z| z * z).sum::<f64>();
    let sd = (square / scores.len() as f64).sqrt();
    println!("z-scores of {}: sd {sd:.2}", scores.len());
    Ok(())
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: f64| {
        arguments.get(i).and_then(|x| x.parse().ok()).unwrap_or(default)
    };
    let (seeds, rate) = (number(0, 2.0).max(2.0) as u64, number(1, 1e9));
    let laws = Laws::default();
    if arguments.len() < 3 {
        let file = io::coastdown(&laws)?;
        return study("coast-down", &model(file, rate)?, seeds);
    }
    for folder in &arguments[2..] {
        let file = match folder.strip_prefix("challenge:") {
            Some(case) => challenge_case(case, &laws)?,
            None => io::load(Path::new(folder), &laws)?,
        };
        let name = file.event.name().to_owned();
        study(&name, &model(file, rate)?, seeds)?;
    }
    Ok(())
}
