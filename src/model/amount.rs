//! The unknowns of mechanisms, as a run asks for them.

use super::number::Number;
use super::run::{Label, Run};
use crate::block::List;
use crate::change::Unknown;
use crate::error::Stop;
use crate::prior::{AnyPrior, Uniform};
use crate::scalar::Real;

/// A parameter of a mechanism; `until` as of its [`Unknown`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Amount<'a> {
    pub(super) label: Label<'a>,
    pub(super) prior: AnyPrior,
    pub(super) until: Option<f64>,
}

impl<'a> Amount<'a> {
    pub(super) fn of(name: &'a str, unknown: &Unknown) -> Self {
        let Unknown { unit, prior, until, .. } = *unknown;
        Self { label: Label::new(name, unit), prior, until }
    }
}

impl<K: Number> Run<'_, K> {
    /// The parameters of mechanisms, in order.
    pub(super) fn amounts<'a>(
        &mut self,
        all: impl IntoIterator<Item = Amount<'a>>,
    ) -> Result<List<Real<K>>, Stop> {
        let mut values = List::new();
        for amount in all {
            let value = self.amount(amount, values.last())?;
            values.push(value);
        }
        Ok(values)
    }

    /// `before` is the amount before it, where a stretch begins.
    fn amount(
        &mut self,
        amount: Amount<'_>,
        before: Option<&Real<K>>,
    ) -> Result<Real<K>, Stop> {
        let Amount { label, prior, until } = amount;
        match (prior, until, before) {
            (AnyPrior::Uniform(shortest, _), Some(end), Some(&from)) => {
                // At the very end the shortest one has to have room.
                let left = Real::new(end) - from;
                let least = Real::new(2.0 * shortest);
                let longest = if left > least { left } else { least };
                self.scalar(label, Uniform::new(shortest, longest))
            }
            _ => self.scalar(label, prior),
        }
    }
}
