//! A new event folder to start from: `couloir new FOLDER`.

use std::path::{Path, PathBuf};

use super::words::place;
use super::write::write_all;
use crate::error::{Error, Result};

/// The files of a new event: synthetic, and they calibrate as they are.
const FILES: [(&str, &str); 3] = [
    ("event.toml", include_str!("template/event.toml")),
    ("track.csv", include_str!("template/track.csv")),
    ("recording.csv", include_str!("template/recording.csv")),
];

/// Writes a commented event.toml, with a synthetic track.csv and
/// recording.csv, into a folder; returns their paths.
///
/// # Errors
/// An input error where the folder is a file or one of the files exists
/// already, and nothing is written then; a system error where the machine
/// refuses.
pub fn new_event(folder: &Path) -> Result<Vec<PathBuf>> {
    if folder.exists() && !folder.is_dir() {
        return Err(Error::input(format!(
            "{}: is a file; expected a new or an empty folder: give another \
             name",
            place(folder)
        )));
    }
    let paths: Vec<_> =
        FILES.iter().map(|(name, _)| folder.join(name)).collect();
    if let Some(path) = paths.iter().find(|p| p.symlink_metadata().is_ok()) {
        return Err(Error::input(format!(
            "{}: exists already and would be overwritten; expected a new or \
             an empty folder: give another one, or move the file away",
            place(path)
        )));
    }
    write_all(folder, &FILES.map(|(name, text)| (name, text.to_owned())))?;
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise;
    use crate::physics::friction::Laws;
    use crate::prior;

    #[test]
    fn the_comments_list_everything_there_is() {
        let text = FILES[0].1;
        for law in Laws::default().iter() {
            assert!(text.contains(law.name()), "{}", law.name());
            for field in law.fields() {
                let name = format!("{} [{}]", field.name, field.unit);
                assert!(text.contains(&name), "{}: {name}", law.name());
            }
        }
        for name in noise::names() {
            assert!(text.contains(&name), "{name}");
        }
        for (name, _) in prior::NAMES {
            assert!(text.contains(&format!("{name}(")), "{name}");
        }
    }
}
