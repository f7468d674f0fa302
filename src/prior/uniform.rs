//! The uniform distribution.

use rand_distr::{Distribution as _, Open01};

use super::{
    Cumulative, Distribution, Prior, Support, impossible, positive,
    quantile_of,
};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Uniform(low, high), for low < x < high: p(x) = 1 / (high - low).
///
/// ```
/// use couloir::prior::{Distribution, Prior, Uniform};
/// use couloir::scalar::{Plain, Real};
/// let prior = Uniform::<Plain>::new(1.0, 3.0);
/// assert_eq!(prior.log_density(Real::new(1.5)).value(), -(2.0_f64.ln()));
/// assert_eq!(prior.quantile(0.25), Some(1.5));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Uniform<K: Kind> {
    low: Real<K>,
    high: Real<K>,
}

impl<K: Kind> Uniform<K> {
    /// From its two ends.
    #[inline]
    pub fn new(low: impl Into<Real<K>>, high: impl Into<Real<K>>) -> Self {
        Self { low: low.into(), high: high.into() }
    }

    /// Low end and width, if there is such a distribution.
    fn values(&self) -> Option<(f64, f64)> {
        let (low, high) = (self.low.value(), self.high.value());
        positive(high - low).then_some((low, high - low))
    }
}

impl<K: Kind> Distribution<K> for Uniform<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        let width = self.high - self.low;
        if x > self.low && x < self.high && positive(width.value()) {
            -width.ln()
        } else {
            impossible()
        }
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let (low, width) = self.values()?;
        let u: f64 = Open01.sample(rng);
        let x = self.support().nearest(low + u * width);
        // There may be no number between the two ends.
        self.support().contains(x).then_some(x)
    }
}

impl<K: Kind> Prior<K> for Uniform<K> {
    fn support(&self) -> Support<K> {
        Support::Between(self.low, self.high)
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let (low, width) = self.values()?;
        quantile_of(&self.support(), p, |p| low + p * width)
    }
}

impl<K: Kind> Cumulative<K> for Uniform<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        ((x - self.low) / (self.high - self.low)).ln()
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        ((self.high - x) / (self.high - self.low)).ln()
    }
}
