//! The table of all events as a Parquet file.

use std::io::{self, Write};

use super::files::{Rows, all};
use super::row::{Cell, Columns, Row};
use super::summary::Summary;
use crate::export::{Column, Sheet};

/// How many rows are held at a time.
const HELD: usize = 10_000;

/// Writes `sweep.parquet`: the columns of `sweep.csv`, as text and as numbers
/// that may be missing.
///
/// # Errors
/// Rows that cannot be read, or a file that cannot be written.
pub fn write_parquet(
    summary: &Summary,
    rows: Rows<'_>,
    file: &mut (dyn Write + Send),
) -> io::Result<()> {
    let columns = summary.columns();
    let none = Row { event: String::new(), task: None, outcome: None };
    let kinds = put(&columns, std::slice::from_ref(&none));
    let named: Vec<_> = columns.names().into_iter().zip(kinds).collect();
    let mut sheet = Sheet::new(file, "events", &named, Vec::new())?;
    let mut held: Vec<Row> = Vec::new();
    all(rows, &mut |row| {
        held.push(row.clone());
        if held.len() == HELD {
            sheet.add(&put(&columns, &held))?;
            held.clear();
        }
        Ok(())
    })?;
    sheet.add(&put(&columns, &held))?;
    sheet.finish()?;
    Ok(())
}

/// Rows as columns.
fn put(columns: &Columns, rows: &[Row]) -> Vec<Column> {
    let mut all: Vec<Vec<Cell>> = Vec::new();
    for row in rows {
        let cells = columns.cells(row);
        all.resize_with(cells.len(), Vec::new);
        for (column, cell) in all.iter_mut().zip(cells) {
            column.push(cell);
        }
    }
    all.iter().map(|cells| column(cells)).collect()
}

fn column(cells: &[Cell]) -> Column {
    let is_text = matches!(cells.first(), Some(Cell::Text(_)));
    let texts = cells.iter().map(|cell| match cell {
        Cell::Text(text) => text.clone(),
        Cell::Number(_) => String::new(),
    });
    let numbers = cells.iter().map(|cell| match cell {
        Cell::Text(_) => None,
        Cell::Number(number) => *number,
    });
    match is_text {
        true => Column::Text(texts.collect()),
        false => Column::Maybe(numbers.collect()),
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use ::parquet::file::reader::{FileReader as _, SerializedFileReader};
    use ::parquet::record::RowAccessor as _;
    use serde_json::json;

    use super::super::files::summed;
    use super::super::journal::Outcome;
    use super::*;

    #[test]
    fn it_is_read_back() {
        let done = json!({"verdict": "adequate", "mechanisms": [
            {"name": "none", "probability": 0.875}]});
        let rows = |each: &mut dyn FnMut(&Row) -> io::Result<()>| {
            for of in 0..HELD + 3 {
                let outcome =
                    (of % 2 == 0).then(|| Outcome::Done(done.clone()));
                each(&Row { event: format!("e{of}"), task: None, outcome })
                    .unwrap();
            }
            Ok(())
        };
        let summary = summed("diagnose", &rows).unwrap();
        let name = format!("couloir-parquet-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let mut file = File::create(&path).unwrap();
        write_parquet(&summary, &rows, &mut file).unwrap();
        let file = File::open(&path).unwrap();
        let file = SerializedFileReader::new(file).unwrap();
        let read: Vec<_> =
            file.get_row_iter(None).unwrap().flatten().collect();
        assert_eq!(read.len(), HELD + 3);
        let last = &read[HELD + 1];
        assert_eq!(last.get_string(0).unwrap(), "e10001");
        assert_eq!(last.get_string(1).unwrap(), "missing");
        assert!(last.get_double(6).is_err());
        assert_eq!(read[HELD + 2].get_double(6).unwrap(), 0.875);
        std::fs::remove_file(path).unwrap();
    }
}
