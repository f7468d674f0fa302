//! What came of all events: a table, a JSON document and a CSV file.
//!
//! It holds no time and no place where it was computed: it is the same, byte
//! for byte, however often the work was stopped and wherever it was done.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::journal::Outcome;

/// An event of a sweep, and what came of it.
#[derive(Debug, Clone)]
pub struct Row {
    /// What it is called: its path, with the options of its line.
    pub event: String,
    /// Nothing yet, a result or a failure.
    pub outcome: Option<Outcome>,
}

/// How often something was seen.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    selected: usize,
    /// The sum of its probabilities.
    probability: f64,
    events: usize,
}

/// The figures of all events, gathered one after the other.
#[derive(Debug, Clone, Default)]
pub struct Summary {
    verb: String,
    events: usize,
    missing: usize,
    verdicts: BTreeMap<String, usize>,
    mechanisms: BTreeMap<String, Seen>,
    failures: BTreeMap<String, Vec<String>>,
    /// The rows of the JSON document and of the CSV file, written out: as
    /// values they would take ten times the memory.
    json: String,
    csv: String,
}

/// The columns of the CSV file that are the same for every verb.
const HEAD: &str = "event,status,verdict,selected,probability,message\n";

impl Summary {
    /// Of no event yet, of a sweep with this command.
    pub fn new(verb: &str) -> Self {
        Self { verb: verb.to_owned(), ..Self::default() }
    }

    /// Adds an event.
    pub fn add(&mut self, row: &Row) {
        self.events += 1;
        let (status, result, why) = match &row.outcome {
            None => {
                self.missing += 1;
                ("missing", None, None)
            }
            Some(Outcome::Failed(why)) => {
                let events = self.failures.entry(why.clone()).or_default();
                events.push(row.event.clone());
                ("failed", None, Some(why.as_str()))
            }
            Some(Outcome::Done(result)) => {
                self.count(result);
                ("done", Some(result), None)
            }
        };
        let mut document = json!({"event": row.event, "status": status});
        if let Some(result) = result {
            document["result"] = result.clone();
        }
        if let Some(why) = why {
            document["message"] = why.into();
        }
        let comma = if self.json.is_empty() { "" } else { ",\n" };
        self.json.push_str(&format!("{comma}    {document}"));
        self.csv.push_str(&csv_line(&row.event, status, result, why));
    }

    fn count(&mut self, result: &Value) {
        if let Some(verdict) = result["verdict"].as_str() {
            *self.verdicts.entry(verdict.to_owned()).or_default() += 1;
        }
        for selected in texts(&result["selected"]) {
            self.mechanisms.entry(selected).or_default().selected += 1;
        }
        for mechanism in result["mechanisms"].as_array().into_iter().flatten()
        {
            let name = mechanism["name"].as_str();
            let probability = mechanism["probability"].as_f64();
            if let (Some(name), Some(probability)) = (name, probability) {
                let seen = self.mechanisms.entry(name.to_owned()).or_default();
                seen.probability += probability;
                seen.events += 1;
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

    /// `sweep.json` and `sweep.csv`. The rows stay where they were gathered:
    /// of 10^5 events they are some 250 MB.
    pub fn into_files(mut self) -> [String; 2] {
        let head = json!({
            "schema": 1,
            "verb": self.verb,
            "events": self.events,
            "done": self.done(),
            "failed": self.failed(),
            "missing": self.missing,
            "verdicts": self.verdicts,
            "mechanisms": self.mechanisms_json(),
            "failures": self.failures_json(),
        });
        let head = format!("{head:#}");
        let head = head.strip_suffix('}').unwrap_or(&head).trim_end();
        self.json.insert_str(0, &format!("{head},\n  \"rows\": [\n"));
        self.json.push_str("\n  ]\n}\n");
        self.csv.insert_str(0, HEAD);
        [self.json, self.csv]
    }

    /// Mechanisms by how often they were selected, then by their probability.
    fn ranked(&self) -> Vec<(&str, Seen)> {
        let all = self.mechanisms.iter();
        let mut all: Vec<_> =
            all.map(|(name, seen)| (name.as_str(), *seen)).collect();
        all.sort_by(|(_, a), (_, b)| {
            let by_probability = b.mean().total_cmp(&a.mean());
            b.selected.cmp(&a.selected).then(by_probability)
        });
        all
    }

    fn mechanisms_json(&self) -> Vec<Value> {
        let document = |(name, seen): (&str, Seen)| {
            json!({
                "name": name,
                "selected": seen.selected,
                "mean_probability": seen.mean(),
            })
        };
        self.ranked().into_iter().map(document).collect()
    }

    fn failures_json(&self) -> Vec<Value> {
        let document = |(why, events): (&String, &Vec<String>)| json!({"message": why, "events": events});
        self.failures.iter().map(document).collect()
    }

    /// The table of a terminal.
    pub fn table(&self) -> String {
        let mut text = format!(
            "{} events: {} done, {} failed, {} not done yet\n",
            self.events,
            self.done(),
            self.failed(),
            self.missing
        );
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
        for (why, events) in &self.failures {
            let first = events.first().map_or("", String::as_str);
            let count = events.len();
            text.push_str(&format!(
                "\n{count} failed, {first} first: {why}\n"
            ));
        }
        text
    }
}

impl Seen {
    fn mean(&self) -> f64 {
        self.probability / self.events.max(1) as f64
    }
}

fn texts(list: &Value) -> Vec<String> {
    let all = list.as_array().into_iter().flatten();
    all.filter_map(|text| text.as_str().map(str::to_owned)).collect()
}

fn csv_line(
    event: &str,
    status: &str,
    result: Option<&Value>,
    why: Option<&str>,
) -> String {
    let none = Value::Null;
    let result = result.unwrap_or(&none);
    let selected = texts(&result["selected"]);
    let all = result["mechanisms"].as_array().into_iter().flatten();
    let of_selected = |m: &&Value| {
        m["name"]
            .as_str()
            .is_some_and(|name| selected.iter().any(|s| s == name))
    };
    let probability: Option<f64> = all
        .filter(of_selected)
        .filter_map(|m| m["probability"].as_f64())
        .reduce(f64::min);
    let cells = [
        event.to_owned(),
        status.to_owned(),
        result["verdict"].as_str().unwrap_or_default().to_owned(),
        selected.join(" + "),
        probability.map_or(String::new(), |p| p.to_string()),
        why.unwrap_or_default().to_owned(),
    ];
    cells.map(|text| cell(&text)).join(",") + "\n"
}

/// A cell that a spreadsheet takes for text: what begins as a formula does
/// gets an apostrophe before it (OWASP, CSV injection).
fn cell(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    let safe = match is_formula && text.parse::<f64>().is_err() {
        true => format!("'{text}"),
        false => text.to_owned(),
    };
    match safe.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", safe.replace('"', "\"\"")),
        false => safe,
    }
}

#[cfg(test)]
mod tests {
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
        });
        let outcomes = [
            Some(Outcome::Done(result)),
            Some(Outcome::Failed("no \"speed\", a=1".to_owned())),
            None,
        ];
        for (outcome, event) in outcomes.into_iter().zip(["a", "=1+1", "c"]) {
            summary.add(&Row { event: event.to_owned(), outcome });
        }
        summary
    }

    #[test]
    fn the_json_is_whole_and_counts() {
        let [json, _] = summary().into_files();
        let document: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(document["events"], 3);
        let counts = ["done", "failed", "missing"].map(|k| &document[k]);
        assert_eq!(counts, [&json!(1); 3]);
        assert_eq!(
            document["rows"][0]["result"]["verdict"],
            "missing-physics"
        );
        assert_eq!(document["mechanisms"][0]["name"], "surge");
        assert_eq!(document["mechanisms"][0]["mean_probability"], 0.75);
        assert_eq!(document["failures"][0]["events"], json!(["=1+1"]));
    }

    #[test]
    fn the_json_of_nothing_is_whole() {
        let mut empty = Summary::new("calibrate");
        empty.add(&Row { event: "a".to_owned(), outcome: None });
        let [json, _] = empty.into_files();
        let document: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(document["missing"], 1);
    }

    #[test]
    fn no_cell_is_a_formula() {
        let [_, csv] = summary().into_files();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines[1], "a,done,missing-physics,surge,0.75,");
        let failed = "'=1+1,failed,,,,\"no \"\"speed\"\", a=1\"";
        assert_eq!(lines[2], failed);
        assert_eq!(cell("-2.5"), "-2.5");
        for text in ["=x", "+x", "-x", "@x", "\tx"] {
            assert_eq!(cell(text).trim_matches('"'), format!("'{text}"));
        }
    }

    #[test]
    fn the_table_fits_a_terminal() {
        let table = summary().table();
        assert!(table.contains("3 events: 1 done, 1 failed, 1 not done yet"));
        assert!(table.lines().all(|line| line.chars().count() <= 80));
    }
}
