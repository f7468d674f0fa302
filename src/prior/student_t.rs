//! Student's t distribution.
//!
//! statrs's inverse_cdf misses p by 0.07 for a tenth of a degree of freedom,
//! by 4e-5 for half a degree, and does not return for 1e9 degrees; here the
//! quantile comes from that of the beta distribution in logit(x) and, for
//! many degrees, from the normal one. rand_distr's draws overflow for few
//! degrees, as the chi-squared number below the root underflows; here that
//! number is a logarithm.

use rand_distr::{Distribution as _, StandardNormal};

use super::cumulative::ln_1m_exp;
use super::incomplete::ln_beta_parts;
use super::special::{ln_1p_squared, ln_gamma, normal_quantile};
use super::{
    Cumulative, Distribution, LN_SQRT_2PI, Prior, Support, beta, gamma,
    impossible, positive, quantile_of,
};
use crate::scalar::{Kind, Real, polynomial};
use crate::seed::Rng;

/// StudentT(freedom, location, scale): with d = (x - location) / scale,
/// p(x) = Γ((freedom + 1)/2) / (Γ(freedom/2) sqrt(pi freedom) scale)
/// (1 + d^2 / freedom)^(-(freedom + 1)/2).
///
/// ```
/// use couloir::prior::{Distribution, Prior, StudentT};
/// use couloir::scalar::{Plain, Real};
/// let prior = StudentT::<Plain>::new(3.0, 0.0, 1.0);
/// assert!((prior.log_density(Real::new(0.0)).value() + 1.0008889).abs() < 1e-7);
/// assert!((prior.quantile(0.975).unwrap() - 3.1824463).abs() < 1e-7);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct StudentT<K: Kind> {
    freedom: Real<K>,
    location: Real<K>,
    scale: Real<K>,
}

impl<K: Kind> StudentT<K> {
    /// From its degrees of freedom, its median and its scale.
    #[inline]
    pub fn new(
        freedom: impl Into<Real<K>>,
        location: impl Into<Real<K>>,
        scale: impl Into<Real<K>>,
    ) -> Self {
        Self {
            freedom: freedom.into(),
            location: location.into(),
            scale: scale.into(),
        }
    }

    /// Degrees of freedom, location and scale, if there is such a
    /// distribution.
    fn values(&self) -> Option<(f64, f64, f64)> {
        let freedom = self.freedom.value();
        let (location, scale) = (self.location.value(), self.scale.value());
        (positive(freedom) && location.is_finite() && positive(scale))
            .then_some((freedom, location, scale))
    }
}

impl<K: Kind> Distribution<K> for StudentT<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !x.value().is_finite() || self.values().is_none() {
            return impossible();
        }
        let deviate = (x - self.location) / self.scale;
        let ratio = deviate / self.freedom.sqrt();
        ln_factor(self.freedom)
            - self.scale.ln()
            - 0.5 * (self.freedom + 1.0) * ln_1p_squared(ratio)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let (freedom, location, scale) = self.values()?;
        let z: f64 = StandardNormal.sample(rng);
        let half_ln_chi2_over_freedom =
            0.5 * (gamma::ln_draw(0.5 * freedom, rng)? - (0.5 * freedom).ln());
        // In one exponential, so that no factor over- or underflows alone.
        let size = (z.abs().ln() - half_ln_chi2_over_freedom).exp();
        let x = location + scale * size.min(f64::MAX).copysign(z);
        Some(self.support().nearest(x))
    }
}

impl<K: Kind> Prior<K> for StudentT<K> {
    fn support(&self) -> Support<K> {
        Support::Line
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let (freedom, location, scale) = self.values()?;
        quantile_of(&self.support(), p, |p| {
            location + scale * standard_quantile(freedom, p)
        })
    }
}

impl<K: Kind> Cumulative<K> for StudentT<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        self.log_tail((self.location - x) / self.scale)
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        self.log_tail((x - self.location) / self.scale)
    }
}

impl<K: Kind> StudentT<K> {
    /// ln of the probability of a draw of location 0 and scale 1 above t.
    fn log_tail(&self, t: Real<K>) -> Real<K> {
        let n = self.freedom;
        if self.values().is_none() {
            return impossible();
        }
        let square = t * t;
        if square == 0.0 {
            // The formula below has no derivative here.
            return (0.5 - t * ln_factor(n).exp()).ln();
        }
        // n/(n + t^2) is Beta(n/2, 1/2), for t of either sign.
        let shapes = [0.5 * n, Real::new(0.5)];
        let parts = [n / (n + square), square / (n + square)];
        let ln_beta = beta::ln_beta(shapes[0], shapes[1]);
        let (beyond, _) = ln_beta_parts(shapes, parts, ln_beta);
        let tail = beyond - std::f64::consts::LN_2;
        if t > 0.0 { tail } else { ln_1m_exp(tail) }
    }
}

/// ln (Γ((n + 1)/2) / (Γ(n/2) sqrt(pi n))) for n degrees of freedom.
#[inline]
fn ln_factor<K: Kind>(n: Real<K>) -> Real<K> {
    if n < 50.0 {
        return ln_gamma(0.5 * (n + 1.0))
            - ln_gamma(0.5 * n)
            - 0.5 * (std::f64::consts::PI * n).ln();
    }
    // The difference of the two ln Γ cancels for large n; its asymptotic
    // series in 2/n does not, and is good to 1e-15 here.
    let r = 2.0 / n;
    const SERIES: [f64; 4] =
        [-1.0 / 8.0, 1.0 / 192.0, -1.0 / 640.0, 17.0 / 14336.0];
    r * (r * r).polynomial(&SERIES) - LN_SQRT_2PI
}

/// The quantile of location 0 and scale 1.
fn standard_quantile(freedom: f64, p: f64) -> f64 {
    if p == 0.5 {
        return 0.0;
    }
    if freedom > 1e4 {
        return quantile_of_many(freedom, normal_quantile(p));
    }
    let tail = 2.0 * p.min(1.0 - p);
    // freedom / (freedom + t^2) is Beta(freedom/2, 1/2).
    let z = beta::logit_quantile(0.5 * freedom, 0.5, tail, 1.0 - tail);
    (0.5 * (freedom.ln() - z)).exp().copysign(p - 0.5)
}

/// The quantile for many degrees of freedom from the normal one, z: the
/// first terms of Cornish and Fisher's expansion (Abramowitz and Stegun
/// 26.7.5).
fn quantile_of_many(freedom: f64, z: f64) -> f64 {
    let s = z * z;
    let g1 = polynomial(s, &[1.0, 1.0]) / 4.0;
    let g2 = polynomial(s, &[3.0, 16.0, 5.0]) / 96.0;
    let g3 = polynomial(s, &[-15.0, 17.0, 19.0, 3.0]) / 384.0;
    z * polynomial(1.0 / freedom, &[1.0, g1, g2, g3])
}
