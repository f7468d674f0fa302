//! Programs of any type behind one.
//!
//! What works on every program is compiled once, with the library; of a
//! program itself nothing is compiled but its body, for each kind of number.

use std::fmt;

use super::face::Model;
use super::run::Run;
use crate::error::{Outcome, Result};
use crate::scalar::{Grad, Kind, Plain, Reverse};

/// [`Program::run`](super::Program::run) for one kind of number.
pub trait RunOf<K: Kind> {
    /// Runs the body.
    ///
    /// # Errors
    /// As [`Program::run`](super::Program::run).
    fn run_of(&self, run: &mut Run<'_, K>) -> Outcome;
}

/// A program for every kind of number that models run with; every
/// [`Program`](super::Program) is one, and it is one again.
pub trait AnyProgram:
    Model
    + RunOf<Plain>
    + RunOf<Grad<4>>
    + RunOf<Grad<8>>
    + RunOf<Grad<16>>
    + RunOf<Reverse>
{
    /// [`Program::events`](super::Program::events).
    fn count_of_events(&self) -> usize;

    /// [`Program::with_noise`](super::Program::with_noise).
    ///
    /// # Errors
    /// A name that no noise has.
    fn under_noise<'s>(
        &'s self,
        name: &str,
    ) -> Result<Option<Box<dyn AnyProgram + 's>>>;
}

impl fmt::Debug for dyn AnyProgram + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyProgram").finish_non_exhaustive()
    }
}
