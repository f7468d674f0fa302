//! What a command answers, and whether `--strict` lets it pass.

use std::ffi::OsString;

use clap::Args;

use crate::error::{Error, Result};

/// A refusal to take a result that should not be used for one.
#[derive(Debug, Args)]
pub(super) struct Strict {
    /// End with exit code 4 where the result should not be used, since chains
    /// have not agreed, too few draws are effective, or weights cannot be
    /// trusted; it is told and written all the same
    #[arg(long)]
    strict: bool,
}

impl Strict {
    /// A result with what stands against using it.
    pub(super) fn answer(&self, text: String, doubts: &[String]) -> Answer {
        let refused = doubts.first().filter(|_| self.strict).cloned();
        Answer { refused, ..Answer::from(text) }
    }
}

/// What a command prints.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) text: String,
    /// Why it should not be used, where that was to be told by the exit code.
    pub(super) refused: Option<String>,
    /// Whether some of what was asked for failed, which the text tells.
    pub(super) incomplete: bool,
    /// Why it could not be written, too.
    pub(super) failed: Option<Error>,
}

impl Answer {
    /// The same, after it was written or was not.
    pub(super) fn after(self, wrote: Result<()>) -> Self {
        Self { failed: wrote.err(), ..self }
    }
}

impl From<String> for Answer {
    fn from(text: String) -> Self {
        Self { text, refused: None, incomplete: false, failed: None }
    }
}

/// A command as it was typed, of these words behind the program's name.
pub(super) fn typed(words: &[OsString]) -> String {
    let words = words.iter();
    let words = words.map(|word| quoted_word(&word.to_string_lossy()));
    let typed: Vec<String> =
        ["couloir".to_owned()].into_iter().chain(words).collect();
    typed.join(" ")
}

/// A word of a command as a shell would take it.
pub(super) fn quoted_word(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_=./,:+@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// A JSON document as it is printed and written.
pub(super) fn pretty(document: &serde_json::Value) -> String {
    format!("{document:#}\n")
}

/// A sentence broken into lines, the later ones indented.
pub(super) fn wrapped(sentence: &str, width: usize) -> String {
    let mut text = String::new();
    let mut column = 0;
    for word in sentence.split_whitespace() {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > width {
            text.push_str("\n  ");
            column = 2;
        } else if column > 0 {
            text.push(' ');
            column += 1;
        }
        text.push_str(word);
        column += length;
    }
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_can_be_typed_again() {
        assert_eq!(quoted_word("--rate=2"), "--rate=2");
        assert_eq!(quoted_word("ar(1)"), "'ar(1)'");
        assert_eq!(quoted_word("it's"), r"'it'\''s'");
        assert_eq!(quoted_word(""), "''");
    }
}
