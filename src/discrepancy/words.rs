//! A diagnosis in words.

use super::diagnosis::Diagnosis;

/// The diagnosis for a terminal.
pub fn summary(diagnosis: &Diagnosis, width: usize) -> String {
    let _ = width;
    format!("{}\n", diagnosis.verdict.name())
}
