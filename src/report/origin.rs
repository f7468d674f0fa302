//! Where a result comes from: the program, the command, and what was read.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::PROGRAM;

/// How a result can be had again.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Origin {
    /// The command, as it was typed; empty where none was.
    pub command: String,
    /// The SHA-256 checksums of the files that were read, by their names.
    pub inputs: BTreeMap<String, String>,
}

impl Origin {
    /// Adds the keys `program`, `command` and `inputs` to a document.
    ///
    /// ```
    /// use couloir::report::Origin;
    /// let mut document = serde_json::json!({"schema": 1});
    /// let command = "couloir calibrate my-event".to_owned();
    /// let origin = Origin { command, ..Origin::default() };
    /// origin.write_to(&mut document);
    /// assert_eq!(document["command"], "couloir calibrate my-event");
    /// ```
    pub fn write_to(&self, document: &mut Value) {
        document["program"] = json!(PROGRAM);
        if !self.command.is_empty() {
            document["command"] = json!(self.command);
        }
        if !self.inputs.is_empty() {
            document["inputs"] = json!(self.inputs);
        }
    }

    /// The same for a table of facts.
    #[cfg(feature = "pages")]
    pub(crate) fn facts(&self) -> Vec<(String, String)> {
        let mut facts = vec![("program".to_owned(), PROGRAM.to_owned())];
        if !self.command.is_empty() {
            facts.push(("command".to_owned(), self.command.clone()));
        }
        let read = self.inputs.iter();
        facts.extend(read.map(|(name, sum)| {
            let start = sum.get(..SHOWN).unwrap_or(sum);
            (format!("SHA-256 of {name}"), format!("{start}…"))
        }));
        facts
    }
}

/// How much of a checksum is shown: the whole one is in the document.
#[cfg(feature = "pages")]
const SHOWN: usize = 12;
