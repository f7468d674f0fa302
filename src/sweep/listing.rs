//! What `sweep.json` says of the events, read again.

use std::io::ErrorKind;
use std::path::Path;

use serde::Deserialize;

use crate::error::{Error, Result};
use crate::io::place;

#[derive(Debug, Deserialize)]
struct Listing {
    verb: String,
    rows: Vec<Row>,
}

/// An event of a sweep.
#[derive(Debug, Deserialize)]
pub(crate) struct Row {
    pub(crate) event: String,
    /// The key of its task; none of an event that was not read.
    pub(crate) task: Option<String>,
}

/// The events of a folder's sweep of calibrations.
///
/// # Errors
/// A folder without the summary of such a sweep.
pub(crate) fn calibrated(folder: &Path) -> Result<Vec<Row>> {
    let path = folder.join("sweep.json");
    let wrong = |why: &str| {
        Error::input(format!(
            "{}: {why}; expected the summary of a sweep of calibrations: run \
             couloir sweep LIST --verb calibrate --out {}",
            place(&path),
            place(folder)
        ))
    };
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(wrong("does not exist"));
        }
        Err(error) => return Err(wrong(&error.to_string())),
    };
    let listing: Listing = serde_json::from_str(&text)
        .map_err(|error| wrong(&error.to_string()))?;
    match listing.verb.as_str() {
        "calibrate" => Ok(listing.rows),
        verb => Err(wrong(&format!("it is of the command {verb}"))),
    }
}
