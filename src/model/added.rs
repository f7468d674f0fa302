//! Mechanisms put on a program: the one way in which their parameters are
//! called, asked for, and made into a change.

use std::ops::Deref;

use super::number::Number;
use super::run::Run;
use crate::error::Stop;
use crate::mechanism::{Change, Mechanism, Unknown};
use crate::scalar::Real;

/// Mechanisms with all that is unknown about them.
///
/// A program runs under the change that its mechanisms make, so their
/// parameters come before its own: mechanism by mechanism, each parameter
/// called `mechanism.parameter`.
#[derive(Debug, Clone)]
pub(super) struct Added<M> {
    /// Each with how many parameters it has.
    each: Vec<(M, usize)>,
    unknowns: Vec<Unknown>,
}

impl<M> Default for Added<M> {
    fn default() -> Self {
        Self { each: Vec::new(), unknowns: Vec::new() }
    }
}

impl<'a, M: Deref<Target = dyn Mechanism + 'a>> Added<M> {
    /// Puts one more mechanism after the others.
    pub(super) fn push(&mut self, mechanism: M) {
        let own = mechanism.unknowns();
        let count = own.len();
        self.unknowns.extend(own.into_iter().map(|unknown| {
            let name = format!("{}.{}", mechanism.name(), unknown.name);
            Unknown { name, ..unknown }
        }));
        self.each.push((mechanism, count));
    }

    /// The mechanisms.
    pub(super) fn each(&self) -> impl Iterator<Item = &M> {
        self.each.iter().map(|(mechanism, _)| mechanism)
    }

    /// What is unknown about them, under its full name.
    pub(super) fn unknowns(&self) -> &[Unknown] {
        &self.unknowns
    }

    /// The same, to be given other priors.
    pub(super) fn unknowns_mut(&mut self) -> &mut [Unknown] {
        &mut self.unknowns
    }

    /// Asks for the parameters.
    pub(super) fn ask<K: Number>(
        &self,
        run: &mut Run<'_, K>,
    ) -> Result<Change<K>, Stop> {
        let values = run.amounts(&self.unknowns)?;
        run.has(|say| self.each().for_each(|own| say(own.name())));
        Ok(self.change(&values))
    }

    /// The change that given values make.
    pub(super) fn change<K: Number>(&self, values: &[Real<K>]) -> Change<K> {
        let mut rest = values;
        let mut sum: Option<Change<K>> = None;
        for (mechanism, count) in &self.each {
            let (own, others) = rest.split_at(*count);
            let own = K::change(&**mechanism, own);
            sum = Some(match sum {
                Some(sum) => sum.and(&own),
                None => own,
            });
            rest = others;
        }
        sum.unwrap_or_default()
    }
}
