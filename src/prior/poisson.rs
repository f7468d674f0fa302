//! The Poisson distribution of counts.

use rand_distr::Distribution as _;

use super::special::ln_gamma;
use super::{Distribution, impossible, positive, whole};
use crate::scalar::{Kind, Plain, Real};
use crate::seed::Rng;

/// Poisson(mean), for n = 0, 1, 2, ...: P(n) = mean^n exp(-mean) / n!.
///
/// ```
/// use couloir::prior::{Distribution, Poisson};
/// use couloir::scalar::{Plain, Real};
/// let counts = Poisson::<Plain>::new(2.0);
/// let three = counts.log_density(Real::new(3.0)).value();
/// assert!((three - (8.0_f64 / 6.0).ln() + 2.0).abs() < 1e-14);
/// assert_eq!(counts.log_density(Real::new(0.5)).value(), f64::NEG_INFINITY);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Poisson<K: Kind> {
    mean: Real<K>,
}

impl<K: Kind> Poisson<K> {
    /// From its mean.
    #[inline]
    pub fn new(mean: impl Into<Real<K>>) -> Self {
        Self { mean: mean.into() }
    }
}

impl<K: Kind> Distribution<K> for Poisson<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        let n = x.value();
        if !(whole(n) && positive(self.mean.value())) {
            return impossible();
        }
        n * self.mean.ln() - self.mean - ln_factorial(n)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let mean = self.mean.value();
        positive(mean).then_some(())?;
        Some(rand_distr::Poisson::new(mean).ok()?.sample(rng))
    }
}

/// ln n!.
pub(super) fn ln_factorial(n: f64) -> f64 {
    ln_gamma(Real::<Plain>::new(n + 1.0)).value()
}
