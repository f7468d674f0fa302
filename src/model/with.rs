//! A model with mechanisms added to it from outside.

use super::added::Added;
use super::any_program::AnyProgram;
use super::number::Number;
use super::program::Program;
use super::run::Run;
use crate::error::Outcome;
use crate::mechanism::Mechanism;

/// A program under the changes of mechanisms; itself a program, so that every
/// backend runs it and several nest.
///
/// The mechanisms' parameters come first, each named
/// `mechanism.parameter`.
#[derive(Debug)]
pub struct With<'a> {
    program: &'a dyn AnyProgram,
    added: Added<&'a dyn Mechanism>,
    known: Option<f64>,
}

impl<'a> With<'a> {
    /// Adds mechanisms to a program.
    pub fn new(
        program: &'a dyn AnyProgram,
        mechanisms: &[&'a dyn Mechanism],
    ) -> Self {
        let mut added = Added::default();
        mechanisms.iter().for_each(|mechanism| added.push(*mechanism));
        Self { program, added, known: None }
    }

    /// The same, knowing only the first values of each series: a share of
    /// them between 0 and 1, and one value at the least.
    #[must_use]
    pub fn knowing(self, share: f64) -> Self {
        Self { known: Some(share), ..self }
    }

    /// How many parameters the mechanisms add; they come first.
    pub fn added(&self) -> usize {
        self.added.unknowns().len()
    }
}

impl Program for With<'_> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mut change = self.added.ask(run)?;
        change.known = self.known.or(change.known);
        run.under(&change, |run| self.program.run(run))
    }

    fn events(&self) -> usize {
        self.program.events()
    }
}
