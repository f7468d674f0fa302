//! What came of all events as files: a document, a table, a page. Rows are
//! read again for each file, so that memory holds one at a time.

use std::io::{self, Write};

use super::row::{Cell, Row, csv_line};
use super::summary::Summary;
use crate::error::Result;

/// Hands over every row of a sweep in turn, in the list's order.
pub type Rows<'a> =
    &'a dyn Fn(&mut dyn FnMut(&Row) -> io::Result<()>) -> Result<()>;

/// Counts all rows.
///
/// # Errors
/// Rows that cannot be read.
pub fn summed(verb: &str, rows: Rows<'_>) -> Result<Summary> {
    let mut summary = Summary::new(verb);
    rows(&mut |row| {
        summary.add(row);
        Ok(())
    })?;
    Ok(summary)
}

/// Writes `sweep.json`: the counts, and a row of each event.
///
/// # Errors
/// Rows that cannot be read, or a file that cannot be written.
pub fn write_json(
    summary: &Summary,
    rows: Rows<'_>,
    mut file: &mut dyn Write,
) -> io::Result<()> {
    let head = format!("{:#}", summary.document());
    let head = head.strip_suffix('}').unwrap_or(&head).trim_end();
    write!(file, "{head},\n  \"rows\": [\n")?;
    let mut comma = "";
    all(rows, &mut |row| {
        write!(file, "{comma}    ")?;
        comma = ",\n";
        Ok(serde_json::to_writer(&mut file, &row.document())?)
    })?;
    file.write_all(b"\n  ]\n}\n")
}

/// Writes `sweep.csv`: a line of each event.
///
/// # Errors
/// As [`write_json`].
pub fn write_csv(
    summary: &Summary,
    rows: Rows<'_>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let columns = summary.columns();
    let names = columns.names().into_iter().map(Cell::Text);
    file.write_all(csv_line(&names.collect::<Vec<_>>()).as_bytes())?;
    all(rows, &mut |row| {
        file.write_all(csv_line(&columns.cells(row)).as_bytes())
    })
}

/// Goes through all rows.
pub(super) fn all(
    rows: Rows<'_>,
    each: &mut dyn FnMut(&Row) -> io::Result<()>,
) -> io::Result<()> {
    rows(each).map_err(|error| io::Error::other(error.to_string()))
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::super::journal::Outcome;
    use super::*;

    fn texts(events: &[(&str, Option<Outcome>)]) -> [String; 2] {
        let rows = |each: &mut dyn FnMut(&Row) -> io::Result<()>| {
            for (event, outcome) in events {
                let (event, outcome) = ((*event).to_owned(), outcome.clone());
                each(&Row { event, task: None, outcome }).unwrap();
            }
            Ok(())
        };
        let summary = summed("diagnose", &rows).unwrap();
        let [mut json, mut csv] = [Vec::new(), Vec::new()];
        write_json(&summary, &rows, &mut json).unwrap();
        write_csv(&summary, &rows, &mut csv).unwrap();
        [json, csv].map(|bytes| String::from_utf8(bytes).unwrap())
    }

    #[test]
    fn a_row_is_the_same_in_both() {
        let result = json!({
            "verdict": "missing-physics",
            "selected": ["surge"],
            "mechanisms": [
                {"name": "none", "probability": 0.25},
                {"name": "surge", "probability": 0.75},
            ],
        });
        let why = "no \"speed\", a=1".to_owned();
        let [text, csv] = texts(&[
            ("a", Some(Outcome::Done(result.clone()))),
            ("=1+1", Some(Outcome::Failed(why.clone()))),
            ("c", None),
        ]);
        let document: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(document["events"], 3);
        assert_eq!(document["rows"][0]["result"], result);
        assert_eq!(document["rows"][1]["message"], why);
        assert_eq!(document["rows"][2]["status"], "missing");
        let lines: Vec<&str> = csv.lines().collect();
        assert!(lines[0].ends_with(",message,p(none),p(surge)"), "{csv}");
        assert_eq!(lines[1], "a,done,missing-physics,surge,0.75,,0.25,0.75");
        let failed = "'=1+1,failed,,,,\"no \"\"speed\"\", a=1\",,";
        assert_eq!(lines[2], failed);
    }

    #[test]
    fn the_document_of_one_that_is_not_done_is_whole() {
        let [text, _] = texts(&[("a", None)]);
        let document: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(document["missing"], 1);
    }
}
