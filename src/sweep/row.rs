//! An event of a sweep as one row, of a document and of a table.

use std::f64::consts::LN_10;

use serde_json::{Value, json};

use super::journal::Outcome;
use super::task::Key;
use crate::draws::log_sum_exp;

/// The member of a result that holds draws, by parameter.
pub const DRAWS: &str = "draws";

/// An event of a sweep, and what came of it.
#[derive(Debug, Clone)]
pub struct Row {
    /// What it is called: its path, with the options of its line.
    pub event: String,
    /// Its task, where its files could be read.
    pub task: Option<Key>,
    /// Nothing yet, a result or a failure.
    pub outcome: Option<Outcome>,
}

impl Row {
    /// The result, where there is one.
    pub(super) fn result(&self) -> Option<&Value> {
        match &self.outcome {
            Some(Outcome::Done(result)) => Some(result),
            _ => None,
        }
    }

    /// Why there is none, where it failed.
    pub(super) fn message(&self) -> Option<&str> {
        match &self.outcome {
            Some(Outcome::Failed(why)) => Some(why),
            _ => None,
        }
    }

    pub(super) fn status(&self) -> &'static str {
        match &self.outcome {
            None => "missing",
            Some(Outcome::Failed(_)) => "failed",
            Some(Outcome::Done(_)) => "done",
        }
    }

    /// The row of `sweep.json`.
    pub(super) fn document(&self) -> Value {
        let mut row = json!({"event": self.event, "status": self.status()});
        if let Some(key) = &self.task {
            row["task"] = key.to_string().into();
        }
        if let Some(result) = self.result() {
            row["result"] = without_draws(result.clone());
        }
        if let Some(why) = self.message() {
            row["message"] = why.into();
        }
        row
    }
}

/// A result without its draws, which stay where the task's line is: they are
/// as long as all else.
fn without_draws(mut result: Value) -> Value {
    if let Some(members) = result.as_object_mut() {
        members.remove(DRAWS);
    }
    result
}

/// What a table says of an event in one of its columns.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Cell {
    /// Text.
    Text(String),
    /// A number, where there is one.
    Number(Option<f64>),
}

/// The columns of a table: those of every event, a probability for each
/// mechanism or model, and quantiles of each parameter.
#[derive(Debug, Clone, Default)]
pub(super) struct Columns {
    pub(super) candidates: Vec<String>,
    pub(super) parameters: Vec<String>,
}

/// The columns of every event.
const EVERY: [&str; 6] =
    ["event", "status", "verdict", "selected", "probability", "message"];

/// The quantiles of a parameter.
const QUANTILES: [&str; 3] = ["q05", "q50", "q95"];

impl Columns {
    /// What they are called.
    pub(super) fn names(&self) -> Vec<String> {
        let mut names: Vec<String> =
            EVERY.iter().map(|name| (*name).to_owned()).collect();
        let candidates = self.candidates.iter();
        names.extend(candidates.map(|name| format!("p({name})")));
        for parameter in &self.parameters {
            names.extend(QUANTILES.map(|of| format!("{parameter}_{of}")));
        }
        names
    }

    /// What they say of an event.
    pub(super) fn cells(&self, row: &Row) -> Vec<Cell> {
        let result = row.result().unwrap_or(&Value::Null);
        let (weighed, chosen) = (weighed(result), chosen(result));
        let text = |text: &str| Cell::Text(text.to_owned());
        let mut cells = vec![
            text(&row.event),
            text(row.status()),
            text(result["verdict"].as_str().unwrap_or_default()),
            text(&chosen.join(" + ")),
            Cell::Number(least_probability(&weighed, &chosen)),
            text(row.message().unwrap_or_default()),
        ];
        for name in &self.candidates {
            let found = weighed.iter().find(|(known, _)| known == name);
            cells.push(Cell::Number(found.map(|(_, p)| *p)));
        }
        for name in &self.parameters {
            let of = |level| result["parameters"][name][level].as_f64();
            cells.extend(QUANTILES.map(|level| Cell::Number(of(level))));
        }
        cells
    }
}

/// The names in a list of texts.
fn texts(list: &Value) -> Vec<String> {
    let all = list.as_array().into_iter().flatten();
    all.filter_map(|text| text.as_str().map(str::to_owned)).collect()
}

/// What a result weighs, each with its probability: the mechanisms of a
/// diagnosis, or the models of a comparison, as likely as each other
/// beforehand.
pub(super) fn weighed(result: &Value) -> Vec<(String, f64)> {
    let models: Vec<(String, f64)> = members(result, "models")
        .filter_map(|model| {
            let factor = model["log10_bayes_factor"]["value"].as_f64()?;
            Some((name_of(model), factor * LN_10))
        })
        .collect();
    let total = log_sum_exp(models.iter().map(|(_, log)| *log));
    let of_models =
        models.into_iter().map(|(n, log)| (n, (log - total).exp()));
    let of_mechanisms = members(result, "mechanisms").filter_map(|one| {
        let name = one["name"].as_str()?.to_owned();
        Some((name, one["probability"].as_f64()?))
    });
    of_mechanisms.chain(of_models).collect()
}

/// What a result says it is: the mechanisms that a diagnosis selected, or the
/// likeliest model of a comparison.
pub(super) fn chosen(result: &Value) -> Vec<String> {
    if result["models"].is_null() {
        return texts(&result["selected"]);
    }
    let best = weighed(result).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    best.map(|(name, _)| name).into_iter().collect()
}

fn members<'r>(
    result: &'r Value,
    list: &str,
) -> impl Iterator<Item = &'r Value> {
    result[list].as_array().into_iter().flatten()
}

/// A model as `compare` takes it: friction, noise, and what was added.
fn name_of(model: &Value) -> String {
    let parts = ["friction", "noise"].map(|part| model[part].as_str());
    let added = texts(&model["mechanisms"]).join(" + ");
    let added = Some(added.as_str()).filter(|added| !added.is_empty());
    let all: Vec<&str> = parts.into_iter().chain([added]).flatten().collect();
    all.join(", ")
}

/// The least probability of what was chosen.
fn least_probability(
    weighed: &[(String, f64)],
    chosen: &[String],
) -> Option<f64> {
    let own = weighed.iter().filter(|(name, _)| chosen.contains(name));
    own.map(|(_, probability)| *probability).reduce(f64::min)
}

/// A line of a CSV file.
pub(super) fn csv_line(cells: &[Cell]) -> String {
    let cell = |cell: &Cell| match cell {
        Cell::Text(text) => csv_cell(text),
        Cell::Number(Some(number)) => number.to_string(),
        Cell::Number(None) => String::new(),
    };
    cells.iter().map(cell).collect::<Vec<_>>().join(",") + "\n"
}

/// A cell that a spreadsheet takes for text: what begins as a formula does
/// gets an apostrophe before it (OWASP, CSV injection).
pub(crate) fn csv_cell(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    let safe = match is_formula {
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

    #[test]
    fn no_cell_is_a_formula() {
        for text in ["=x", "+x", "-x", "@x", "\tx", "-2.5"] {
            assert_eq!(csv_cell(text), format!("'{text}"));
        }
        assert_eq!(csv_cell("a, \"b\""), "\"a, \"\"b\"\"\"");
        let cells = [Cell::Number(Some(-2.5)), Cell::Number(None)];
        assert_eq!(csv_line(&cells), "-2.5,\n");
    }

    #[test]
    fn models_are_weighed_by_their_evidence_at_even_odds() {
        let model = |noise: &str, added: &[&str], factor: f64| {
            json!({
                "friction": "voellmy", "noise": noise, "mechanisms": added,
                "log10_bayes_factor": {"value": factor},
            })
        };
        let result = json!({"models": [
            model("iid", &[], 0.0),
            model("ar(1)", &["surge", "drag"], 3_f64.log10()),
        ]});
        let found = weighed(&result);
        assert_eq!(found[0].0, "voellmy, iid");
        assert_eq!(chosen(&result), ["voellmy, ar(1), surge + drag"]);
        assert!((found[0].1 - 0.25).abs() < 1e-12, "{found:?}");
        let least = least_probability(&found, &chosen(&result));
        assert_eq!(least, Some(found[1].1));
    }

    #[test]
    fn parameters_have_three_quantiles_each() {
        let mu = json!({"q05": 0.1, "q50": 0.2, "q95": 0.3});
        let result = json!({"parameters": {"mu": mu}});
        let outcome = Some(Outcome::Done(result));
        let row = Row { event: "a".to_owned(), task: None, outcome };
        let columns = Columns {
            parameters: vec!["mu".to_owned(), "xi".to_owned()],
            ..Columns::default()
        };
        let line = csv_line(&columns.cells(&row));
        assert_eq!(line, "a,done,,,,,0.1,0.2,0.3,,,\n");
        assert_eq!(columns.names()[6..9], ["mu_q05", "mu_q50", "mu_q95"]);
        assert_eq!(columns.names().len(), columns.cells(&row).len());
    }
}
