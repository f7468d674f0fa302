//! Files of other programs: read whole, whatever is in them.

use std::io::Read as _;
use std::path::Path;

use super::source::open;
use super::words::place;
use crate::error::{Error, Result};

/// The most bytes of such a file: a day's log at 20 Hz, a terrain model of
/// some ten million cells.
const MOST: u64 = 1 << 29;

/// The bytes of a file.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = open(path)?.take(MOST + 1).read_to_end(&mut bytes);
    read.map_err(|error| {
        Error::input(format!(
            "{}: could not be read to its end ({error}); expected a readable \
             file",
            place(path)
        ))
    })?;
    if bytes.len() as u64 > MOST {
        return Err(Error::input(format!(
            "{}: has more than {MOST} bytes; expected at most as many: cut \
             it to the part that matters",
            place(path)
        )));
    }
    Ok(bytes)
}

/// The text of a file, without a byte order mark. What is not UTF-8, such as
/// a degree sign of another encoding in a header, is replaced: it cannot be
/// part of a number, and a number that it stands in is refused later. Lines
/// end in a line feed, however they did in the file.
pub(crate) fn read_any_text(path: &Path) -> Result<String> {
    let bytes = read_bytes(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let text = text.trim_start_matches('\u{feff}');
    Ok(match text.contains('\r') {
        true => text.replace("\r\n", "\n").replace('\r', "\n"),
        false => text.to_owned(),
    })
}
