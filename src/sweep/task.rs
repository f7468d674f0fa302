//! A task: an event with the options that it is looked at under.

use std::ffi::OsString;
use std::fmt;

use super::listed::Listed;
use crate::error::Result;
use crate::io::{inputs, sha256};
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
