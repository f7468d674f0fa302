//! `couloir population`: what the events of a sweep have in common.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use super::answer::{Answer, Strict, pretty, wrapped};
use super::progress::Told;
use super::results::Output;
use super::width;
use crate::draws::Draws;
use crate::error::{Error, Result};
use crate::io::place;
use crate::population::{Member, Pooled, Population, Shared, pool};
use crate::prior::AnyPrior;
use crate::report::PROGRAM;
use crate::report::digits::short;
use crate::seed::Seed;
use crate::sweep::{DRAWS, Index, Key, Outcome, calibrated, csv_cell};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a sweep with --verb calibrate, whose summary is there
    sweep: PathBuf,
    /// Parameters that the population is of, such as mu,xi; all of the law
    /// where not given
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    of: Vec<String>,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1, value_parser = super::seed)]
    seed: u64,
    #[command(flatten)]
    strict: Strict,
    #[command(flatten)]
    output: Output,
}

/// What it writes.
const FILES: [&str; 2] = ["population.json", "population.csv"];

impl Arguments {
    pub(super) fn run(&self, told: &Told) -> Result<Answer> {
        let reads = [self.sweep.join("sweep.json")];
        let results = self.output.ready(&FILES, &reads)?;
        let (members, without) = self.members()?;
        let found = pool(&members, Seed::new(self.seed), told)?;
        told.finish();
        let json = pretty(&self.json(&found, without));
        let csv = csv(&found);
        let wrote = results
            .write(|| Ok(FILES.into_iter().zip([&json, &csv]).collect()));
        let text = match self.output.json {
            true => json,
            false => {
                table(&found, without) + &results.told(&wrote, &FILES, width())
            }
        };
        Ok(self.strict.answer(text, &found.warnings).after(wrote))
    }

    /// The events with a calibration, and how many have none.
    fn members(&self) -> Result<(Vec<Member>, usize)> {
        let rows = calibrated(&self.sweep)?;
        let index = Index::of(&self.sweep)?;
        let (mut members, mut without) = (Vec::new(), 0);
        for row in rows {
            let key = row.task.as_deref().and_then(Key::read);
            let outcome = match key {
                Some(key) => index.outcome(&key)?,
                None => None,
            };
            match outcome {
                Some(Outcome::Done(result)) => {
                    let member = self.member(&row.event, &result);
                    members.push(member.map_err(|e| e.within(&row.event))?);
                }
                _ => without += 1,
            }
        }
        Ok((members, without))
    }

    /// An event of what a sweep keeps of its calibration.
    fn member(&self, event: &str, result: &Value) -> Result<Member> {
        let kept = result[DRAWS].as_object().filter(|kept| !kept.is_empty());
        let kept = kept.ok_or_else(|| {
            Error::input(
                "no draws of its law are kept; expected a calibration of a \
                 law with parameters: run the sweep again",
            )
        })?;
        let names: Vec<String> = match self.of.is_empty() {
            true => kept.keys().cloned().collect(),
            false => self.of.clone(),
        };
        let columns: Vec<Vec<f64>> = names
            .iter()
            .map(|name| column(kept, name))
            .collect::<Result<_>>()?;
        let count = columns.iter().map(Vec::len).min().unwrap_or(0);
        let rows =
            (0..count).flat_map(|row| columns.iter().map(move |c| c[row]));
        let known = |name: &String, key: &str| {
            let text = result["parameters"][name][key].as_str();
            text.unwrap_or_default().to_owned()
        };
        let units = names.iter().map(|name| known(name, "unit")).collect();
        let priors = names.iter().map(|n| AnyPrior::parse(&known(n, "prior")));
        let priors = priors.collect::<Result<_>>()?;
        let mut draws = Draws::new(names, units)?;
        draws.push_chain(rows.collect(), None)?;
        Ok(Member { name: event.to_owned(), draws, priors })
    }

    fn json(&self, found: &Population, without: usize) -> Value {
        let parameters = found.parameters.iter();
        let parameters: Map<_, _> =
            parameters.map(|p| (p.name.clone(), of_parameter(p))).collect();
        let member = |member: &Pooled| {
            let of = |(k, p): (usize, &Shared)| {
                let both = json!({
                    "alone": three(&member.alone[k]),
                    "pooled": three(&member.pooled[k]),
                });
                (p.name.clone(), both)
            };
            let parameters: Map<_, _> =
                found.parameters.iter().enumerate().map(of).collect();
            json!({
                "event": member.name,
                "effective_draws": member.effective,
                "parameters": parameters,
            })
        };
        json!({
            "schema": 1,
            "program": PROGRAM,
            "seed": self.seed,
            "events": found.members.len(),
            "without_result": without,
            "population": parameters,
            "members": found.members.iter().map(member).collect::<Vec<_>>(),
            "warnings": found.warnings,
        })
    }
}

fn column(kept: &Map<String, Value>, name: &str) -> Result<Vec<f64>> {
    let all = kept.get(name).and_then(Value::as_array).ok_or_else(|| {
        let names: Vec<&str> = kept.keys().map(String::as_str).collect();
        Error::input(format!(
            "no draws of {name} are kept; expected --of with some of {}",
            names.join(", ")
        ))
    })?;
    Ok(all.iter().filter_map(Value::as_f64).collect())
}

fn three([q05, q50, q95]: &[f64; 3]) -> Value {
    json!({"q05": q05, "q50": q50, "q95": q95})
}

fn of_parameter(p: &Shared) -> Value {
    json!({
        "unit": p.unit,
        "scale": if p.in_log { "logarithm" } else { "identity" },
        "median": three(&p.median),
        "spread": three(&p.spread),
        "next": three(&p.next),
        "error_of_median": p.errors[0],
        "error_of_spread": p.errors[1],
    })
}

/// `population.csv`: a line of each event.
fn csv(found: &Population) -> String {
    let mut text = String::from("event,effective_draws");
    for p in &found.parameters {
        for of in ["alone", "pooled"] {
            for q in ["q05", "q50", "q95"] {
                text.push_str(&format!(",{}_{of}_{q}", p.name));
            }
        }
    }
    text.push('\n');
    for member in &found.members {
        text.push_str(&csv_cell(&member.name));
        text.push_str(&format!(",{:.1}", member.effective));
        for (alone, pooled) in member.alone.iter().zip(&member.pooled) {
            for value in alone.iter().chain(pooled) {
                text.push_str(&format!(",{value}"));
            }
        }
        text.push('\n');
    }
    text
}

fn table(found: &Population, without: usize) -> String {
    let width = width();
    let mut text = format!(
        "Population of {} events{}\n\n{:10} {:>24} {:>22} {:>20}\n",
        found.members.len(),
        match without {
            0 => String::new(),
            n => format!(", {n} without a result left out"),
        },
        "",
        "median (90 %)",
        "spread",
        "next event (90 %)"
    );
    text.extend(found.parameters.iter().map(row));
    text.push('\n');
    let logs = found.parameters.iter().filter(|p| p.in_log);
    let logs: Vec<&str> = logs.map(|p| p.name.as_str()).collect();
    if !logs.is_empty() {
        text.push_str(&wrapped(
            &format!(
                "The spread is the standard deviation of the logarithm of {}.",
                logs.join(" and of ")
            ),
            width,
        ));
    }
    let worst = found.parameters.iter().flat_map(|p| p.errors);
    let worst = worst.fold(0.0_f64, f64::max);
    text.push_str(&wrapped(&checked(found, worst), width));
    for warning in &found.warnings {
        text.push_str(&wrapped(&format!("Warning: {warning}."), width));
    }
    text
}

/// What the population says of a parameter.
fn row(p: &Shared) -> String {
    let [low, half, high] = p.median.map(|x| short(x, 3));
    let median = format!("{half} ({low} to {high})");
    let [low, half, high] = p.spread.map(|x| short(x, 2));
    let spread = format!("{half} ({low} to {high})");
    let [low, _, high] = p.next.map(|x| short(x, 3));
    let next = format!("{low} to {high}");
    format!("{:10} {median:>24} {spread:>22} {next:>20}\n", p.name)
}

/// What the checks say.
fn checked(found: &Population, worst: f64) -> String {
    let least = found.members.iter();
    let least = least.min_by(|a, b| a.effective.total_cmp(&b.effective));
    let least = least.map_or(String::new(), |member| {
        format!(
            "; the fewest that an event's weights are worth are {:.0} ({})",
            member.effective,
            place(Path::new(&member.name))
        )
    });
    format!(
        "The events' draws leave the population's figures uncertain by {worst:.2} of \
         their standard deviations at most{least}."
    )
}
