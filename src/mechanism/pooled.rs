//! A mechanism with amplitudes about a common one.

use std::ops::Range;
use std::sync::Arc;

use super::of_events::{of_event, says_as};
use super::{
    Candidate, Change, ChangeKind, ChangeOf, Concern, Family, Mechanism, Noun,
    Reach, Unknown,
};
use crate::block::List;
use crate::physics::forces::Axis;
use crate::prior::AnyPrior;
use crate::scalar::Real;

/// The prior scale of how far the logarithm of an event's own amplitude lies
/// from that of the common one, where amplitudes have one sign.
const RATIO: f64 = 0.5;

/// A mechanism at the same places in all events, with amplitudes that differ
/// about a common one.
///
/// An amplitude that may have either sign is the common one plus spread times
/// a standard normal deviate; one of a single sign is the common one times
/// exp(spread times deviate), which keeps its sign.
#[derive(Debug)]
pub(crate) struct Pooled {
    inner: Arc<dyn Mechanism>,
    unknowns: Vec<Unknown>,
    /// How many of these all events have in common.
    common: usize,
    /// Which event the first deviate is of; the others follow.
    first: usize,
    signed: bool,
}

impl Pooled {
    /// Pools a mechanism over events with these labels. After its own
    /// unknowns come the spread and each event's deviate.
    pub(crate) fn new(inner: Box<dyn Mechanism>, labels: &[String]) -> Self {
        let mut unknowns = inner.unknowns();
        let (signed, scale, unit) = match unknowns.first() {
            Some(Unknown { prior: AnyPrior::Normal(_, sd), unit, .. }) => {
                (true, 0.5 * sd, *unit)
            }
            _ => (false, RATIO, "1"),
        };
        let spread = AnyPrior::HalfNormal(scale);
        unknowns.push(Unknown::other("spread", unit, spread));
        let common = unknowns.len();
        unknowns.extend(labels.iter().map(|label| {
            let prior = AnyPrior::Normal(0.0, 1.0);
            of_event(&Unknown::other("deviation", "1", prior), label)
        }));
        let inner = Arc::from(inner);
        Self { inner, unknowns, common, first: 0, signed }
    }

    fn inner(&self) -> &dyn Mechanism {
        self.inner.as_ref()
    }

    /// The amplitude of an event whose deviation is `deviate`.
    fn amplitude<K: ChangeKind>(
        &self,
        common: Real<K>,
        spread: Real<K>,
        deviate: Real<K>,
    ) -> Real<K> {
        match self.signed {
            true => common + spread * deviate,
            false => common * (spread * deviate).exp(),
        }
    }
}

impl Candidate for Pooled {
    says_as!(inner);

    fn amplitudes(&self) -> Vec<Range<usize>> {
        self.inner.amplitudes()
    }
}

impl<K: ChangeKind> ChangeOf<K> for Pooled {
    fn change_of(&self, values: &[Real<K>]) -> Change<K> {
        let (common, deviates) = values.split_at(self.common);
        let (mut amounts, spread): (List<Real<K>>, _) = match common {
            [amounts @ .., spread] => {
                (amounts.iter().copied().collect(), *spread)
            }
            [] => return Change::default(),
        };
        let mut own = vec![Change::default(); self.first];
        own.extend(deviates.iter().map(|&deviate| {
            amounts[0] = self.amplitude(common[0], spread, deviate);
            K::change(self.inner.as_ref(), &amounts)
        }));
        Change { own, ..Change::default() }
    }
}

impl Mechanism for Pooled {
    fn of_event(&self, event: usize) -> Concern {
        let of_common = self.unknowns[..self.common].iter();
        let own = &self.unknowns[self.common + event];
        let mechanism = Self {
            inner: Arc::clone(&self.inner),
            unknowns: of_common.chain([own]).cloned().collect(),
            common: self.common,
            first: event,
            signed: self.signed,
        };
        let mechanism = Some(Box::new(mechanism) as Box<dyn Mechanism>);
        Concern::Own { common: self.common, mechanism }
    }
}
