//! The inverse gamma distribution.
//!
//! statrs's inverse_cdf does not reach the heavy upper tail for small shapes
//! and its logarithm of the density is that of an underflowing density; here
//! the quantile is the scale over a quantile of the gamma distribution. A
//! draw is the scale over a gamma draw, both as logarithms.

use super::gamma::{ln_draw, ln_quantile};
use super::incomplete::ln_gamma_parts;
use super::special::ln_gamma;
use super::{
    Cumulative, Distribution, Prior, Support, impossible, positive,
    quantile_of,
};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// InverseGamma(shape, scale), for x > 0:
/// p(x) = scale^shape x^(-shape - 1) exp(-scale / x) / Γ(shape).
///
/// ```
/// use couloir::prior::{Distribution, InverseGamma, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = InverseGamma::<Plain>::new(2.0, 1.0);
/// // exp(-1 / x) / x^3
/// assert_eq!(prior.log_density(Real::new(1.0)).value(), -1.0);
/// assert!((prior.quantile(0.5).unwrap() - 1.0 / 1.67834699).abs() < 1e-8);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct InverseGamma<K: Kind> {
    shape: Real<K>,
    scale: Real<K>,
}

impl<K: Kind> InverseGamma<K> {
    /// From its shape and scale; the mean is scale / (shape - 1).
    #[inline]
    pub fn new(shape: impl Into<Real<K>>, scale: impl Into<Real<K>>) -> Self {
        Self { shape: shape.into(), scale: scale.into() }
    }

    /// Shape and scale, if there is such a distribution.
    fn values(&self) -> Option<(f64, f64)> {
        let (shape, scale) = (self.shape.value(), self.scale.value());
        (positive(shape) && positive(scale)).then_some((shape, scale))
    }
}

impl<K: Kind> Distribution<K> for InverseGamma<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !positive(x.value()) || self.values().is_none() {
            return impossible();
        }
        let log = x.ln();
        self.shape * (self.scale.ln() - log)
            - log
            - self.scale / x
            - ln_gamma(self.shape)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let (shape, scale) = self.values()?;
        let x = (scale.ln() - ln_draw(shape, rng)?).exp();
        Some(self.support().nearest(x))
    }
}

impl<K: Kind> Prior<K> for InverseGamma<K> {
    fn support(&self) -> Support<K> {
        Support::Above(Real::new(0.0))
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let (shape, scale) = self.values()?;
        quantile_of(&self.support(), p, |p| {
            (scale.ln() - ln_quantile(shape, 1.0 - p, p)).exp()
        })
    }
}

/// x is below where the gamma number that it is the inverse of is above.
impl<K: Kind> Cumulative<K> for InverseGamma<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        self.log_parts(x).0
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        self.log_parts(x).1
    }

    fn log_parts(&self, x: Real<K>) -> (Real<K>, Real<K>) {
        match self.values() {
            Some(_) => {
                let gamma = ln_gamma_parts(self.shape, self.scale / x);
                (gamma.1, gamma.0)
            }
            None => (impossible(), impossible()),
        }
    }
}
