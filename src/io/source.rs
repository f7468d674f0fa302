//! Opening and reading files, with what went wrong said for people.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use super::words::place;
use crate::error::{Error, Result};

/// Opens a file that exists and is a file.
pub(super) fn open(path: &Path) -> Result<File> {
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
    File::open(path).map_err(|e| refuse(&e))
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
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = line_of(error.as_bytes(), valid);
        Error::input(format!(
            "{}:{line}: is not UTF-8 text; expected an event.toml saved as \
             UTF-8",
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
