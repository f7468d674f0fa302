//! The exponential distribution.

use rand_distr::{Distribution as _, Exp1};

use super::cumulative::ln_1m_exp;
use super::{
    Cumulative, Distribution, Prior, Support, impossible, positive,
    quantile_of,
};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Exponential(mean), for x > 0: p(x) = exp(-x / mean) / mean.
///
/// ```
/// use couloir::prior::{Distribution, Exponential, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = Exponential::<Plain>::new(1.0);
/// assert_eq!(prior.log_density(Real::new(3.0)).value(), -3.0);
/// assert_eq!(prior.quantile(0.5), Some(2.0_f64.ln()));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Exponential<K: Kind> {
    mean: Real<K>,
}

impl<K: Kind> Exponential<K> {
    /// From its mean, the inverse of its rate.
    #[inline]
    pub fn new(mean: impl Into<Real<K>>) -> Self {
        Self { mean: mean.into() }
    }

    /// The mean, if there is such a distribution.
    fn value(&self) -> Option<f64> {
        let mean = self.mean.value();
        positive(mean).then_some(mean)
    }
}

impl<K: Kind> Distribution<K> for Exponential<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !(positive(x.value()) && positive(self.mean.value())) {
            return impossible();
        }
        -(x / self.mean) - self.mean.ln()
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let mean = self.value()?;
        let e: f64 = Exp1.sample(rng);
        Some(self.support().nearest(mean * e))
    }
}

impl<K: Kind> Prior<K> for Exponential<K> {
    fn support(&self) -> Support<K> {
        Support::Above(Real::new(0.0))
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let mean = self.value()?;
        quantile_of(&self.support(), p, |p| -mean * (-p).ln_1p())
    }
}

impl<K: Kind> Cumulative<K> for Exponential<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        ln_1m_exp(-(x / self.mean))
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        -(x / self.mean)
    }
}
