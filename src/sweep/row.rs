//! An event of a sweep as one row, of a document and of a table.

use serde_json::{Value, json};

use super::journal::Outcome;
use super::task::Key;

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
/// mechanism, and quantiles of each parameter.
#[derive(Debug, Clone, Default)]
pub(super) struct Columns {
    pub(super) mechanisms: Vec<String>,
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
        let mechanisms = self.mechanisms.iter();
        names.extend(mechanisms.map(|name| format!("p({name})")));
        for parameter in &self.parameters {
            names.extend(QUANTILES.map(|of| format!("{parameter}_{of}")));
        }
        names
    }

    /// What they say of an event.
    pub(super) fn cells(&self, row: &Row) -> Vec<Cell> {
        let result = row.result().unwrap_or(&Value::Null);
        let text = |text: &str| Cell::Text(text.to_owned());
        let mut cells = vec![
            text(&row.event),
            text(row.status()),
            text(result["verdict"].as_str().unwrap_or_default()),
            text(&texts(&result["selected"]).join(" + ")),
            Cell::Number(probability_of_selected(result)),
            text(row.message().unwrap_or_default()),
        ];
        for name in &self.mechanisms {
            let found = mechanisms(result).find(|(known, _)| known == name);
            cells.push(Cell::Number(found.map(|(_, p)| p)));
        }
        for name in &self.parameters {
            let of = |level| result["parameters"][name][level].as_f64();
            cells.extend(QUANTILES.map(|level| Cell::Number(of(level))));
        }
        cells
    }
}

/// The names in a list of texts.
pub(super) fn texts(list: &Value) -> Vec<String> {
    let all = list.as_array().into_iter().flatten();
    all.filter_map(|text| text.as_str().map(str::to_owned)).collect()
}

/// The mechanisms of a result, each with its probability.
pub(super) fn mechanisms(
    result: &Value,
) -> impl Iterator<Item = (&str, f64)> + '_ {
    let all = result["mechanisms"].as_array().into_iter().flatten();
    all.filter_map(|m| Some((m["name"].as_str()?, m["probability"].as_f64()?)))
}

/// The least probability of a mechanism that was selected.
fn probability_of_selected(result: &Value) -> Option<f64> {
    let selected = texts(&result["selected"]);
    let own = mechanisms(result)
        .filter(|(name, _)| selected.iter().any(|one| one == name));
    own.map(|(_, probability)| probability).reduce(f64::min)
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
