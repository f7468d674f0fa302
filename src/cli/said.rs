//! What was said of an event when it was read, behind a command's answer.

use serde_json::{Value, json};

use super::answer::wrapped;
use super::width;
use crate::io::EventFile;

/// What is to be known of how an event was read, and what is doubtful of it.
#[derive(Debug, Clone, Default)]
pub(super) struct Said {
    /// What to know of how it was read, and how its recordings were thinned.
    pub(super) notes: Vec<String>,
    /// What could be true of it and hardly is.
    pub(super) warnings: Vec<String>,
}

impl Said {
    pub(super) fn of(file: &EventFile) -> Self {
        let (notes, warnings) = (file.notes.clone(), file.warnings.clone());
        Self { notes, warnings }
    }

    /// What was said of several events; what holds for more than one of them
    /// is said once.
    pub(super) fn of_all<'s>(all: impl IntoIterator<Item = &'s Self>) -> Self {
        let mut once = Self::default();
        for said in all {
            once.note(said.notes.iter().cloned());
            add(&mut once.warnings, said.warnings.iter().cloned());
        }
        once
    }

    /// Adds notes, each once.
    pub(super) fn note(&mut self, notes: impl IntoIterator<Item = String>) {
        add(&mut self.notes, notes);
    }

    /// Adds the keys `notes` and `warnings` to a document.
    pub(super) fn write_to(&self, document: &mut Value) {
        document["notes"] = json!(self.notes);
        document["warnings"] = json!(self.warnings);
    }

    /// The lines behind an answer; none where nothing was said.
    pub(super) fn lines(&self) -> String {
        let warnings = self.warnings.iter().map(|w| format!("Warning: {w}."));
        let all = self.notes.iter().cloned().chain(warnings);
        let lines: String = all.map(|said| wrapped(&said, width())).collect();
        if lines.is_empty() { lines } else { format!("\n{lines}") }
    }
}

fn add(all: &mut Vec<String>, more: impl IntoIterator<Item = String>) {
    for one in more {
        if !all.contains(&one) {
            all.push(one);
        }
    }
}
