//! What couloir reads back of what it wrote: lists of events, journals, and
//! the list of an earlier run's files.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::Path;

use couloir::Error;
use couloir::cli::{Made, made};
use couloir::infer::Quiet;
use couloir::physics::friction::Laws;
use couloir::sweep::{
    Index, Key, Listed, Outcome, Row, Task, listed, page, summed, write_csv,
    write_json,
};
use serde_json::Value;
use sha2::{Digest as _, Sha256};

pub(crate) fn list(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let path = folder.join("list.csv");
    fs::write(&path, input).unwrap();
    let events = listed(&path)?;
    assert!(!events.is_empty());
    events.iter().for_each(|event| drop(event.name()));
    Ok(())
}

fn digits(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The name of a task, as an event of this folder has it.
fn key(folder: &Path) -> Result<Key, Error> {
    let event = folder.join("event");
    if !event.exists() {
        fs::create_dir_all(&event).unwrap();
        fs::write(event.join("event.toml"), "").unwrap();
    }
    let options = Vec::<OsString>::new();
    let listed = Listed { event, options: options.clone() };
    Ok(Task::new("calibrate", &options, &[listed], 0)?.key)
}

/// Each line of the input is what came of a task; lines have the checksum
/// that they need, but those which are a journal's already.
pub(crate) fn journal(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let key = key(folder)?;
    let results = folder.join("results");
    fs::create_dir_all(&results).unwrap();
    let path = results.join("one.jsonl");
    let mut outcomes = Vec::new();
    for line in input.split(|b| *b == b'\n').take(20) {
        let body = [key.to_string().as_bytes(), b" ", line].concat();
        let check = &digits(&body)[..16];
        let whole = [check.as_bytes(), b" ", &body, b"\n"].concat();
        fs::write(&path, whole).unwrap();
        // A line that is whole and is no outcome is a fault of the disk.
        outcomes.push(Index::of(folder)?.outcome(&key).unwrap_or_default());
    }
    fs::write(&path, input).unwrap();
    Index::of(folder)?.outcome(&key)?;
    summary_of(&outcomes)
}

/// Everything that is told of a sweep.
fn summary_of(outcomes: &[Option<Outcome>]) -> Result<(), Error> {
    let rows = |each: &mut dyn FnMut(&Row) -> io::Result<()>| {
        for outcome in outcomes {
            let (event, outcome) = ("a".to_owned(), outcome.clone());
            let row = Row { event, task: None, outcome };
            each(&row).map_err(|error| Error::system(error.to_string()))?;
        }
        Ok(())
    };
    let summary = summed("diagnose", &rows)?;
    drop((summary.table(), page(&summary, &rows)?));
    let [mut json, mut csv] = [Vec::new(), Vec::new()];
    write_json(&summary, &rows, &mut json).unwrap();
    write_csv(&summary, &rows, &mut csv).unwrap();
    serde_json::from_slice::<Value>(&json).unwrap();
    let lines = csv.iter().filter(|byte| **byte == b'\n').count();
    assert!(lines > outcomes.len());
    Ok(())
}

/// The list of checksums in the folder of an earlier run: nothing outside the
/// folder is touched, whatever it says.
pub(crate) fn earlier(folder: &Path, input: &[u8]) -> Result<(), Error> {
    thread_local! {
        static MADE: Made = made(
            &Laws::default(),
            &["simulate".into(), "--set=mu=0.01".into()],
            &Quiet,
        ).unwrap();
    }
    let (beside, out) = (folder.join("beside"), folder.join("out"));
    fs::write(&beside, "kept").unwrap();
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("couloir.sha256"), input).unwrap();
    let written = MADE.with(|made| made.write(&out));
    assert_eq!(fs::read(&beside).unwrap(), b"kept");
    fs::remove_dir_all(&out).unwrap();
    written
}
