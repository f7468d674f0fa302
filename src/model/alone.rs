//! One of several events of a program, and what all of them have in common.

use super::listener::Collector;
use super::number::Number;
use super::program::{Model, Point, Program};
use super::run::{Entered, Run};
use crate::error::{Outcome, Result};
use crate::mechanism::Unknown;

/// A program for one of its events alone; itself a program.
#[derive(Debug)]
pub(crate) struct Alone<'a, P> {
    program: &'a P,
    event: usize,
}

impl<'a, P: Program> Alone<'a, P> {
    /// The program for its `event`-th event.
    pub(crate) fn new(program: &'a P, event: usize) -> Self {
        Self { program, event }
    }
}

impl<P: Program> Program for Alone<'_, P> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        run.entering(Entered::Only(self.event), |run| self.program.run(run))
    }
}

/// The parameters that all events of a program have in common, those of
/// mechanisms first, under their priors; a program without data.
#[derive(Debug)]
pub(crate) struct Common<'a, P> {
    program: &'a P,
    added: Vec<Unknown>,
}

impl<'a, P: Program> Common<'a, P> {
    /// What a program's events have in common, with what mechanisms add to
    /// it, by name.
    pub(crate) fn new(program: &'a P, added: Vec<Unknown>) -> Self {
        Self { program, added }
    }

    /// How many parameters they are.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn dimension(&self) -> Result<usize> {
        let mut collector = Collector::default();
        self.evaluate(Point::Middle, Some(&mut collector))?;
        Ok(collector.collected.names.len())
    }
}

impl<P: Program> Program for Common<'_, P> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        run.amounts(&self.added)?;
        run.entering(Entered::Nothing, |run| self.program.run(run))
    }
}
