//! The Cauchy distribution.
//!
//! statrs's inverse_cdf loses p in its shift to p - 1/2 (below 1e-16 all of
//! it); here each tail is the cotangent of its own probability.

use std::f64::consts::PI;

use rand_distr::Distribution as _;

use super::special::ln_1p_squared;
use super::{
    Cumulative, Distribution, Prior, Support, impossible, positive,
    quantile_of,
};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Cauchy(location, scale):
/// p(x) = 1 / (pi scale (1 + ((x - location) / scale)^2)).
///
/// ```
/// use couloir::prior::{Cauchy, Distribution, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = Cauchy::<Plain>::new(1.0, 5.0);
/// assert!((prior.log_density(Real::new(6.0)).value() + 3.4473150).abs() < 1e-7);
/// assert!((prior.quantile(0.75).unwrap() - 6.0).abs() < 1e-14);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Cauchy<K: Kind> {
    location: Real<K>,
    scale: Real<K>,
}

impl<K: Kind> Cauchy<K> {
    /// From its median and half the distance of its quartiles.
    #[inline]
    pub fn new(
        location: impl Into<Real<K>>,
        scale: impl Into<Real<K>>,
    ) -> Self {
        Self { location: location.into(), scale: scale.into() }
    }

    /// Location and scale, if there is such a distribution.
    fn values(&self) -> Option<(f64, f64)> {
        let (location, scale) = (self.location.value(), self.scale.value());
        (location.is_finite() && positive(scale)).then_some((location, scale))
    }
}

impl<K: Kind> Distribution<K> for Cauchy<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        let deviate = (x - self.location) / self.scale;
        if !(positive(self.scale.value()) && deviate.value().is_finite()) {
            return impossible();
        }
        -PI.ln() - self.scale.ln() - ln_1p_squared(deviate)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let (location, scale) = self.values()?;
        let x = rand_distr::Cauchy::new(location, scale).ok()?.sample(rng);
        Some(self.support().nearest(x))
    }
}

impl<K: Kind> Prior<K> for Cauchy<K> {
    fn support(&self) -> Support<K> {
        Support::Line
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let (location, scale) = self.values()?;
        quantile_of(&self.support(), p, |p| {
            if p < 0.25 {
                location - scale / (PI * p).tan()
            } else if p < 0.75 {
                location + scale * (PI * (p - 0.5)).tan()
            } else {
                location + scale / (PI * (1.0 - p)).tan()
            }
        })
    }
}

impl<K: Kind> Cumulative<K> for Cauchy<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        ln_tail((self.location - x) / self.scale)
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        ln_tail((x - self.location) / self.scale)
    }
}

/// ln of the probability of more than `q` scales above the location.
fn ln_tail<K: Kind>(q: Real<K>) -> Real<K> {
    match q > 1.0 {
        true => ((1.0 / q).atan() / PI).ln(),
        false => (0.5 - q.atan() / PI).ln(),
    }
}
