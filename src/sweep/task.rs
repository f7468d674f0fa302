//! A task: an event with the options that it is looked at under.

use std::ffi::OsString;
use std::fmt;
use std::path::Path;

use super::listed::Listed;
use crate::error::Result;
use crate::io::{inputs, place, sha256};
use crate::report::PROGRAM;

/// The name of a task: the SHA-256 of the program's version, the command and
/// its options, and of the event's files with their names. It holds no path,
/// so that a survey may be moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key([u8; 32]);

impl Key {
    /// Reads what [`Display`](fmt::Display) writes: 64 hexadecimal digits;
    /// `None` of another text.
    pub fn read(text: &str) -> Option<Self> {
        let mut bytes = [0; 32];
        if text.len() != 2 * bytes.len() || !text.is_ascii() {
            return None;
        }
        for (at, byte) in bytes.iter_mut().enumerate() {
            let digits = text.get(2 * at..2 * at + 2)?;
            *byte = u8::from_str_radix(digits, 16).ok()?;
        }
        Some(Self(bytes))
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// A message about an event's files without the path to them: a task that
/// fails says the same wherever the survey is.
pub fn without_path(message: &str, event: &Path) -> String {
    let folder = match event.is_file() {
        true => event.parent().unwrap_or(Path::new("")),
        false => event,
    };
    let folder = place(folder);
    // A name that would break the line is quoted, whole.
    let (quote, folder) = match folder.strip_suffix('"') {
        Some(quoted) => ("\"", quoted),
        None => ("", folder.as_str()),
    };
    let rest = Some(message).filter(|_| !folder.is_empty());
    let rest = rest.and_then(|message| message.strip_prefix(folder));
    let file = rest.and_then(|rest| rest.strip_prefix('/'));
    let itself = rest.and_then(|rest| {
        rest.strip_prefix(quote).and_then(|rest| rest.strip_prefix(": "))
    });
    match (file, itself) {
        (Some(file), _) => format!("{quote}{file}"),
        (_, Some(what)) => what.to_owned(),
        _ => message.to_owned(),
    }
}

/// What is to be done with one event.
#[derive(Debug, Clone, Copy)]
pub struct Task {
    /// Its name.
    pub key: Key,
    /// Its event's place in the list, from 0.
    pub at: usize,
}

impl Task {
    /// The task of the event at a place of a list, under a command and its
    /// options.
    ///
    /// # Errors
    /// Files of the event that cannot be read.
    pub fn new(
        verb: &str,
        options: &[OsString],
        list: &[Listed],
        at: usize,
    ) -> Result<Self> {
        let listed = &list[at];
        let own = options.iter().chain(&listed.options);
        let mut named = vec![PROGRAM.to_owned(), verb.to_owned()];
        named.extend(own.clone().map(|o| o.to_string_lossy().into_owned()));
        let files = inputs(Some(&listed.event))?;
        named.extend(files.into_iter().map(|(name, sum)| name + "\0" + &sum));
        // Lengths keep apart what would read the same when joined.
        let text: String =
            named.iter().map(|n| format!("{}:{n}\n", n.len())).collect();
        let key = Key::read(&sha256(text.as_bytes()));
        Ok(Self { key: key.unwrap_or(Key([0; 32])), at })
    }

    /// The command's words: its name, its options, the event.
    pub fn words(
        &self,
        verb: &str,
        options: &[OsString],
        list: &[Listed],
    ) -> Vec<OsString> {
        let listed = &list[self.at];
        let mut words = vec![OsString::from(verb)];
        words.extend(options.iter().chain(&listed.options).cloned());
        // Behind it nothing is an option, whatever a folder is called.
        words.push("--".into());
        words.push(listed.event.clone().into_os_string());
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_says_the_same_wherever_the_event_is() {
        let found = |message: &str, event: &str| {
            without_path(message, Path::new(event))
        };
        let csv = "a/b/recording.csv:2: speed";
        assert_eq!(found(csv, "a/b"), "recording.csv:2: speed");
        assert_eq!(found("a/b: does not exist", "a/b"), "does not exist");
        // A folder m is no part of a unit.
        assert_eq!(found("8 m/s is little", "m"), "8 m/s is little");
        assert_eq!(found("m/s/event.toml: x", "m/s"), "event.toml: x");
        let odd = place(Path::new("a\nb/event.toml"));
        assert_eq!(found(&(odd + ":1: x"), "a\nb"), "\"event.toml\":1: x");
        assert_eq!(found("a/b", ""), "a/b");
    }
}
