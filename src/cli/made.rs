//! What a command makes, without a terminal or a folder: for programs that
//! carry the command's work in themselves, as the Python package does.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use serde_json::Value;

use super::answer::typed;
use super::refused::refused;
use super::{Command, parsed, parsed_last};
use crate::error::{Error, Result};
use crate::export::InferenceData;
use crate::infer::{Progress, Quiet};
use crate::io::{prepare_run, write_run};
use crate::physics::friction::Laws;

/// Files by their names in the folder of the results.
pub type Files = Vec<(PathBuf, Vec<u8>)>;

/// What a command makes.
#[derive(Debug)]
#[non_exhaustive]
pub struct Made {
    /// The files that `--out` would have written.
    pub files: Files,
    /// The events that it was made of: files of theirs are not replaced.
    pub reads: Vec<PathBuf>,
    /// The draws with what they say of the data, or why there is no such
    /// thing; without a group where there are no draws.
    pub data: Result<InferenceData>,
}

impl Made {
    /// Writes the files as the command does with `--out`: all of them, in
    /// place of what an earlier run wrote there, and of nothing else.
    ///
    /// # Errors
    /// A folder that cannot be written, or that has a file in the way.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let names = self.files.iter();
        let names: Vec<_> =
            names.map(|(name, _)| name.to_string_lossy()).collect();
        let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
        prepare_run(folder, &names, &self.reads)?;
        write_run(folder, &self.files)
    }
}

/// Does what `couloir` does with these words behind its name, and hands over
/// what it would have written: `calibrate`, `diagnose`, `simulate`, `import`.
///
/// ```
/// use couloir::infer::Quiet;
/// use couloir::physics::friction::Laws;
/// let words = ["simulate".into(), "--set=mu=0.01".into()];
/// let made = couloir::cli::made(&Laws::default(), &words, &Quiet)?;
/// let names: Vec<_> = made.files.iter().map(|(name, _)| name).collect();
/// assert_eq!(names.len(), 2);
/// assert!(names[1].ends_with("simulation.json"));
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// Words that the command does not take, or another of its commands; and
/// whatever the command ends with.
pub fn made(
    laws: &Laws,
    words: &[OsString],
    progress: &dyn Progress,
) -> Result<Made> {
    let cli = parsed(laws, words).map_err(|e| refused(&e))?;
    let typed = typed(words);
    match &cli.command {
        Command::Calibrate(of) => of.made(laws, progress, &typed),
        Command::Diagnose(of) => of.made(laws, progress, &typed),
        Command::Simulate(of) => of.made(laws, &typed),
        #[cfg(feature = "import")]
        Command::Import(of) => of.made(),
        _ => Err(Error::input(format!(
            "{typed}: expected calibrate, diagnose, simulate or import; run \
             the others as commands"
        ))),
    }
}

/// The JSON document of a command that looks at one event. Of an option that
/// is given twice, the last holds.
pub(super) fn document(laws: &Laws, words: &[OsString]) -> Result<Value> {
    let cli = parsed_last(laws, words).map_err(|e| refused(&e))?;
    match &cli.command {
        Command::Calibrate(of) => of.document(laws),
        Command::Compare(of) => of.document(laws, &Quiet),
        Command::Diagnose(of) => of.document(laws),
        _ => Err(Error::input(format!(
            "{}: expected calibrate, compare or diagnose",
            typed(words)
        ))),
    }
}

/// An event that a command's words name.
pub(super) fn event(laws: &Laws, words: &[OsString]) -> Option<PathBuf> {
    let events = match parsed_last(laws, words).ok()?.command {
        Command::Calibrate(of) => of.paths().to_vec(),
        Command::Compare(of) => of.paths().to_vec(),
        Command::Diagnose(of) => of.paths().to_vec(),
        _ => Vec::new(),
    };
    events.into_iter().next()
}

/// What would be refused of a command's words before it does anything, and of
/// what kind that is.
pub(super) fn refusal(
    laws: &Laws,
    words: &[OsString],
) -> Option<(ErrorKind, Error)> {
    let error = parsed_last(laws, words).err()?;
    Some((error.kind(), refused(&error)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::Quiet;

    fn refused(words: &[&str]) -> String {
        let words: Vec<OsString> = words.iter().map(Into::into).collect();
        let made = made(&Laws::default(), &words, &Quiet);
        let error = made.err().unwrap();
        assert!(error.is_input(), "{error}");
        error.to_string()
    }

    #[test]
    fn words_that_are_wrong_are_told_as_in_a_terminal() {
        let seed = refused(&["calibrate", "--seed=x"]);
        assert!(seed.starts_with("invalid value 'x' for '--seed"), "{seed}");
        let none = refused(&["calibrate", "--friction=voelmy"]);
        assert!(none.contains("voellmy"), "{none}");
        let other = refused(&["bench"]);
        assert!(other.starts_with("couloir bench: expected"), "{other}");
        refused(&["calibrate", "--help"]);
    }
}
