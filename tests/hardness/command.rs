//! The command on a small synthetic event, for tests of what is around it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub(crate) const EVENT: &str = include_str!("corpus/event/plain.toml");
pub(crate) const TRACK: &str = include_str!("corpus/track/plain.csv");
pub(crate) const RECORDING: &str = include_str!("corpus/recording/plain.csv");

/// A folder of this name that is not there yet.
pub(crate) fn fresh(name: &str) -> PathBuf {
    let id = std::process::id();
    let folder = std::env::temp_dir().join(format!("couloir-{name}-{id}"));
    let _ = fs::remove_dir_all(&folder);
    folder
}

/// An event folder, with another event.toml where one is given.
pub(crate) fn event(folder: &Path, toml: &str) {
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join("event.toml"), toml).unwrap();
    fs::write(folder.join("track.csv"), TRACK).unwrap();
    fs::write(folder.join("recording.csv"), RECORDING).unwrap();
}

pub(crate) fn couloir(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_couloir"))
        .args(words)
        .env("COLUMNS", "80")
        .output()
        .unwrap()
}

/// What a command printed, on both streams.
pub(crate) fn told(output: &Output) -> String {
    let both = [&output.stdout[..], &output.stderr].concat();
    String::from_utf8(both).unwrap()
}
