//! A model with mechanisms added to it from outside.

use super::amount::Amount;
use super::number::Number;
use super::program::Program;
use super::run::Run;
use crate::error::Outcome;
use crate::mechanism::{Change, Mechanism, Unknown};

/// A program under the changes of mechanisms; itself a program, so that every
/// backend runs it and several nest.
///
/// The mechanisms' parameters come first, each named
/// `mechanism.parameter`.
#[derive(Debug)]
pub struct With<'a, P> {
    program: &'a P,
    mechanisms: Vec<(&'a dyn Mechanism, Vec<Unknown>)>,
    names: Vec<String>,
    known: Option<f64>,
}

impl<'a, P: Program> With<'a, P> {
    /// Adds mechanisms to a program.
    pub fn new(program: &'a P, mechanisms: &[&'a dyn Mechanism]) -> Self {
        let mechanisms: Vec<_> =
            mechanisms.iter().map(|m| (*m, m.unknowns())).collect();
        let names = mechanisms
            .iter()
            .flat_map(|(m, unknowns)| {
                unknowns.iter().map(|u| format!("{}.{}", m.name(), u.name))
            })
            .collect();
        Self { program, mechanisms, names, known: None }
    }

    /// The same, knowing only the first values of each series: a share of
    /// them between 0 and 1, and one value at the least.
    #[must_use]
    pub fn knowing(self, share: f64) -> Self {
        Self { known: Some(share), ..self }
    }

    /// How many parameters the mechanisms add; they come first.
    pub fn added(&self) -> usize {
        self.names.len()
    }

    /// The mechanisms, in order.
    pub fn mechanisms(&self) -> impl Iterator<Item = &'a dyn Mechanism> {
        self.mechanisms.iter().map(|(mechanism, _)| *mechanism)
    }

    /// What is unknown about the mechanisms, in order.
    pub fn unknowns(&self) -> impl Iterator<Item = &Unknown> {
        self.mechanisms.iter().flat_map(|(_, unknowns)| unknowns)
    }
}

impl<P: Program> Program for With<'_, P> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mut names = self.names.iter();
        let mut sum: Option<Change<K>> = None;
        for (mechanism, unknowns) in &self.mechanisms {
            let amounts = unknowns.iter().zip(&mut names);
            let amounts = amounts.map(|(of, name)| Amount::of(name, of));
            let values = run.amounts(amounts)?;
            let own = K::change(*mechanism, &values);
            sum = Some(match sum {
                Some(sum) => sum.and(&own),
                None => own,
            });
        }
        let mut change = sum.unwrap_or_default();
        change.known = self.known.or(change.known);
        run.under(&change, |run| self.program.run(run))
    }
}
