//! Results as lines of files that are only ever appended to.
//!
//! A line is a checksum, the task's name and what came of it. A line that was
//! torn by a kill or a loss of power has another checksum than it says, and
//! is as if it had never been written. Every process appends to a journal of
//! its own, so that no two write one file, on a network's file system too.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{
    BufRead as _, BufReader, Read as _, Seek as _, SeekFrom, Write,
};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::task::Key;
use crate::error::{Error, Result};
use crate::io::{place, sha256};

/// What came of a task.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Its result, as JSON.
    Done(Value),
    /// Why there is none.
    Failed(String),
}

impl Outcome {
    /// Whether there is no result.
    pub fn has_failed(&self) -> bool {
        matches!(self, Self::Failed(_))
    }

    fn json(&self) -> Value {
        match self {
            Self::Done(result) => json!({"done": result}),
            Self::Failed(why) => json!({"failed": why}),
        }
    }

    fn read(text: &str) -> Option<Self> {
        let mut value: Value = serde_json::from_str(text).ok()?;
        let members = value.as_object_mut()?;
        if let Some(result) = members.remove("done") {
            return Some(Self::Done(result));
        }
        Some(Self::Failed(members.get("failed")?.as_str()?.to_owned()))
    }
}

/// The longest line that is read, in bytes; couloir writes some thousands.
const LONGEST: u64 = 1 << 26;

/// How many digits of a line's SHA-256 stand before it.
const CHECK: usize = 16;

/// How many digits name a task.
const NAME: usize = 64;

fn written(key: &Key, outcome: &Outcome) -> String {
    let body = format!("{key} {}", outcome.json());
    format!("{} {body}\n", &sha256(body.as_bytes())[..CHECK])
}

/// A line's task and what came of it, unless it is torn.
fn read(line: &str) -> Option<(Key, &str)> {
    let (check, body) = line.split_at_checked(CHECK)?;
    let body = body.strip_prefix(' ')?;
    let is_whole = check == &sha256(body.as_bytes())[..CHECK];
    let (key, text) = body.split_at_checked(NAME)?;
    is_whole.then_some((Key::read(key)?, text.strip_prefix(' ')?))
}

/// Where the journals are within a sweep's folder.
fn folder_of(sweep: &Path) -> PathBuf {
    sweep.join("results")
}

/// How a journal's name ends.
const ENDING: &str = "jsonl";

/// A process's own journal.
#[derive(Debug)]
pub(super) struct Journal {
    file: File,
    path: PathBuf,
}

impl Journal {
    /// A new journal, whose name no other has.
    pub(super) fn create(sweep: &Path, part: &str) -> Result<Self> {
        let folder = folder_of(sweep);
        fs::create_dir_all(&folder)
            .map_err(|error| failed(&folder, &error))?;
        let nonce = nonce();
        let name = format!("{part}-{nonce}.{ENDING}");
        let path = folder.join(name);
        let new = OpenOptions::new().append(true).create_new(true).open(&path);
        let file = new.map_err(|error| failed(&path, &error))?;
        // The names of file and folders have to outlast a loss of power too.
        let real = folder.canonicalize();
        let real = real.map_err(|error| failed(&folder, &error))?;
        for within in real.ancestors().take(NEW_FOLDERS) {
            let synced = File::open(within).and_then(|f| f.sync_all());
            synced.map_err(|error| failed(within, &error))?;
        }
        Ok(Self { file, path })
    }

    /// Adds what came of tasks; it is on the disk when this returns.
    pub(super) fn append(&mut self, all: &[(Key, Outcome)]) -> Result<()> {
        let lines: String =
            all.iter().map(|(key, outcome)| written(key, outcome)).collect();
        let wrote = self.file.write_all(lines.as_bytes());
        let wrote = wrote.and_then(|()| self.file.sync_data());
        wrote.map_err(|error| failed(&self.path, &error))
    }
}

/// How many folders may be new: that of the results, that of the sweep, and
/// the one that this stands in.
const NEW_FOLDERS: usize = 3;

/// When a journal was begun, as its name says.
fn begun(path: &Path) -> Option<u128> {
    let name = path.file_stem()?.to_str()?;
    u128::from_str_radix(name.rsplit('-').next()?, 16).ok()
}

/// What no other process calls its journal: host, process and time.
pub(super) fn nonce() -> String {
    let host = fs::read_to_string("/proc/sys/kernel/hostname");
    let host = host.unwrap_or_default();
    let is_plain = |c: &char| c.is_ascii_alphanumeric();
    let host: String = host.chars().filter(is_plain).take(32).collect();
    let since = std::time::UNIX_EPOCH.elapsed().unwrap_or_default();
    format!("{host}-{}-{:x}", std::process::id(), since.as_nanos())
}

fn failed(path: &Path, error: &std::io::Error) -> Error {
    Error::system(format!(
        "{}: results could not be written: {error}; those before are kept: \
         mend that and run the same again",
        place(path)
    ))
}

/// Where a task's line is.
#[derive(Debug, Clone, Copy)]
struct Entry {
    journal: usize,
    at: u64,
    length: usize,
    failed: bool,
}

/// What the journals of a sweep hold: for each task the place of its line, of
/// the first with a result where there are several, or else of the last
/// failure.
#[derive(Debug)]
pub struct Index {
    folder: PathBuf,
    /// The journals, with how far each has been read.
    journals: Vec<(PathBuf, u64)>,
    entries: HashMap<Key, Entry>,
    /// Journals that cannot hold a task of this process.
    others: Option<Others>,
}

/// The journals of a list's other shards.
#[derive(Debug)]
pub(super) struct Others {
    /// How all journals of the list begin.
    pub(super) list: String,
    /// What is in the names of those of as many shards.
    pub(super) of: String,
    /// How a shard's own begin.
    pub(super) own: String,
}

impl Others {
    fn wrote(&self, path: &Path) -> bool {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(&self.list)
            && name.contains(&self.of)
            && !name.starts_with(&self.own)
    }
}

impl Index {
    /// Reads the journals of a sweep's folder; none where it is not there.
    ///
    /// # Errors
    /// Journals that cannot be read.
    pub fn of(sweep: &Path) -> Result<Self> {
        Self::without(sweep, None)
    }

    /// The same without the journals of others.
    pub(super) fn without(
        sweep: &Path,
        others: Option<Others>,
    ) -> Result<Self> {
        let mut index = Self {
            folder: folder_of(sweep),
            journals: Vec::new(),
            entries: HashMap::new(),
            others,
        };
        index.refresh()?;
        Ok(index)
    }

    /// Reads what was added since.
    ///
    /// # Errors
    /// Journals that cannot be read.
    pub fn refresh(&mut self) -> Result<()> {
        let unread = |error: std::io::Error| unread(&self.folder, &error);
        if !self.folder.exists() {
            return Ok(());
        }
        let mut paths = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(unread)? {
            let path = entry.map_err(unread)?.path();
            let is_journal = path.extension().is_some_and(|e| e == ENDING);
            if is_journal && path.is_file() {
                paths.push(path);
            }
        }
        paths.sort_by_cached_key(|path| (begun(path), path.clone()));
        if let Some(others) = &self.others {
            paths.retain(|path| !others.wrote(path));
        }
        for path in paths {
            let known = self.journals.iter().position(|(p, _)| *p == path);
            let journal = known.unwrap_or_else(|| {
                self.journals.push((path, 0));
                self.journals.len() - 1
            });
            self.read_on(journal)?;
        }
        Ok(())
    }

    /// Reads a journal from where it was left; a line without an end may
    /// still be growing.
    fn read_on(&mut self, journal: usize) -> Result<()> {
        let (path, at) = &mut self.journals[journal];
        let wrong = |error| unread(path, &error);
        let mut file = File::open(&*path).map_err(wrong)?;
        if file.metadata().map_err(wrong)?.len() <= *at {
            return Ok(());
        }
        file.seek(SeekFrom::Start(*at)).map_err(wrong)?;
        let mut lines = BufReader::new(file);
        let mut line = Vec::new();
        loop {
            line.clear();
            let mut short = lines.by_ref().take(LONGEST);
            let length = short.read_until(b'\n', &mut line).map_err(wrong)?;
            if line.pop() != Some(b'\n') {
                return Ok(());
            }
            let text = std::str::from_utf8(&line).unwrap_or_default();
            if let Some((key, text)) = read(text) {
                let failed = text.starts_with("{\"failed\"");
                let entry =
                    Entry { journal, at: *at, length: line.len(), failed };
                let kept = self.entries.entry(key).or_insert(entry);
                // Of failures the last one tells what is wrong now.
                if kept.failed {
                    *kept = entry;
                }
            }
            *at += length as u64;
        }
    }

    /// Whether the task has failed, where it was done.
    pub fn has_failed(&self, key: &Key) -> Option<bool> {
        self.entries.get(key).map(|entry| entry.failed)
    }

    /// What came of a task, read from its line.
    ///
    /// # Errors
    /// A journal that cannot be read, or was changed meanwhile.
    pub fn outcome(&self, key: &Key) -> Result<Option<Outcome>> {
        let Some(entry) = self.entries.get(key) else { return Ok(None) };
        let (path, _) = &self.journals[entry.journal];
        let wrong = |error| unread(path, &error);
        let mut file = File::open(path).map_err(wrong)?;
        file.seek(SeekFrom::Start(entry.at)).map_err(wrong)?;
        let mut bytes = vec![0; entry.length];
        file.read_exact(&mut bytes).map_err(wrong)?;
        let text = std::str::from_utf8(&bytes).unwrap_or_default();
        let outcome = read(text).and_then(|(_, text)| Outcome::read(text));
        let changed = || {
            Error::system(format!(
                "{}: the line at byte {} is no longer what it was; expected \
                 a journal that nobody changes while it is read",
                place(path),
                entry.at
            ))
        };
        outcome.map(Some).ok_or_else(changed)
    }
}

fn unread(path: &Path, error: &std::io::Error) -> Error {
    Error::system(format!(
        "{}: results could not be read: {error}",
        place(path)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fresh(name: &str) -> PathBuf {
        let id = std::process::id();
        let folder =
            std::env::temp_dir().join(format!("couloir-journal-{name}-{id}"));
        let _ = fs::remove_dir_all(&folder);
        folder
    }

    fn key(of: u8) -> Key {
        Key::read(&format!("{of:02x}").repeat(32)).unwrap()
    }

    fn done(number: u8) -> Outcome {
        Outcome::Done(json!({"number": number, "text": "a\nb"}))
    }

    #[test]
    fn a_journal_cut_anywhere_keeps_its_whole_lines() {
        let folder = fresh("cut");
        let mut journal = Journal::create(&folder, "all").unwrap();
        let all: Vec<_> = (0..5).map(|of| (key(of), done(of))).collect();
        journal.append(&all).unwrap();
        let whole = fs::read(&journal.path).unwrap();
        let ends: Vec<usize> = (0..whole.len())
            .filter(|at| whole[*at] == b'\n')
            .map(|at| at + 1)
            .collect();
        for length in 0..=whole.len() {
            fs::write(&journal.path, &whole[..length]).unwrap();
            let index = Index::of(&folder).unwrap();
            let kept = ends.iter().filter(|end| **end <= length).count();
            for (of, (key, outcome)) in all.iter().enumerate() {
                let found = index.outcome(key).unwrap();
                assert_eq!(found, (of < kept).then(|| outcome.clone()));
            }
        }
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_damaged_line_is_as_if_never_written() {
        let folder = fresh("damaged");
        let mut journal = Journal::create(&folder, "all").unwrap();
        journal.append(&[(key(1), done(1)), (key(2), done(2))]).unwrap();
        let whole = fs::read(&journal.path).unwrap();
        let first = whole.iter().position(|b| *b == b'\n').unwrap();
        for at in 0..first {
            let mut bytes = whole.clone();
            bytes[at] ^= 1;
            fs::write(&journal.path, bytes).unwrap();
            let index = Index::of(&folder).unwrap();
            assert_eq!(index.outcome(&key(1)).unwrap(), None, "byte {at}");
            assert_eq!(index.outcome(&key(2)).unwrap(), Some(done(2)));
        }
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn of_failures_the_last_is_told() {
        let folder = fresh("last");
        let failed = |why: &str| Outcome::Failed(why.to_owned());
        // By name the second would be the first.
        for (part, why) in [("b", "disk full"), ("a", "no speed")] {
            let mut journal = Journal::create(&folder, part).unwrap();
            journal.append(&[(key(1), failed(why))]).unwrap();
        }
        let index = Index::of(&folder).unwrap();
        let found = index.outcome(&key(1)).unwrap();
        assert_eq!(found, Some(failed("no speed")));
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_result_takes_the_place_of_a_failure_and_never_the_reverse() {
        let folder = fresh("failure");
        let why = Outcome::Failed("no speed".to_owned());
        let mut index = Index::of(&folder).unwrap();
        let mut one = Journal::create(&folder, "all").unwrap();
        one.append(&[(key(1), why.clone()), (key(2), done(2))]).unwrap();
        index.refresh().unwrap();
        assert_eq!(index.has_failed(&key(1)), Some(true));
        assert_eq!(index.outcome(&key(1)).unwrap(), Some(why.clone()));
        let mut other = Journal::create(&folder, "all").unwrap();
        other.append(&[(key(2), why), (key(1), done(1))]).unwrap();
        index.refresh().unwrap();
        for of in [1, 2] {
            assert_eq!(index.outcome(&key(of)).unwrap(), Some(done(of)));
        }
        assert_eq!(index.has_failed(&key(3)), None);
        fs::remove_dir_all(&folder).unwrap();
    }
}
