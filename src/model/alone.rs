//! One of several events of a program, and what all of them have in common.

use super::number::Number;
use super::program::Program;
use super::run::Run;
use crate::error::Outcome;
use crate::mechanism::Unknown;

/// A program for one of its events alone; itself a program.
#[derive(Debug)]
pub struct Alone<'a, P> {
    program: &'a P,
    event: usize,
}

impl<'a, P: Program> Alone<'a, P> {
    /// The program for its `event`-th event.
    pub fn new(program: &'a P, event: usize) -> Self {
        Self { program, event }
    }
}

impl<P: Program> Program for Alone<'_, P> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        self.program.run_event(self.event, run)
    }
}

/// The parameters that all events of a program have in common, those of
/// mechanisms first, under their priors; a program without data.
#[derive(Debug)]
pub struct Common<'a, P> {
    program: &'a P,
    added: Vec<Unknown>,
}

impl<'a, P: Program> Common<'a, P> {
    /// What a program's events have in common, with what mechanisms add to
    /// it, by name.
    pub fn new(program: &'a P, added: Vec<Unknown>) -> Self {
        Self { program, added }
    }
}

impl<P: Program> Program for Common<'_, P> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        run.amounts(&self.added)?;
        self.program.run_common(run)
    }
}
