//! Files outside the folder of the event that names them: they are read, as
//! terrain that events share has to be, and what is in them is not told. A
//! folder that somebody else made may name any file of this machine, and its
//! errors may be read by others.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use super::words::place;
use crate::error::Error;

/// An event's folder, and the files outside it that were read.
#[derive(Debug)]
pub(super) struct Outside {
    /// Where it really is; nothing where that cannot be said.
    folder: Option<PathBuf>,
    read: RefCell<Vec<PathBuf>>,
}

impl Outside {
    pub(super) fn of(folder: &Path) -> Self {
        let here = Path::new(".");
        let named = folder != Path::new("");
        let folder = if named { folder } else { here };
        let folder = folder.canonicalize().ok();
        Self { folder, read: RefCell::default() }
    }

    /// Notes a file that is read, where it is outside: by its path, or since
    /// a link leads there.
    pub(super) fn note(&self, path: &Path) {
        let real = path.canonicalize().ok();
        let is_inside = real
            .zip(self.folder.as_ref())
            .is_some_and(|(file, folder)| file.starts_with(folder));
        if !is_inside {
            self.read.borrow_mut().push(path.to_owned());
        }
    }

    /// An error without what it quotes of such a file: its place stays, with
    /// the number of the line.
    pub(super) fn kept_to_itself(&self, error: Error) -> Error {
        let text = error.to_string();
        let read = self.read.borrow();
        let about = |path: &PathBuf| {
            let place = place(path);
            let rest = text.strip_prefix(&place)?.strip_prefix(':')?;
            let digits = |c: char| c.is_ascii_digit();
            let (line, _) = rest.split_once(|c| !digits(c))?;
            let colon = if line.is_empty() { "" } else { ":" };
            Some(format!("{place}{colon}{line}"))
        };
        match read.iter().find_map(about) {
            None => error,
            Some(place) => Error::input(format!(
                "{place}: is not as expected, and what is there is not told, \
                 since it is outside the event's folder: copy the file into \
                 the folder, and see what is said of it there"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_file_outside_the_line_is_told_and_no_more() {
        let base = std::env::temp_dir();
        let name = format!("couloir-outside-{}", std::process::id());
        let event = base.join(name);
        std::fs::create_dir_all(&event).unwrap();
        let outside = Outside::of(&event);
        let (own, other) = (event.join("a.csv"), event.join("../secret"));
        std::fs::write(&own, "").unwrap();
        outside.note(&own);
        outside.note(&other);
        let said = |path: &Path, rest: &str| {
            let error = Error::input(format!("{}{rest}", place(path)));
            outside.kept_to_itself(error).to_string()
        };
        assert!(said(&own, ":3: is \"x\"").ends_with(":3: is \"x\""));
        let kept = said(&other, ":3: is \"x\"");
        assert!(kept.contains("secret:3: is not as expected"), "{kept}");
        let kept = said(&other, ": has \"x\"");
        assert!(kept.contains("secret: is not as expected"), "{kept}");
        let elsewhere = "event.toml:2: track.file is missing";
        let error = Error::input(elsewhere);
        assert_eq!(outside.kept_to_itself(error).to_string(), elsewhere);
        std::fs::remove_dir_all(&event).unwrap();
    }
}
