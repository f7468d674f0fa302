//! The normal distribution.

use rand_distr::{Distribution as _, StandardNormal};

use super::special::{LN_SQRT_2PI, ln_normal_below, normal_quantile};
use super::{
    Cumulative, Distribution, Prior, Support, impossible, positive,
    quantile_of,
};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Normal(mean, sd): p(x) = exp(-(x - mean)^2 / (2 sd^2)) / (sd sqrt(2 pi)).
///
/// ```
/// use couloir::prior::{Distribution, Normal, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = Normal::<Plain>::new(1.0, 2.0);
/// assert!((prior.log_density(Real::new(1.0)).value() + 1.6120857).abs() < 1e-7);
/// assert!((prior.quantile(0.975).unwrap() - 4.919928).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Normal<K: Kind> {
    mean: Real<K>,
    sd: Real<K>,
}

impl<K: Kind> Normal<K> {
    /// From its mean and standard deviation.
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

impl<K: Kind> Distribution<K> for Normal<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        let deviate = (x - self.mean) / self.sd;
        if !(positive(self.sd.value()) && deviate.value().is_finite()) {
            return impossible();
        }
        -0.5 * deviate * deviate - self.sd.ln() - LN_SQRT_2PI
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let (mean, sd) = self.values()?;
        let z: f64 = StandardNormal.sample(rng);
        Some(self.support().nearest(mean + sd * z))
    }
}

impl<K: Kind> Prior<K> for Normal<K> {
    fn support(&self) -> Support<K> {
        Support::Line
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let (mean, sd) = self.values()?;
        quantile_of(&self.support(), p, |p| mean + sd * normal_quantile(p))
    }
}

impl<K: Kind> Cumulative<K> for Normal<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        ln_normal_below((x - self.mean) / self.sd)
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        ln_normal_below((self.mean - x) / self.sd)
    }
}
