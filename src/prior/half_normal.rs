//! The half-normal distribution.

use std::f64::consts::{LN_2, PI, SQRT_2};

use rand_distr::{Distribution as _, StandardNormal};
use statrs::function::erf::erf_inv;

use super::cumulative::ln_1m_exp;
use super::special::ln_normal_below;
use super::{
    Cumulative, Distribution, LN_SQRT_2PI, Prior, Support, impossible,
    positive, quantile_of,
};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// HalfNormal(scale), for x > 0:
/// p(x) = 2 exp(-x^2 / (2 scale^2)) / (scale sqrt(2 pi)).
///
/// ```
/// use couloir::prior::{Distribution, HalfNormal, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = HalfNormal::<Plain>::new(2.0);
/// assert!((prior.log_density(Real::new(2.0)).value() + 1.4189385).abs() < 1e-7);
/// assert!((prior.quantile(0.95).unwrap() - 3.919928).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct HalfNormal<K: Kind> {
    scale: Real<K>,
}

impl<K: Kind> HalfNormal<K> {
    /// From its scale, the standard deviation of the whole normal.
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

impl<K: Kind> Distribution<K> for HalfNormal<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !(positive(x.value()) && positive(self.scale.value())) {
            return impossible();
        }
        let deviate = x / self.scale;
        -0.5 * deviate * deviate - self.scale.ln() + (LN_2 - LN_SQRT_2PI)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let scale = self.value()?;
        let z: f64 = StandardNormal.sample(rng);
        Some(self.support().nearest(scale * z.abs()))
    }
}

impl<K: Kind> Prior<K> for HalfNormal<K> {
    fn support(&self) -> Support<K> {
        Support::Above(Real::new(0.0))
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let scale = self.value()?;
        quantile_of(&self.support(), p, |p| scale * (SQRT_2 * erf_inv(p)))
    }
}

impl<K: Kind> Cumulative<K> for HalfNormal<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        let q = x / self.scale;
        match q < 1.0 {
            true => ln_within(q),
            false => ln_1m_exp(self.log_above(x)),
        }
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        ln_normal_below(-x / self.scale) + LN_2
    }
}

/// ln of the probability that a standard normal is nearer to 0 than `q`, by
/// 2 phi(q) (q + q^3/3 + q^5/(3 5) + ..) (Abramowitz and Stegun 26.2.11), for
/// q below 1: of the twentieth term nothing is left there. One minus the rest
/// would have lost its digits near 0.
fn ln_within<K: Kind>(q: Real<K>) -> Real<K> {
    let square = q * q;
    let mut sum = Real::new(0.0);
    for n in (1..20).rev() {
        sum = (sum + 1.0) * square / (2.0 * f64::from(n) + 1.0);
    }
    q.ln() + 0.5 * (2.0 / PI).ln() - 0.5 * square + (sum + 1.0).ln()
}
