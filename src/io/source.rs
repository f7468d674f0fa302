//! Opening and reading files, with what went wrong said for people.

use std::fs::File;
use std::io::{ErrorKind, Read, Take};
use std::path::Path;

use super::words::place;
use crate::error::{Error, Result};

/// The most bytes that a data file may have: 134 for each of as many rows as
/// there may be.
pub(super) const MOST_DATA: u64 = 1 << 27;

/// Opens a file that exists and is a file, up to the end that it has now:
/// what a system makes up as it is read, as in `/proc`, has none, and may keep
/// a reader waiting.
pub(super) fn open(path: &Path) -> Result<Take<File>> {
    let refuse = |error: &std::io::Error| refused(path, error);
    let about = std::fs::metadata(path).map_err(|e| refuse(&e))?;
    if about.is_dir() {
        return Err(Error::input(format!(
            "{}: is a folder; expected a file",
            place(path)
        )));
    }
    if !about.is_file() {
        return Err(Error::input(format!(
            "{}: is not a regular file (a device or a pipe); expected a \
             file: copy the data into one",
            place(path)
        )));
    }
    let file = File::open(path).map_err(|e| refuse(&e))?;
    Ok(file.take(about.len()))
}

/// Opens a data file of an event.
pub(super) fn open_data(path: &Path) -> Result<Take<File>> {
    let file = open(path)?;
    match file.limit() <= MOST_DATA {
        true => Ok(file),
        false => Err(Error::input(format!(
            "{}: has more than {MOST_DATA} bytes; expected at most as many: \
             thin the rows out, and drop columns that are not used",
            place(path)
        ))),
    }
}

/// Reads a text of at most `limit` bytes.
pub(super) fn read_text(path: &Path, limit: u64) -> Result<String> {
    let mut bytes = Vec::new();
    open(path)?
        .take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| refused(path, &error))?;
    if bytes.len() as u64 > limit {
        return Err(Error::input(format!(
            "{}: has more than {limit} bytes; expected the few lines of an \
             event.toml",
            place(path)
        )));
    }
    text_of(bytes, path, "an event.toml")
}

/// Reads a data file of an event.
pub(super) fn read_data(path: &Path) -> Result<String> {
    let mut bytes = Vec::new();
    open_data(path)?
        .read_to_end(&mut bytes)
        .map_err(|error| refused(path, &error))?;
    text_of(bytes, path, "a CSV table")
}

fn text_of(bytes: Vec<u8>, path: &Path, what: &str) -> Result<String> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = line_of(error.as_bytes(), valid);
        Error::input(format!(
            "{}:{line}: is not UTF-8 text; expected {what} saved as UTF-8",
            place(path)
        ))
    })
}

/// The number of the line that holds the byte at `offset`.
pub(super) fn line_of(text: &[u8], offset: usize) -> usize {
    let before = &text[..offset.min(text.len())];
    1 + before.iter().filter(|byte| **byte == b'\n').count()
}

/// The error for a file that the machine would not open or read.
fn refused(path: &Path, error: &std::io::Error) -> Error {
    let message = match error.kind() {
        ErrorKind::NotFound => {
            "does not exist; expected a file: check the path".to_owned()
        }
        ErrorKind::NotADirectory => {
            "does not exist, because a part of the path is a file; check \
             the path"
                .to_owned()
        }
        ErrorKind::PermissionDenied => {
            "may not be read (permission denied); expected a file that you \
             may read: change its permissions"
                .to_owned()
        }
        _ => format!("could not be read ({error}); expected a readable file"),
    };
    Error::input(format!("{}: {message}", place(path)))
}
