//! The binomial distribution of successes in a number of trials.

use rand_distr::Distribution as _;

use super::poisson::ln_factorial;
use super::{Distribution, impossible, whole};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Binomial(trials, p), for n = 0, 1, ..., trials:
/// P(n) = trials! / (n! (trials - n)!) p^n (1 - p)^(trials - n).
///
/// ```
/// use couloir::prior::{Binomial, Distribution};
/// use couloir::scalar::{Plain, Real};
/// let heads = Binomial::<Plain>::new(3.0, 0.25);
/// let one = heads.log_density(Real::new(1.0)).value();
/// assert!((one - (27.0_f64 / 64.0).ln()).abs() < 1e-14);
/// assert_eq!(heads.log_density(Real::new(4.0)).value(), f64::NEG_INFINITY);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Binomial<K: Kind> {
    trials: f64,
    p: Real<K>,
}

impl<K: Kind> Binomial<K> {
    /// From the number of trials, which is known, and the probability of a
    /// success in each.
    #[inline]
    pub fn new(trials: f64, p: impl Into<Real<K>>) -> Self {
        Self { trials, p: p.into() }
    }

    /// Whether there is such a distribution.
    fn exists(&self) -> bool {
        whole(self.trials) && self.p >= 0.0 && self.p <= 1.0
    }
}

impl<K: Kind> Distribution<K> for Binomial<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        let (n, rest) = (x.value(), self.trials - x.value());
        if !(whole(n) && whole(rest) && self.exists()) {
            return impossible();
        }
        let ways =
            ln_factorial(self.trials) - ln_factorial(n) - ln_factorial(rest);
        times_ln(n, self.p) + times_ln(rest, 1.0 - self.p) + ways
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        self.exists().then_some(())?;
        let p = self.p.value();
        let binomial = rand_distr::Binomial::new(self.trials as u64, p);
        Some(binomial.ok()?.sample(rng) as f64)
    }
}

/// n ln p, which is 0 for n = 0 whatever p is.
#[inline]
pub(super) fn times_ln<K: Kind>(n: f64, p: Real<K>) -> Real<K> {
    if n == 0.0 { Real::new(0.0) } else { n * p.ln() }
}
