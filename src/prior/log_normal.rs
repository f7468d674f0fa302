//! The log-normal distribution.

use rand_distr::{Distribution as _, StandardNormal};

use super::special::{ln_normal_below, normal_quantile};
use super::{
    Cumulative, Distribution, LN_SQRT_2PI, Prior, Support, impossible,
    positive, quantile_of,
};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// LogNormal(mean, sd) of the logarithm, for x > 0:
/// p(x) = exp(-(ln x - mean)^2 / (2 sd^2)) / (x sd sqrt(2 pi)).
///
/// ```
/// use couloir::prior::{Distribution, LogNormal, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = LogNormal::<Plain>::new(0.0, 1.0);
/// assert!((prior.log_density(Real::new(1.0)).value() + 0.9189385).abs() < 1e-7);
/// assert_eq!(prior.quantile(0.5), Some(1.0));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct LogNormal<K: Kind> {
    mean: Real<K>,
    sd: Real<K>,
}

impl<K: Kind> LogNormal<K> {
    /// From mean and standard deviation of ln x.
    #[inline]
    pub fn new(mean: impl Into<Real<K>>, sd: impl Into<Real<K>>) -> Self {
        Self { mean: mean.into(), sd: sd.into() }
    }

    /// Mean and standard deviation, if there is such a distribution.
    fn values(&self) -> Option<(f64, f64)> {
        let (mean, sd) = (self.mean.value(), self.sd.value());
        (mean.is_finite() && positive(sd)).then_some((mean, sd))
    }
}

impl<K: Kind> Distribution<K> for LogNormal<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !(positive(x.value()) && positive(self.sd.value())) {
            return impossible();
        }
        let log = x.ln();
        let deviate = (log - self.mean) / self.sd;
        if !deviate.value().is_finite() {
            return impossible();
        }
        -0.5 * deviate * deviate - self.sd.ln() - log - LN_SQRT_2PI
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let (mean, sd) = self.values()?;
        let z: f64 = StandardNormal.sample(rng);
        Some(self.support().nearest((mean + sd * z).exp()))
    }
}

impl<K: Kind> Prior<K> for LogNormal<K> {
    fn support(&self) -> Support<K> {
        Support::Above(Real::new(0.0))
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let (mean, sd) = self.values()?;
        quantile_of(&self.support(), p, |p| {
            (mean + sd * normal_quantile(p)).exp()
        })
    }
}

impl<K: Kind> Cumulative<K> for LogNormal<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        ln_normal_below((x.ln() - self.mean) / self.sd)
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        ln_normal_below((self.mean - x.ln()) / self.sd)
    }
}
