//! What came of all events: counted, and told as a table.
//!
//! It holds no time and no place where it was computed: it is the same, byte
//! for byte, however often the work was stopped and wherever it was done.
//! Rows go by one at a time, and are not held.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json};

use super::row::{Columns, Row, mechanisms, texts};
use crate::draws::quantile;
use crate::io::place;
use crate::report::digits::short;

/// How often something was seen.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Seen {
    pub(super) selected: usize,
    /// The sum of its probabilities.
    probability: f64,
    events: usize,
}

impl Seen {
    pub(super) fn mean(&self) -> f64 {
        self.probability / self.events.max(1) as f64
    }
}

/// A parameter over all events.
#[derive(Debug, Clone, Default)]
pub(super) struct Medians {
    pub(super) unit: String,
    pub(super) values: Vec<f64>,
}

/// The figures of all events, gathered one after the other.
#[derive(Debug, Clone, Default)]
pub struct Summary {
    pub(super) verb: String,
    pub(super) events: usize,
    missing: usize,
    pub(super) verdicts: BTreeMap<String, usize>,
    mechanisms: BTreeMap<String, Seen>,
    pub(super) parameters: BTreeMap<String, Medians>,
    pub(super) failures: BTreeMap<String, Vec<String>>,
}

impl Summary {
    /// Of no event yet, of a sweep with this command.
    pub fn new(verb: &str) -> Self {
        Self { verb: verb.to_owned(), ..Self::default() }
    }

    /// Adds an event.
    pub fn add(&mut self, row: &Row) {
        self.events += 1;
        if row.outcome.is_none() {
            self.missing += 1;
        }
        if let Some(why) = row.message() {
            let events = self.failures.entry(why.to_owned()).or_default();
            events.push(row.event.clone());
        }
        if let Some(result) = row.result() {
            self.count(result);
        }
    }

    fn count(&mut self, result: &Value) {
        if let Some(verdict) = result["verdict"].as_str() {
            *self.verdicts.entry(verdict.to_owned()).or_default() += 1;
        }
        for selected in texts(&result["selected"]) {
            self.mechanisms.entry(selected).or_default().selected += 1;
        }
        for (name, probability) in mechanisms(result) {
            let seen = self.mechanisms.entry(name.to_owned()).or_default();
            seen.probability += probability;
            seen.events += 1;
        }
        let parameters = result["parameters"].as_object();
        for (name, parameter) in parameters.into_iter().flatten() {
            if let Some(median) = parameter["q50"].as_f64() {
                let all = self.parameters.entry(name.clone()).or_default();
                all.values.push(median);
                let unit = parameter["unit"].as_str().unwrap_or("1");
                unit.clone_into(&mut all.unit);
            }
        }
    }

    /// How many events failed.
    pub fn failed(&self) -> usize {
        self.failures.values().map(Vec::len).sum()
    }

    /// How many events have a result.
    pub fn done(&self) -> usize {
        self.events - self.missing - self.failed()
    }

    /// How many events nothing came of yet.
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// The columns that its tables have.
    pub(super) fn columns(&self) -> Columns {
        Columns {
            mechanisms: self.mechanisms.keys().cloned().collect(),
            parameters: self.parameters.keys().cloned().collect(),
        }
    }

    /// Mechanisms by how often they were selected, then by their probability.
    pub(super) fn ranked(&self) -> Vec<(&str, Seen)> {
        let all = self.mechanisms.iter();
        let mut all: Vec<_> =
            all.map(|(name, seen)| (name.as_str(), *seen)).collect();
        all.sort_by(|(_, a), (_, b)| {
            let by_probability = b.mean().total_cmp(&a.mean());
            b.selected.cmp(&a.selected).then(by_probability)
        });
        all
    }

    /// `sweep.json` without its rows.
    pub(super) fn document(&self) -> Value {
        let mechanism = |(name, seen): (&str, Seen)| {
            json!({
                "name": name,
                "selected": seen.selected,
                "mean_probability": seen.mean(),
            })
        };
        let failure =
            |(why, events)| json!({"message": why, "events": events});
        let mechanisms = self.ranked().into_iter().map(mechanism);
        let failures = self.failures.iter().map(failure);
        json!({
            "schema": 1,
            "verb": self.verb,
            "events": self.events,
            "done": self.done(),
            "failed": self.failed(),
            "missing": self.missing,
            "verdicts": self.verdicts,
            "mechanisms": mechanisms.collect::<Vec<_>>(),
            "failures": failures.collect::<Vec<_>>(),
        })
    }

    /// How many events there are, and what became of them.
    pub(super) fn counts(&self) -> String {
        format!(
            "{} events: {} done, {} failed, {} not done yet",
            self.events,
            self.done(),
            self.failed(),
            self.missing
        )
    }

    /// The table of a terminal.
    pub fn table(&self) -> String {
        let mut text = self.counts() + "\n";
        if !self.verdicts.is_empty() {
            text.push_str(&format!("\n{:28} {:>9}\n", "verdict", "events"));
        }
        for (verdict, events) in &self.verdicts {
            text.push_str(&format!("{verdict:28} {events:>9}\n"));
        }
        let ranked = self.ranked();
        if !ranked.is_empty() {
            text.push_str(&format!(
                "\n{:28} {:>9} {:>18}\n",
                "mechanism", "selected", "mean probability"
            ));
        }
        for (name, seen) in ranked {
            text.push_str(&format!(
                "{name:28} {:>9} {:>18.3}\n",
                seen.selected,
                seen.mean()
            ));
        }
        text.push_str(&self.medians());
        for (why, events) in &self.failures {
            let first = events.first().map_or("", String::as_str);
            let count = events.len();
            text.push_str(&format!(
                "\n{count} failed, {} first: {why}\n",
                place(Path::new(first))
            ));
        }
        text
    }

    /// Where the events' medians of each parameter lie.
    fn medians(&self) -> String {
        let mut text = String::new();
        if !self.parameters.is_empty() {
            text.push_str(&format!(
                "\n{:28} {:>9} {:>9} {:>9}  events' medians\n",
                "parameter", "5 %", "half", "95 %"
            ));
        }
        for (name, medians) in &self.parameters {
            let [low, half, high] = medians.quantiles().map(|x| short(x, 3));
            text.push_str(&format!(
                "{name:28} {low:>9} {half:>9} {high:>9}  {}\n",
                medians.unit
            ));
        }
        text
    }
}

impl Medians {
    /// Their 5 %, 50 % and 95 % quantiles.
    pub(super) fn quantiles(&self) -> [f64; 3] {
        let mut sorted = self.values.clone();
        sorted.sort_by(f64::total_cmp);
        [0.05, 0.5, 0.95].map(|level| quantile(&sorted, level))
    }
}

#[cfg(test)]
mod tests {
    use super::super::journal::Outcome;
    use super::*;

    fn summary() -> Summary {
        let mut summary = Summary::new("diagnose");
        let result = json!({
            "verdict": "missing-physics",
            "selected": ["surge"],
            "mechanisms": [
                {"name": "none", "probability": 0.25},
                {"name": "surge", "probability": 0.75},
            ],
            "parameters": {"mu": {"q50": 0.25, "unit": "1"}},
        });
        let outcomes = [
            Some(Outcome::Done(result)),
            Some(Outcome::Failed("no \"speed\", a=1".to_owned())),
            None,
        ];
        for (outcome, event) in outcomes.into_iter().zip(["a", "=1+1", "c"]) {
            summary.add(&Row { event: event.to_owned(), task: None, outcome });
        }
        summary
    }

    #[test]
    fn everything_is_counted() {
        let document = summary().document();
        assert_eq!(document["events"], 3);
        let counts = ["done", "failed", "missing"].map(|k| &document[k]);
        assert_eq!(counts, [&json!(1); 3]);
        assert_eq!(document["mechanisms"][0]["name"], "surge");
        assert_eq!(document["mechanisms"][0]["mean_probability"], 0.75);
        assert_eq!(document["failures"][0]["events"], json!(["=1+1"]));
    }

    #[test]
    fn the_table_fits_a_terminal() {
        let table = summary().table();
        assert!(table.contains("3 events: 1 done, 1 failed, 1 not done yet"));
        assert!(table.contains("mu"), "{table}");
        assert!(table.lines().all(|line| line.chars().count() <= 80));
    }
}
