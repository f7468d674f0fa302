//! What a long run has computed so far, on the disk: the same run begun again
//! after a kill takes from there what it would compute again.
//!
//! A run is a function of its inputs and its seed. What costs is parts of it
//! that depend on nothing else: a density at a point, a case, a series. Each
//! is kept under a name, so that no algorithm has to say how far it is: begun
//! again it goes the same way, and finds the parts that it has been through.
//!
//! ```
//! use couloir::checkpoint::Checkpoint;
//! # let folder = std::env::temp_dir();
//! # let path = folder.join(format!("checkpoint-{}", std::process::id()));
//! let first = Checkpoint::open(&path, "study of seed 1")?;
//! let found = first.part("series 3", || Ok(vec![0.5, f64::NAN]))?;
//! first.write(); // A kill would lose the last second.
//! let again = Checkpoint::open(&path, "study of seed 1")?;
//! let kept = again.part("series 3", || -> couloir::Result<Vec<f64>> {
//!     unreachable!("it is kept")
//! })?;
//! assert_eq!(found[0], kept[0]);
//! again.remove();
//! # Ok::<(), couloir::Error>(())
//! ```

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result};

/// How a file begins; behind it is the run's own hash.
const HEAD: &[u8; 21] = b"couloir checkpoint 1\n";

/// How many bytes stand before the parts.
const BEFORE: usize = HEAD.len() + size_of::<u128>();

/// How long parts wait to be written: what a kill loses at most.
const WAITS: Duration = Duration::from_secs(1);

/// After how many bytes parts wait no longer. Most runs are over within their
/// first second, and write nothing.
const MOST_WAITING: usize = 4 << 20;

/// How large a file may grow: it is held in memory where a run goes on. Parts
/// beyond it are computed again.
const MOST: usize = 1 << 30;

/// How long a part's name is, with how many bytes it has.
const NAMED: usize = size_of::<u128>() + size_of::<u32>();

/// How long a block's check is, with how many bytes it has.
const CHECKED: usize = size_of::<u64>() + size_of::<u32>();

/// The name of a part, as a hash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Name(u128);

impl Name {
    /// The name of what such values say. A chance of two alike in 2^128 is
    /// none; that another compiler hashes otherwise loses no more than time.
    pub(crate) fn of(values: impl Hash) -> Self {
        let half = |salt: u8| {
            let mut hasher = DefaultHasher::new();
            salt.hash(&mut hasher);
            values.hash(&mut hasher);
            u128::from(hasher.finish())
        };
        Self(half(0) << 64 | half(1))
    }
}

/// The parts of a run.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    /// What an earlier run kept, one part after the other, and where each is.
    bytes: Vec<u8>,
    found: HashMap<Name, Range<usize>>,
    growing: Mutex<Growing>,
}

/// What is yet to be written.
#[derive(Debug)]
struct Growing {
    /// How the file begins: with the run's name.
    head: Vec<u8>,
    /// How much of the file is whole; `None` once it could not be written.
    length: Option<usize>,
    file: Option<File>,
    waiting: Vec<u8>,
    since: Instant,
}

impl Checkpoint {
    /// The checkpoint of a run: empty where none was kept there, or another
    /// run's. `run` says everything that the results follow from. Nothing is
    /// written before there are parts of a second.
    ///
    /// # Errors
    /// A file that is there and cannot be read.
    pub fn open(path: &Path, run: &str) -> Result<Self> {
        let Name(run) = Name::of(run);
        let head = [&HEAD[..], &run.to_le_bytes()].concat();
        let mut bytes = match fs::read(path) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(failed(path, "read", &error)),
        };
        let (found, length) = match bytes.starts_with(&head) {
            true => parts(&bytes),
            false => (HashMap::new(), 0),
        };
        bytes.truncate(length);
        let growing = Growing {
            head,
            length: Some(length),
            file: None,
            waiting: vec![0; CHECKED],
            since: Instant::now(),
        };
        let growing = Mutex::new(growing);
        Ok(Self { path: path.to_owned(), bytes, found, growing })
    }

    /// How many parts an earlier run kept.
    pub fn parts(&self) -> usize {
        self.found.len()
    }

    /// The part of this name: as it was kept, or made now and kept. Numbers
    /// come back as they were, to the last bit.
    ///
    /// # Errors
    /// That of `make`.
    pub fn part<T: Serialize + DeserializeOwned>(
        &self,
        name: &str,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<T> {
        let name = Name::of(name);
        let kept = self.get(name).and_then(|b| postcard::from_bytes(b).ok());
        if let Some(part) = kept {
            return Ok(part);
        }
        let part = make()?;
        // What cannot be put as bytes is made again.
        if let Ok(bytes) = postcard::to_allocvec(&part) {
            self.put(name, |kept| kept.extend_from_slice(&bytes));
        }
        Ok(part)
    }

    /// What an earlier run kept under a name.
    pub(crate) fn get(&self, name: Name) -> Option<&[u8]> {
        self.found.get(&name).map(|place| &self.bytes[place.clone()])
    }

    /// Keeps what `write` adds under a name.
    pub(crate) fn put(&self, name: Name, write: impl FnOnce(&mut Vec<u8>)) {
        let lock = self.growing.lock();
        let mut growing = lock.unwrap_or_else(PoisonError::into_inner);
        growing.add(name, write);
        let is_full = growing.waiting.len() > MOST_WAITING;
        if is_full || growing.since.elapsed() > WAITS {
            growing.write(&self.path);
        }
    }

    /// Writes what waits to be written.
    pub fn write(&self) {
        let lock = self.growing.lock();
        lock.unwrap_or_else(PoisonError::into_inner).write(&self.path);
    }

    /// Removes it: the run has come to its end.
    pub fn remove(self) {
        let path = self.path.clone();
        let lock = self.growing.lock();
        lock.unwrap_or_else(PoisonError::into_inner).length = None;
        drop(self);
        // What was never written is not there.
        let _ = fs::remove_file(path);
    }
}

impl Drop for Checkpoint {
    /// Writes what waits, where the run that an error ended was a long one.
    fn drop(&mut self) {
        let growing = self.growing.get_mut();
        let growing = growing.unwrap_or_else(PoisonError::into_inner);
        if growing.file.is_some() {
            growing.write(&self.path);
        }
    }
}

impl Growing {
    fn add(&mut self, name: Name, write: impl FnOnce(&mut Vec<u8>)) {
        if self.length.is_none_or(|length| length > MOST) {
            return;
        }
        self.waiting.extend_from_slice(&name.0.to_le_bytes());
        let at = self.waiting.len();
        self.waiting.extend_from_slice(&[0; 4]);
        write(&mut self.waiting);
        let length = (self.waiting.len() - at - 4) as u32;
        self.waiting[at..at + 4].copy_from_slice(&length.to_le_bytes());
    }

    /// Writes what waits as a block with its length and its check. Where that
    /// fails, the run goes on without.
    fn write(&mut self, path: &Path) {
        let Some(length) = self.length else { return };
        if self.waiting.len() == CHECKED {
            return;
        }
        let body = &self.waiting[CHECKED..];
        let head = (body.len() as u32, check(&self.head, body));
        self.waiting[..4].copy_from_slice(&head.0.to_le_bytes());
        self.waiting[4..CHECKED].copy_from_slice(&head.1.to_le_bytes());
        self.length = self.append(path, length).ok();
        if self.length.is_none() {
            // What room there is, is for the results.
            let _ = fs::remove_file(path);
        }
        self.waiting.truncate(CHECKED);
        self.since = Instant::now();
    }

    fn append(
        &mut self,
        path: &Path,
        length: usize,
    ) -> std::io::Result<usize> {
        let mut block = std::mem::take(&mut self.waiting);
        if self.file.is_none() {
            self.file = Some(opened(path, length)?);
            if length == 0 {
                block.splice(..0, self.head.iter().copied());
            }
        }
        let mut file =
            self.file.as_ref().ok_or(std::io::ErrorKind::NotFound)?;
        file.write_all(&block)?;
        self.waiting = block;
        Ok(length + self.waiting.len())
    }
}

/// The file, to be added to behind what is whole of it.
fn opened(path: &Path, length: usize) -> std::io::Result<File> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let file = OpenOptions::new().append(true).create(true).open(path)?;
    file.set_len(length as u64)?;
    Ok(file)
}

/// Where the parts of a file are, and how much of it is whole: a kill or a
/// loss of power may have torn its last block.
fn parts(bytes: &[u8]) -> (HashMap<Name, Range<usize>>, usize) {
    let mut found = HashMap::new();
    let mut at = BEFORE;
    while let Some(end) = block(bytes, at) {
        let mut part = at + CHECKED;
        while let Some((name, place)) = named(&bytes[..end], part) {
            part = place.end;
            found.insert(name, place);
        }
        at = end;
    }
    (found, at)
}

/// Where the block at a place ends, if it is whole.
fn block(bytes: &[u8], at: usize) -> Option<usize> {
    let head = bytes.get(..BEFORE)?;
    let (length, rest) = bytes.get(at..)?.split_first_chunk()?;
    let (sum, rest) = rest.split_first_chunk()?;
    let body = rest.get(..u32::from_le_bytes(*length) as usize)?;
    let is_whole = u64::from_le_bytes(*sum) == check(head, body);
    is_whole.then_some(at + CHECKED + body.len())
}

/// The name of the part at a place, and where its own bytes are.
fn named(bytes: &[u8], at: usize) -> Option<(Name, Range<usize>)> {
    let (name, rest) = bytes.get(at..)?.split_first_chunk()?;
    let (length, rest) = rest.split_first_chunk()?;
    let own = rest.get(..u32::from_le_bytes(*length) as usize)?;
    let begin = at + NAMED;
    Some((Name(u128::from_le_bytes(*name)), begin..begin + own.len()))
}

/// The check of a block of the run with such a head: what another run wrote into
/// the same file meanwhile is none of its own.
fn check(head: &[u8], body: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(head);
    hasher.write(body);
    hasher.finish()
}

fn failed(path: &Path, what: &str, error: &std::io::Error) -> Error {
    Error::system(format!(
        "{path:?}: the checkpoint could not be {what}: {error}; remove it, and \
         the run begins anew"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fresh(name: &str) -> PathBuf {
        let id = std::process::id();
        let path =
            std::env::temp_dir().join(format!("couloir-kept-{name}-{id}"));
        let _ = fs::remove_file(&path);
        path
    }

    fn kept(checkpoint: &Checkpoint, name: &str) -> Option<f64> {
        let none = || Err(Error::input("made anew"));
        checkpoint.part(name, none).ok()
    }

    #[test]
    fn parts_come_back_to_the_last_bit() {
        let path = fresh("bits");
        let values = [0.1 + 0.2, f64::NAN, -0.0, f64::NEG_INFINITY, 5e-324];
        let first = Checkpoint::open(&path, "a").unwrap();
        for (i, value) in values.iter().enumerate() {
            first.part(&format!("{i}"), || Ok(*value)).unwrap();
        }
        first.write();
        let again = Checkpoint::open(&path, "a").unwrap();
        assert_eq!(again.parts(), values.len());
        for (i, value) in values.iter().enumerate() {
            let found = kept(&again, &format!("{i}")).unwrap();
            assert_eq!(found.to_bits(), value.to_bits());
        }
        again.remove();
        assert!(!path.exists());
    }

    #[test]
    fn another_run_begins_anew() {
        let path = fresh("other");
        let first = Checkpoint::open(&path, "a").unwrap();
        first.part("1", || Ok(1.0)).unwrap();
        first.write();
        let other = Checkpoint::open(&path, "b").unwrap();
        assert_eq!(kept(&other, "1"), None);
        other.part("1", || Ok(2.0)).unwrap();
        other.write();
        assert_eq!(Checkpoint::open(&path, "a").unwrap().parts(), 0);
        let other = Checkpoint::open(&path, "b").unwrap();
        assert_eq!(kept(&other, "1"), Some(2.0));
        other.remove();
    }

    /// Three blocks of two parts each, cut at every byte; and every byte of
    /// them changed.
    #[test]
    fn what_is_torn_or_damaged_is_made_again() {
        let path = fresh("torn");
        for block in 0..3 {
            let one = Checkpoint::open(&path, "a").unwrap();
            for part in 2 * block..2 * block + 2 {
                one.part(&format!("{part}"), || Ok(f64::from(part))).unwrap();
            }
            one.write();
        }
        let whole = fs::read(&path).unwrap();
        let each = (whole.len() - BEFORE) / 3;
        let right = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            let found = Checkpoint::open(&path, "a").unwrap();
            for part in 0..6 {
                let value = kept(&found, &format!("{part}"));
                assert!(value.is_none_or(|value| value == f64::from(part)));
            }
            found.parts()
        };
        for length in 0..=whole.len() {
            let blocks = length.saturating_sub(BEFORE) / each;
            assert_eq!(right(&whole[..length]), 2 * blocks, "{length} bytes");
        }
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 1;
            let before = at.saturating_sub(BEFORE) / each;
            assert_eq!(right(&bytes), 2 * before, "byte {at}");
        }
        // What is added behind a torn block is found.
        fs::write(&path, &whole[..whole.len() - 3]).unwrap();
        let torn = Checkpoint::open(&path, "a").unwrap();
        torn.part("7", || Ok(7.0)).unwrap();
        torn.write();
        let mended = Checkpoint::open(&path, "a").unwrap();
        assert_eq!((mended.parts(), kept(&mended, "7")), (5, Some(7.0)));
        mended.remove();
    }

    #[test]
    fn a_disk_that_takes_nothing_stops_no_run() {
        let path = Path::new("/dev/null/below/a/file");
        let Ok(run) = Checkpoint::open(path, "a") else { return };
        assert_eq!(run.part("1", || Ok(1.0)).unwrap(), 1.0);
    }

    #[test]
    fn what_another_run_wrote_between_is_not_taken() {
        let path = fresh("between");
        let [one, other] = ["a", "b"].map(|run| {
            let checkpoint = Checkpoint::open(&path, run).unwrap();
            checkpoint.part("7", || Ok(1.0)).unwrap();
            checkpoint
        });
        one.write();
        other.write();
        one.part("8", || Ok(2.0)).unwrap();
        one.write();
        for run in ["a", "b"] {
            let again = Checkpoint::open(&path, run).unwrap();
            let of_b = run == "b";
            assert_eq!(kept(&again, "7").is_some(), of_b, "{run}");
            assert_eq!(kept(&again, "8"), None, "{run}");
        }
        fs::remove_file(&path).unwrap();
    }
}
