//! The normal density of mean 0, with its constants worked out once.

use super::Conditional;
use crate::prior::LN_SQRT_2PI;
use crate::scalar::{Kind, Real};

/// ln p(r) = -r^2 / (2 v) - ln(v) / 2 - ln sqrt(2 pi) for a variance v in
/// the squared unit of r.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gaussian<K: Kind> {
    constant: Real<K>,
    half_precision: Real<K>,
    inverse_sd: Real<K>,
    log_sd: Real<K>,
}

impl<K: Kind> Gaussian<K> {
    #[inline(always)]
    pub(crate) fn new(variance: Real<K>) -> Self {
        let log_sd = 0.5 * variance.ln();
        Self {
            constant: -log_sd - LN_SQRT_2PI,
            half_precision: 0.5 / variance,
            inverse_sd: 1.0 / variance.sqrt(),
            log_sd,
        }
    }

    #[inline(always)]
    fn log_density(&self, r: Real<K>) -> Real<K> {
        self.constant - r * r * self.half_precision
    }

    /// One value.
    #[inline(always)]
    pub(crate) fn at(&self, r: Real<K>) -> Conditional<K> {
        Conditional::new(self.log_density(r), r * self.inverse_sd)
    }

    /// Its log density, and what it tells of its place and its size.
    #[inline(always)]
    pub(crate) fn inform(
        &self,
        r: Real<K>,
        hear: &mut dyn FnMut(&Real<K>),
    ) -> Real<K> {
        hear(&(r * self.inverse_sd));
        hear(&self.log_sd);
        self.log_density(r)
    }

    /// One value over its size.
    #[inline(always)]
    pub(crate) fn sized(
        &self,
        r: Real<K>,
        log_size: Option<Real<K>>,
    ) -> Conditional<K> {
        let mut value = self.at(r);
        if let Some(log_size) = log_size {
            value.log_density -= log_size;
        }
        value
    }

    /// The log density of `count` independent values with that sum of
    /// squares.
    #[inline]
    pub(crate) fn of_squares(
        &self,
        count: usize,
        squares: Real<K>,
    ) -> Real<K> {
        self.constant * count as f64 - squares * self.half_precision
    }
}
