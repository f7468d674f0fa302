//! The half-Cauchy distribution.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

use rand_distr::Distribution as _;

use super::special::ln_1p_squared;
use super::{
    Cumulative, Distribution, Prior, Support, impossible, positive,
    quantile_of,
};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// HalfCauchy(scale), for x > 0:
/// p(x) = 2 / (pi scale (1 + (x / scale)^2)).
///
/// ```
/// use couloir::prior::{Distribution, HalfCauchy, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = HalfCauchy::<Plain>::new(5.0);
/// assert!((prior.log_density(Real::new(5.0)).value() + 2.7541678).abs() < 1e-7);
/// assert!((prior.quantile(0.5).unwrap() - 5.0).abs() < 1e-14);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct HalfCauchy<K: Kind> {
    scale: Real<K>,
}

impl<K: Kind> HalfCauchy<K> {
    /// From its scale, which is also its median.
    #[inline]
    pub fn new(scale: impl Into<Real<K>>) -> Self {
        Self { scale: scale.into() }
    }

    /// The scale, if there is such a distribution.
    fn value(&self) -> Option<f64> {
        let scale = self.scale.value();
        positive(scale).then_some(scale)
    }
}

impl<K: Kind> Distribution<K> for HalfCauchy<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !(positive(x.value()) && positive(self.scale.value())) {
            return impossible();
        }
        FRAC_2_PI.ln() - self.scale.ln() - ln_1p_squared(x / self.scale)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let scale = self.value()?;
        let x = rand_distr::Cauchy::new(0.0, scale).ok()?.sample(rng);
        Some(self.support().nearest(x.abs()))
    }
}

impl<K: Kind> Prior<K> for HalfCauchy<K> {
    fn support(&self) -> Support<K> {
        Support::Above(Real::new(0.0))
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let scale = self.value()?;
        quantile_of(&self.support(), p, |p| {
            if p < 0.5 {
                scale * (FRAC_PI_2 * p).tan()
            } else {
                scale / (FRAC_PI_2 * (1.0 - p)).tan()
            }
        })
    }
}

impl<K: Kind> Cumulative<K> for HalfCauchy<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        ((x / self.scale).atan() * FRAC_2_PI).ln()
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        ((self.scale / x).atan() * FRAC_2_PI).ln()
    }
}
