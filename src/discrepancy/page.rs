//! A diagnosis as a page.

use super::diagnosis::Diagnosis;

/// The page.
pub fn page(diagnosis: &Diagnosis) -> String {
    diagnosis.event.clone()
}
