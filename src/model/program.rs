//! Programs: the bodies of models.

use super::number::Number;
use super::run::Run;
use crate::error::{Outcome, Result};

/// A model's body: declares parameters, scores data.
///
/// Written by the `model!` macro, or by hand as in the example
/// `without_the_macro`.
pub trait Program: Sync {
    /// Runs the body.
    ///
    /// # Errors
    /// [`Stop::Reject`](crate::error::Stop::Reject) gives the point density
    /// zero, [`Stop::Fail`](crate::error::Stop::Fail) ends the inference.
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome;

    /// How many events the body passes to [`Run::of_event`], where inference
    /// may take them apart: what they have in common is declared before the
    /// first of them, and all data are scored within them.
    fn events(&self) -> usize {
        1
    }

    /// The same model with another noise, by the name that event files give
    /// it; `None` where the noise is written into the body, as `model!` does.
    ///
    /// # Errors
    /// A name that no noise has.
    fn with_noise(&self, _name: &str) -> Result<Option<Self>>
    where
        Self: Sized,
    {
        Ok(None)
    }
}
