//! The Bernoulli distribution of what happens or does not.

use rand_distr::Distribution as _;

use super::binomial::times_ln;
use super::{Distribution, impossible};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Bernoulli(p): P(1) = p, P(0) = 1 - p. Data may be `bool`s.
///
/// ```
/// use couloir::prior::{Bernoulli, Distribution};
/// use couloir::scalar::{Plain, Real};
/// let released = Bernoulli::<Plain>::new(0.25);
/// assert_eq!(released.log_density(Real::new(1.0)).value(), 0.25_f64.ln());
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Bernoulli<K: Kind> {
    p: Real<K>,
}

impl<K: Kind> Bernoulli<K> {
    /// From the probability of 1.
    #[inline]
    pub fn new(p: impl Into<Real<K>>) -> Self {
        Self { p: p.into() }
    }
}

impl<K: Kind> Distribution<K> for Bernoulli<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        let n = x.value();
        if !((n == 0.0 || n == 1.0) && self.p >= 0.0 && self.p <= 1.0) {
            return impossible();
        }
        times_ln(n, self.p) + times_ln(1.0 - n, 1.0 - self.p)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let draw = rand_distr::Bernoulli::new(self.p.value()).ok()?;
        Some(f64::from(u8::from(draw.sample(rng))))
    }
}
