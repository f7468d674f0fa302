//! The corrected model as Rust to paste.

use super::diagnose::Options;
use crate::change::Mechanism;

/// A program with the model and the mechanisms added to it.
pub(super) fn model_text(
    mechanisms: &[&dyn Mechanism],
    options: &Options,
) -> String {
    let _ = options;
    let mut text = String::new();
    for mechanism in mechanisms {
        text.push_str(&format!("// {}\n", mechanism.formula()));
    }
    text
}
