//! What came of all events: counted, and told as a table.
//!
//! It holds no time and no place where it was computed: it is the same, byte
//! for byte, however often the work was stopped and wherever it was done.
//! Rows go by one at a time, and are not held.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json};

use super::row::{Columns, Row, chosen, weighed};
use crate::diagnosis::Hypothesis;
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

/// How many kinds of failure a terminal tells.
const TOLD: usize = 10;

/// What to do about failures.
const TRY_AGAIN: &str = "What failed is not tried again until the event's \
    files or the options change, or --retry is given.";

impl Seen {
    /// How often it was selected; nothing is never selected, it is what is
    /// left.
    pub(super) fn times_selected(&self, name: &str) -> String {
        match name == Hypothesis::Baseline.name() {
            true => "-".to_owned(),
            false => self.selected.to_string(),
        }
    }

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
    /// What was weighed: mechanisms, or the models of comparisons.
    candidates: BTreeMap<String, Seen>,
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
        for name in chosen(result) {
            self.candidates.entry(name).or_default().selected += 1;
        }
        for (name, probability) in weighed(result) {
            let seen = self.candidates.entry(name).or_default();
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
            candidates: self.candidates.keys().cloned().collect(),
            parameters: self.parameters.keys().cloned().collect(),
        }
    }

    /// What was weighed in each event, in the singular.
    pub(super) fn kind(&self) -> &'static str {
        if self.verb == "compare" { "model" } else { "mechanism" }
    }

    /// Mechanisms or models by how often they were selected, then by their
    /// probability.
    pub(super) fn ranked(&self) -> Vec<(&str, Seen)> {
        let all = self.candidates.iter();
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
        let candidate = |(name, seen): (&str, Seen)| {
            json!({
                "name": name,
                "selected": seen.selected,
                "mean_probability": seen.mean(),
            })
        };
        let failure =
            |(why, events)| json!({"message": why, "events": events});
        let candidates = self.ranked().into_iter().map(candidate);
        let failures = self.failures.iter().map(failure);
        let mut document = json!({
            "schema": 1,
            "verb": self.verb,
            "events": self.events,
            "done": self.done(),
            "failed": self.failed(),
            "missing": self.missing,
            "verdicts": self.verdicts,
            "mechanisms": [],
            "failures": failures.collect::<Vec<_>>(),
        });
        document[format!("{}s", self.kind())] = candidates.collect();
        document
    }

    /// How many events there are, and what became of them.
    pub(super) fn counts(&self) -> String {
        format!(
            "{} event{}: {} done, {} failed, {} not done yet",
            self.events,
            if self.events == 1 { "" } else { "s" },
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
                self.kind(),
                "selected",
                "mean probability"
            ));
        }
        for (name, seen) in ranked {
            text.push_str(&format!(
                "{name:28} {:>9} {:>18.3}\n",
                seen.times_selected(name),
                seen.mean()
            ));
        }
        text + &self.medians()
    }

    /// What failed, a sentence for each message, those of most events first.
    pub fn told_failures(&self) -> Vec<String> {
        let mut all: Vec<_> = self.failures.iter().collect();
        all.sort_by_key(|(_, events)| Reverse(events.len()));
        let sentence = |(why, events): &(&String, &Vec<String>)| {
            let first = events.first().map_or("", String::as_str);
            let first = place(Path::new(first));
            match events.len() {
                1 => format!("{first} failed: {why}"),
                count => format!("{count} failed, {first} first: {why}"),
            }
        };
        let mut told: Vec<String> =
            all.iter().take(TOLD).map(sentence).collect();
        if all.len() > TOLD {
            let more = all.len() - TOLD;
            told.push(format!("{more} more messages are in sweep.json."));
        }
        told.extend((!all.is_empty()).then(|| TRY_AGAIN.to_owned()));
        told
    }

    /// Where the events' medians of each parameter lie.
    fn medians(&self) -> String {
        let mut text = String::new();
        if !self.parameters.is_empty() {
            text.push_str(&format!(
                "\n{:28} {:>9} {:>9} {:>9}  events' medians\n",
                "parameter", "5 %", "50 %", "95 %"
            ));
        }
        for (name, medians) in &self.parameters {
            let [low, middle, high] = medians.quantiles().map(|x| short(x, 3));
            text.push_str(&format!(
                "{name:28} {low:>9} {middle:>9} {high:>9}  {}\n",
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

    #[test]
    fn failures_are_told_by_their_message_the_most_first() {
        let mut summary = summary();
        for of in 0..2 * TOLD {
            for event in 0..=of % 2 {
                let outcome = Some(Outcome::Failed(format!("why {of:02}")));
                let event = format!("{of}-{event}");
                summary.add(&Row { event, task: None, outcome });
            }
        }
        let told = summary.told_failures();
        assert_eq!(told[0], "2 failed, 1-0 first: why 01");
        assert_eq!(told[TOLD], "11 more messages are in sweep.json.");
        assert_eq!(told[TOLD + 1..], [TRY_AGAIN]);
        assert!(Summary::new("diagnose").told_failures().is_empty());
    }

    #[test]
    fn models_of_comparisons_are_counted() {
        let mut summary = Summary::new("compare");
        let model = |law: &str, factor: f64| {
            json!({"friction": law, "noise": "iid",
                   "log10_bayes_factor": {"value": factor}})
        };
        let models = json!([model("coulomb", 0.0), model("voellmy", 2.0)]);
        let outcome = Some(Outcome::Done(json!({"models": models})));
        summary.add(&Row { event: "a".to_owned(), task: None, outcome });
        let document = summary.document();
        assert_eq!(document["models"][0]["name"], "voellmy, iid");
        assert_eq!(document["models"][0]["selected"], 1);
        assert_eq!(document["mechanisms"], json!([]));
        assert!(summary.table().contains("voellmy, iid"));
    }
}
