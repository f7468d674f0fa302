//! What was read: the files of an event with their checksums.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};
use toml_edit::Item;

use super::corrected::{FILES, editable};
use super::embedded;
use super::event_file::{MOST_BYTES, find};
use super::source::{read_data, read_text};
use crate::error::Result;

/// The files of an event by their names, each with its SHA-256: event.toml
/// and those that it names. The event is the built-in one where no path is
/// given.
///
/// # Errors
/// Files that can no longer be read.
pub(crate) fn inputs(
    event: Option<&Path>,
) -> Result<BTreeMap<String, String>> {
    let Some(path) = event else {
        return Ok(BTreeMap::from([
            ("event.toml".to_owned(), sha256(embedded::EVENT.as_bytes())),
            (
                "recording.csv".to_owned(),
                sha256(embedded::recording().as_bytes()),
            ),
        ]));
    };
    let file = find(path)?;
    let text = read_text(&file, MOST_BYTES)?;
    let called = file.file_name().unwrap_or_default().to_string_lossy();
    let mut all =
        BTreeMap::from([(called.into_owned(), sha256(text.as_bytes()))]);
    let folder = file.parent().unwrap_or(Path::new(""));
    for name in named(&text, &file)? {
        let data = read_data(&folder.join(&name))?;
        all.insert(name, sha256(data.as_bytes()));
    }
    Ok(all)
}

/// The paths of the files that an event, or one file by itself, is read from.
///
/// # Errors
/// A path where there is no event.
pub(super) fn read_for(path: &Path) -> Result<Vec<PathBuf>> {
    let file = find(path)?;
    let names = read_text(&file, MOST_BYTES).and_then(|t| named(&t, &file));
    let folder = file.parent().unwrap_or(Path::new(""));
    // A file that is no event names none.
    let names = names.unwrap_or_default().into_iter();
    let others: Vec<PathBuf> = names.map(|name| folder.join(name)).collect();
    Ok([vec![file.clone()], others].concat())
}

/// The files that an event.toml names.
fn named(text: &str, file: &Path) -> Result<Vec<String>> {
    let document = editable(text, file)?;
    let of = |(section, key, _): (&str, &str, &str)| {
        let section = document.get(section).and_then(Item::as_table_like)?;
        section.get(key)?.as_str().map(str::to_owned)
    };
    Ok(FILES.into_iter().filter_map(of).collect())
}

/// The SHA-256 of what is in a file, in hexadecimal digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    digits(&Sha256::digest(bytes))
}

/// The same of what a reader gives.
pub(crate) fn sha256_of(mut file: impl Read) -> std::io::Result<String> {
    let (mut hasher, mut bytes) = (Sha256::new(), [0; 1 << 16]);
    loop {
        let count = file.read(&mut bytes)?;
        if count == 0 {
            return Ok(digits(&hasher.finalize()));
        }
        hasher.update(&bytes[..count]);
    }
}

fn digits(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checksum_is_the_published_one() {
        // FIPS 180-4, example of one block.
        let known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61\
                     f20015ad";
        assert_eq!(sha256(b"abc"), known);
        assert_eq!(sha256_of(&b"abc"[..]).unwrap(), known);
    }

    #[test]
    fn all_files_of_an_event_are_counted() {
        let text = "[track]\nfile = \"t.csv\"\n[recording]\nfile = \"r.csv\"\n\
                    [flow]\ndepth = 1.0\n";
        let names = named(text, Path::new("event.toml")).unwrap();
        assert_eq!(names, ["t.csv", "r.csv"]);
        assert_eq!(inputs(None).unwrap().len(), 2);
    }
}
