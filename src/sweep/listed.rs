//! The events of a sweep: a folder of folders, a pattern, or a CSV file.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::io::{place, quoted};

/// An event of a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Its folder, or its event.toml.
    pub event: PathBuf,
    /// What its line says beside it, as options of a command line:
    /// `--seed=3`.
    pub options: Vec<OsString>,
}

impl Listed {
    fn of(event: PathBuf) -> Self {
        Self { event, options: Vec::new() }
    }

    /// What it is called in results: its path, and the options of its line.
    pub fn name(&self) -> String {
        let options = self.options.iter().map(|o| o.to_string_lossy());
        let event = self.event.to_string_lossy();
        let parts: Vec<_> = std::iter::once(event).chain(options).collect();
        parts.join(" ")
    }
}

/// The events of a list: of a folder, those below it, by the order of their
/// paths; of a pattern with `*`, `?` or `[...]`, those that match; of a CSV
/// file, those of its column `event`, whose other columns are options of that
/// name, an empty cell being none. Its paths are relative to its folder.
///
/// # Errors
/// A list that cannot be read, or holds no event.
pub fn listed(list: &Path) -> Result<Vec<Listed>> {
    let text = list.to_string_lossy();
    let is_csv = list.extension().is_some_and(|e| e == "csv");
    let events = match list.exists() {
        true if is_csv && list.is_file() => of_csv(list)?,
        true if list.is_dir() => {
            let mut events = Vec::new();
            below(list, &mut events)?;
            events
        }
        true => vec![Listed::of(list.to_owned())],
        false if text.contains(['*', '?', '[']) => matching(&text)?,
        false => {
            return Err(Error::input(format!(
                "{}: there is no such list; expected a folder that holds \
                 event folders, a pattern such as \"survey/*\", or a CSV file \
                 with a column event",
                place(list)
            )));
        }
    };
    match events.is_empty() {
        false => Ok(events),
        true => Err(Error::input(format!(
            "{}: no event was found; expected folders with an event.toml in \
             them",
            place(list)
        ))),
    }
}

/// The event in a folder, or those in the folders that it holds; links are
/// not followed, which could lead in a circle.
fn below(folder: &Path, events: &mut Vec<Listed>) -> Result<()> {
    if folder.join(FILE).is_file() {
        events.push(Listed::of(folder.to_owned()));
        return Ok(());
    }
    let unread = |error: std::io::Error| {
        Error::input(format!(
            "{}: the folder could not be read: {error}",
            place(folder)
        ))
    };
    let mut folders = Vec::new();
    for entry in fs::read_dir(folder).map_err(unread)? {
        let entry = entry.map_err(unread)?;
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            folders.push(entry.path());
        }
    }
    folders.sort();
    folders.iter().try_for_each(|folder| below(folder, events))
}

/// What an event's file is called.
const FILE: &str = "event.toml";

fn matching(pattern: &str) -> Result<Vec<Listed>> {
    let paths = glob::glob(pattern).map_err(|error| {
        Error::input(format!("the pattern {}: {error}", quoted(pattern)))
    })?;
    let is_event = |path: &PathBuf| path.join(FILE).is_file() || is_file(path);
    let paths = paths.filter_map(std::result::Result::ok).filter(is_event);
    Ok(paths.map(Listed::of).collect())
}

fn is_file(path: &Path) -> bool {
    path.is_file() && path.extension().is_some_and(|e| e == "toml")
}

fn of_csv(list: &Path) -> Result<Vec<Listed>> {
    let wrong = |error: csv::Error| {
        Error::input(format!(
            "{}: it could not be read as CSV: {error}",
            place(list)
        ))
    };
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_path(list)
        .map_err(wrong)?;
    let head = reader.headers().map_err(wrong)?.clone();
    let Some(at) = head.iter().position(|name| name == EVENT) else {
        return Err(Error::input(format!(
            "{}:1: no column is called event; expected one, with the path of \
             an event folder in each line",
            place(list)
        )));
    };
    let folder = list.parent().unwrap_or(Path::new(""));
    let mut events = Vec::new();
    for line in reader.records() {
        let line = line.map_err(wrong)?;
        let event = folder.join(line.get(at).unwrap_or_default());
        let cells = head.iter().zip(&line);
        let said =
            cells.filter(|(name, cell)| *name != EVENT && !cell.is_empty());
        let options = said.map(|(name, cell)| format!("--{name}={cell}"));
        let options = options.map(OsString::from).collect();
        events.push(Listed { event, options });
    }
    Ok(events)
}

/// The column with the paths.
const EVENT: &str = "event";

#[cfg(test)]
mod tests {
    use super::*;

    fn fresh(name: &str) -> PathBuf {
        let id = std::process::id();
        let folder =
            std::env::temp_dir().join(format!("couloir-listed-{name}-{id}"));
        let _ = fs::remove_dir_all(&folder);
        for event in ["b/2", "a", "b/1"] {
            fs::create_dir_all(folder.join(event)).unwrap();
            fs::write(folder.join(event).join(FILE), "").unwrap();
        }
        fs::create_dir_all(folder.join("empty")).unwrap();
        fs::create_dir_all(folder.join("a/corrected")).unwrap();
        fs::write(folder.join("a/corrected").join(FILE), "").unwrap();
        folder
    }

    fn names(list: &Path, folder: &Path) -> Vec<String> {
        let all = listed(list).unwrap();
        let of = |one: &Listed| {
            let name = one.name();
            let within = name.strip_prefix(folder.to_str().unwrap()).unwrap();
            within.trim_start_matches('/').to_owned()
        };
        all.iter().map(of).collect()
    }

    #[test]
    fn folders_and_patterns_are_listed_in_order() {
        let folder = fresh("folders");
        assert_eq!(names(&folder, &folder), ["a", "b/1", "b/2"]);
        assert_eq!(names(&folder.join("b/*"), &folder), ["b/1", "b/2"]);
        assert_eq!(names(&folder.join("a"), &folder), ["a"]);
        for none in ["empty", "missing", "missing/*"] {
            let error = listed(&folder.join(none)).unwrap_err();
            assert!(error.is_input(), "{error}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_table_says_options_of_each_event() {
        let folder = fresh("table");
        let list = folder.join("list.csv");
        let rows = "event, seed,friction\na,3,\nb/1,,voellmy\na,4,\n";
        fs::write(&list, rows).unwrap();
        let found = names(&list, &folder);
        assert_eq!(
            found,
            ["a --seed=3", "b/1 --friction=voellmy", "a --seed=4"]
        );
        fs::write(&list, "path\na\n").unwrap();
        let error = listed(&list).unwrap_err().to_string();
        assert!(error.contains("no column is called event"), "{error}");
        fs::remove_dir_all(&folder).unwrap();
    }
}
