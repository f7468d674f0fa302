//! A sweep's list as a CSV file.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::error::{Error, Result};
use crate::io::place;
use crate::spelling::quoted;

/// The column with the paths.
const EVENT: &str = "event";

/// The paths of its column `event`, each with the other columns as options of
/// their names.
pub(super) fn of_csv(list: &Path) -> Result<Vec<(PathBuf, Vec<OsString>)>> {
    let wrong = |error: csv::Error| broken(list, &error);
    let mut reader =
        ReaderBuilder::new().trim(Trim::All).from_path(list).map_err(wrong)?;
    let head = reader.headers().map_err(wrong)?.clone();
    let is_again =
        |(i, name): &(usize, &str)| head.iter().take(*i).any(|n| n == *name);
    if let Some((_, name)) = head.iter().enumerate().find(is_again) {
        return Err(Error::input(format!(
            "{}:1: two columns are called {}; expected each once: drop or \
             rename one",
            place(list),
            quoted(name)
        )));
    }
    if !head.iter().any(|name| name == EVENT) {
        return Err(Error::input(format!(
            "{}:1: no column is called event; expected one, with the path of \
             an event folder in each line",
            place(list)
        )));
    }
    let lines = reader.records();
    lines.map(|line| of_line(list, &head, &line.map_err(wrong)?)).collect()
}

fn of_line(
    list: &Path,
    head: &StringRecord,
    line: &StringRecord,
) -> Result<(PathBuf, Vec<OsString>)> {
    let cells = || head.iter().zip(line).filter(|(_, cell)| !cell.is_empty());
    let Some((_, event)) = cells().find(|(name, _)| *name == EVENT) else {
        let number = line.position().map_or(0, csv::Position::line);
        return Err(Error::input(format!(
            "{}:{number}: the cell of event is empty; expected the path of an \
             event folder",
            place(list)
        )));
    };
    let folder = list.parent().unwrap_or(Path::new(""));
    let options = cells()
        .filter(|(name, _)| *name != EVENT)
        .map(|(name, cell)| OsString::from(format!("--{name}={cell}")));
    Ok((folder.join(event), options.collect()))
}

/// What is wrong with the table, and in which line.
fn broken(list: &Path, error: &csv::Error) -> Error {
    let line = error.position().map(|at| format!(":{}", at.line()));
    let what = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} cells; expected {expected_len}, as in its head")
        }
        csv::ErrorKind::Utf8 { .. } => "is no text; expected UTF-8".to_owned(),
        csv::ErrorKind::Io(error) => format!("could not be read: {error}"),
        _ => "is no CSV table".to_owned(),
    };
    let line = line.unwrap_or_default();
    Error::input(format!("{}{line}: {what}", place(list)))
}
