//! The gamma distribution.
//!
//! statrs's inverse_cdf stops too early where the quantile is small: for
//! shape 1/2 it misses p = 1e-6 by 3e-5, for scale 1e-8 and shape 9 p = 0.3
//! by 3e-5. So the quantile is solved for here, in ln x, on statrs's
//! regularised gamma functions. rand_distr's draws underflow to 0 for small
//! shapes; those are formed as logarithms here.

use rand_distr::{Distribution as _, Exp1};
use statrs::function::gamma::{checked_gamma_lr, checked_gamma_ur};

use super::incomplete::ln_gamma_parts;
use super::special::{ln_gamma, normal_quantile, root};
use super::{
    Cumulative, Distribution, Prior, Support, impossible, positive,
    quantile_of,
};
use crate::scalar::{Kind, Plain, Real};
use crate::seed::Rng;

/// Gamma(shape, scale), for x > 0:
/// p(x) = x^(shape - 1) exp(-x / scale) / (Γ(shape) scale^shape).
///
/// ```
/// use couloir::prior::{Distribution, Gamma, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = Gamma::<Plain>::new(2.0, 3.0);
/// // x exp(-x / 3) / 9
/// assert!((prior.log_density(Real::new(9.0)).value() + 3.0).abs() < 1e-14);
/// assert!((prior.quantile(0.5).unwrap() - 5.03504097).abs() < 1e-8);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Gamma<K: Kind> {
    shape: Real<K>,
    scale: Real<K>,
}

impl<K: Kind> Gamma<K> {
    /// From its shape and scale; the mean is their product.
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

impl<K: Kind> Distribution<K> for Gamma<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !positive(x.value()) || self.values().is_none() {
            return impossible();
        }
        let log = x.ln();
        self.shape * (log - self.scale.ln())
            - log
            - x / self.scale
            - ln_gamma(self.shape)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let (shape, scale) = self.values()?;
        let x = (scale.ln() + ln_draw(shape, rng)?).exp();
        Some(self.support().nearest(x))
    }
}

impl<K: Kind> Prior<K> for Gamma<K> {
    fn support(&self) -> Support<K> {
        Support::Above(Real::new(0.0))
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let (shape, scale) = self.values()?;
        quantile_of(&self.support(), p, |p| {
            (scale.ln() + ln_quantile(shape, p, 1.0 - p)).exp()
        })
    }
}

impl<K: Kind> Cumulative<K> for Gamma<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        self.log_parts(x).0
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        self.log_parts(x).1
    }

    fn log_parts(&self, x: Real<K>) -> (Real<K>, Real<K>) {
        match self.values() {
            Some(_) => ln_gamma_parts(self.shape, x / self.scale),
            None => (impossible(), impossible()),
        }
    }
}

/// ln of a draw from Gamma(shape, 1). Below shape 1 a draw is one of shape
/// + 1 times U^(1/shape), and -ln U is exponential.
pub(super) fn ln_draw(shape: f64, rng: &mut Rng) -> Option<f64> {
    let (shape, log_factor) = if shape < 1.0 {
        let e: f64 = Exp1.sample(rng);
        (shape + 1.0, -e / shape)
    } else {
        (shape, 0.0)
    };
    let gamma = rand_distr::Gamma::new(shape, 1.0).ok()?;
    Some(gamma.sample(rng).ln() + log_factor)
}

/// ln of the number below which Gamma(shape, 1) falls with probability `p`,
/// above which with probability `q`; the smaller of the two counts.
pub(super) fn ln_quantile(shape: f64, p: f64, q: f64) -> f64 {
    if shape > 1e7 {
        return ln_quantile_of_large(shape, p, q);
    }
    let log_gamma = ln_gamma(Real::<Plain>::new(shape)).value();
    // P(y) < y^shape / Γ(shape + 1), and equal for y -> 0.
    let log_p = if p < 0.5 { p.ln() } else { (-q).ln_1p() };
    let low = (log_p + log_gamma + shape.ln()) / shape;
    if low < -37.0 {
        return low;
    }
    // Beyond this less than 1e-308 is left.
    let high = (shape + 2.0 * (710.0 * shape).sqrt() + 1420.0).ln();
    let log_slope = |u: f64| shape * u - u.exp() - log_gamma;
    if p <= q {
        root((low, high), low, |u| {
            let below = checked_gamma_lr(shape, u.exp()).unwrap_or(0.0);
            (below.ln() - log_p, log_slope(u).exp() / below)
        })
    } else {
        root((low, high), high, |u| {
            let above = checked_gamma_ur(shape, u.exp()).unwrap_or(0.0);
            (q.ln() - above.ln(), log_slope(u).exp() / above)
        })
    }
}

/// The same for large shapes, where the cube root of a gamma number is normal
/// (Wilson and Hilferty 1931), in probability to about 0.1/shape.
fn ln_quantile_of_large(shape: f64, p: f64, q: f64) -> f64 {
    let z = if p < q { normal_quantile(p) } else { -normal_quantile(q) };
    let v = 1.0 / (9.0 * shape);
    shape.ln() + 3.0 * (z * v.sqrt() - v).ln_1p()
}
