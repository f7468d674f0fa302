//! The events of a sweep: a folder of folders, a pattern, or a CSV file.

use std::collections::HashSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use super::table::of_csv;
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
/// name, an empty cell being none. Its paths are relative to its folder. An
/// event.toml is a list of one.
///
/// Links are followed. What is met by several paths below a folder, or by a
/// pattern, is listed once: links may lead in a circle.
///
/// # Errors
/// A list that cannot be read, or holds no event.
pub fn listed(list: &Path) -> Result<Vec<Listed>> {
    let text = list.to_string_lossy();
    let is_csv = list.extension().is_some_and(|e| e == "csv");
    let no_list = |what: &str| {
        Error::input(format!(
            "{}: {what}; expected a folder that holds event folders, a \
             pattern such as \"survey/*\", or a CSV file with a column event",
            place(list)
        ))
    };
    let events = match list.exists() {
        true if is_csv && list.is_file() => {
            let lines = of_csv(list)?.into_iter();
            lines.map(|(event, options)| Listed { event, options }).collect()
        }
        true if list.is_dir() => {
            let mut events = Vec::new();
            below(list, &mut HashSet::new(), &mut events)?;
            events
        }
        true if is_file(list) => vec![Listed::of(list.to_owned())],
        true => return Err(no_list("this file is no list")),
        false if text.contains(['*', '?', '[']) => matching(&text)?,
        false => return Err(no_list("there is no such list")),
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

/// The event in a folder, or those in the folders that it holds, but for
/// folders that were met before.
fn below(
    folder: &Path,
    met: &mut HashSet<PathBuf>,
    events: &mut Vec<Listed>,
) -> Result<()> {
    if !is_new(folder, met) {
        return Ok(());
    }
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
        let path = entry.map_err(unread)?.path();
        if path.is_dir() {
            folders.push(path);
        }
    }
    folders.sort();
    folders.iter().try_for_each(|folder| below(folder, met, events))
}

/// Whether a place was not met before, by any path.
fn is_new(path: &Path, met: &mut HashSet<PathBuf>) -> bool {
    // What has no real path fails by itself when it is read.
    let real = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    met.insert(real)
}

/// What an event's file is called.
const FILE: &str = "event.toml";

fn matching(pattern: &str) -> Result<Vec<Listed>> {
    let wrong = |error: &dyn std::fmt::Display| {
        Error::input(format!("the pattern {}: {error}", quoted(pattern)))
    };
    let mut met = HashSet::new();
    let paths: Vec<PathBuf> = if pattern.contains("**") {
        // The crate would go round a circle of links until a path is full.
        let parsed = glob::Pattern::new(pattern).map_err(|e| wrong(&e))?;
        let (mut all, from) = (Vec::new(), before_wildcards(pattern));
        is_new(&from, &mut met);
        every_path(&from, &mut met, &mut all);
        all.retain(|path| parsed.matches_path_with(path, WITHIN));
        all
    } else {
        let paths = glob::glob(pattern).map_err(|e| wrong(&e))?;
        let paths = paths.filter_map(std::result::Result::ok);
        paths.filter(|path| is_new(path, &mut met)).collect()
    };
    let folders: HashSet<&Path> = paths
        .iter()
        .map(PathBuf::as_path)
        .filter(|path| path.join(FILE).is_file())
        .collect();
    // With its folder an event is there already.
    let is_there = |path: &Path| {
        path.ends_with(FILE)
            && path.parent().is_some_and(|p| folders.contains(p))
    };
    let is_event = |path: &&PathBuf| {
        folders.contains(path.as_path()) || is_file(path) && !is_there(path)
    };
    let events = paths.iter().filter(is_event).cloned();
    Ok(events.map(Listed::of).collect())
}

/// As shells match: `*` stays within a folder.
const WITHIN: glob::MatchOptions = glob::MatchOptions {
    case_sensitive: true,
    require_literal_separator: true,
    require_literal_leading_dot: false,
};

/// The folder before the first part of a pattern with a wildcard.
fn before_wildcards(pattern: &str) -> PathBuf {
    let has_wildcard = |part: &std::path::Component<'_>| {
        part.as_os_str().to_string_lossy().contains(['*', '?', '['])
    };
    let parts = Path::new(pattern).components();
    parts.take_while(|part| !has_wildcard(part)).collect()
}

/// All paths below a folder by their order, but for those met before; what
/// cannot be read holds none.
fn every_path(
    folder: &Path,
    met: &mut HashSet<PathBuf>,
    all: &mut Vec<PathBuf>,
) {
    let here =
        if folder.as_os_str().is_empty() { ".".as_ref() } else { folder };
    let entries = fs::read_dir(here).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| folder.join(entry.file_name())).collect();
    paths.sort();
    for path in paths {
        if is_new(&path, met) {
            all.push(path.clone());
            every_path(&path, met, all);
        }
    }
}

fn is_file(path: &Path) -> bool {
    path.is_file() && path.extension().is_some_and(|e| e == "toml")
}

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
        fs::write(folder.join("list.txt"), "a\n").unwrap();
        for none in ["empty", "missing", "missing/*", "list.txt"] {
            let error = listed(&folder.join(none)).unwrap_err();
            assert!(error.is_input(), "{error}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_no_event_is_listed_twice() {
        let folder = fresh("links");
        let far = fresh("far");
        let link = |from: &Path, to: &str| {
            std::os::unix::fs::symlink(from, folder.join(to)).unwrap();
        };
        link(&far.join("a"), "c");
        link(&folder, "b/around");
        link(&folder.join("b"), "d");
        assert_eq!(names(&folder, &folder), ["a", "b/1", "b/2", "c"]);
        let all = names(&folder.join("**/*"), &folder);
        // Events in events too: a pattern says so.
        assert_eq!(all.len(), 6, "{all:?}");
        assert!(all.contains(&"c/corrected".to_owned()), "{all:?}");
        let files = names(&folder.join("b/*/event.toml"), &folder);
        assert_eq!(files, ["b/1/event.toml", "b/2/event.toml"]);
        fs::remove_dir_all(&far).unwrap();
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
        for (rows, said) in [
            ("event,seed\na,1\n,2\n", "list.csv:3: the cell of event"),
            ("event,seed\na,1\na\n", "list.csv:3: 1 cells; expected 2"),
        ] {
            fs::write(&list, rows).unwrap();
            let error = listed(&list).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }
}
