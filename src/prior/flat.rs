//! The flat, improper distribution.

use std::marker::PhantomData;

use super::{Distribution, Prior, Support, impossible};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Flat(): p(x) = 1 on the whole line, which has no integral; so there are
/// no quantiles and no draws.
///
/// ```
/// use couloir::prior::{Distribution, Flat, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = Flat::<Plain>::new();
/// assert_eq!(prior.log_density(Real::new(7.0)).value(), 0.0);
/// assert_eq!(prior.quantile(0.5), None);
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct Flat<K: Kind> {
    kind: PhantomData<K>,
}

impl<K: Kind> Flat<K> {
    /// The one there is.
    #[inline]
    pub fn new() -> Self {
        Self { kind: PhantomData }
    }
}

impl<K: Kind> Distribution<K> for Flat<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if x.value().is_finite() { Real::new(0.0) } else { impossible() }
    }

    fn draw(&self, _: &mut Rng) -> Option<f64> {
        None
    }
}

impl<K: Kind> Prior<K> for Flat<K> {
    fn support(&self) -> Support<K> {
        Support::Line
    }

    fn is_proper(&self) -> bool {
        false
    }

    fn quantile(&self, _: f64) -> Option<f64> {
        None
    }
}
