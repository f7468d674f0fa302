//! The beta distribution.
//!
//! statrs's inverse_cdf misses p by up to 0.7 for arguments below 1 (a = 0.01,
//! b = 3), and its regularised beta function stops short of convergence for
//! arguments of 1e5 and more. So the quantile is solved for here, in
//! logit(x), on a continued fraction that is carried to its end; in
//! probability it is good to 1e-8 where both arguments are 1e6. rand_distr's
//! draws are right, but for an occasional 0 or 1, which is moved inside.

use rand_distr::Distribution as _;

use super::incomplete::{beta_fraction, ln_beta_parts};
use super::special::{ln_gamma, root};
use super::{
    Cumulative, Distribution, Prior, Support, impossible, positive,
    quantile_of,
};
use crate::scalar::{Kind, Plain, Real};
use crate::seed::Rng;

/// Beta(a, b), for 0 < x < 1:
/// p(x) = x^(a - 1) (1 - x)^(b - 1) Γ(a + b) / (Γ(a) Γ(b)).
///
/// ```
/// use couloir::prior::{Beta, Distribution, Prior};
/// use couloir::scalar::{Plain, Real};
/// let prior = Beta::<Plain>::new(2.0, 1.0);
/// // 2 x
/// assert!(prior.log_density(Real::new(0.5)).value().abs() < 1e-14);
/// assert!((prior.quantile(0.25).unwrap() - 0.5).abs() < 1e-14);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Beta<K: Kind> {
    a: Real<K>,
    b: Real<K>,
}

impl<K: Kind> Beta<K> {
    /// From its two shapes; the mean is a / (a + b).
    #[inline]
    pub fn new(a: impl Into<Real<K>>, b: impl Into<Real<K>>) -> Self {
        Self { a: a.into(), b: b.into() }
    }

    /// Both shapes, if there is such a distribution.
    fn values(&self) -> Option<(f64, f64)> {
        let (a, b) = (self.a.value(), self.b.value());
        (positive(a) && positive(b)).then_some((a, b))
    }
}

impl<K: Kind> Distribution<K> for Beta<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !(x > 0.0 && x < 1.0) || self.values().is_none() {
            return impossible();
        }
        (self.a - 1.0) * x.ln() + (self.b - 1.0) * (-x).ln_1p()
            - ln_beta(self.a, self.b)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let (a, b) = self.values()?;
        let x = rand_distr::Beta::new(a, b).ok()?.sample(rng);
        Some(self.support().nearest(x))
    }
}

impl<K: Kind> Prior<K> for Beta<K> {
    fn support(&self) -> Support<K> {
        Support::Between(Real::new(0.0), Real::new(1.0))
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        let (a, b) = self.values()?;
        quantile_of(&self.support(), p, |p| {
            1.0 / (1.0 + (-logit_quantile(a, b, p, 1.0 - p)).exp())
        })
    }
}

impl<K: Kind> Cumulative<K> for Beta<K> {
    fn log_below(&self, x: Real<K>) -> Real<K> {
        self.log_parts(x).0
    }

    fn log_above(&self, x: Real<K>) -> Real<K> {
        self.log_parts(x).1
    }

    fn log_parts(&self, x: Real<K>) -> (Real<K>, Real<K>) {
        if self.values().is_none() {
            return (impossible(), impossible());
        }
        let (a, b) = (self.a, self.b);
        ln_beta_parts([a, b], [x, 1.0 - x], ln_beta(a, b))
    }
}

/// ln B(a, b) = ln (Γ(a) Γ(b) / Γ(a + b)).
pub(super) fn ln_beta<K: Kind>(a: Real<K>, b: Real<K>) -> Real<K> {
    ln_gamma(a) + ln_gamma(b) - ln_gamma(a + b)
}

/// logit of the number below which Beta(a, b) falls with probability `p`,
/// above which with probability `q`; the smaller of the two counts.
pub(super) fn logit_quantile(a: f64, b: f64, p: f64, q: f64) -> f64 {
    if p > q {
        return -logit_quantile(b, a, q, p);
    }
    let ln_beta = ln_beta::<Plain>(Real::new(a), Real::new(b)).value();
    // The density of z = logit(x) lies below exp(a z) / B and exp(-b z) / B.
    let low = (p.ln() + a.ln() + ln_beta) / a;
    let high = -((-p).ln_1p() + b.ln() + ln_beta) / b;
    root((low, high), low, |z| {
        let (ln_density, ln_below) = ln_logit_beta(a, b, ln_beta, z);
        (ln_below - p.ln(), (ln_density - ln_below).exp())
    })
}

/// ln of the density of z = logit(x) and of the probability below.
fn ln_logit_beta(a: f64, b: f64, ln_beta: f64, z: f64) -> (f64, f64) {
    let e = (-z.abs()).exp();
    // ln of the smaller and the larger of x and 1 - x.
    let (less, more) = (-z.abs() - e.ln_1p(), -e.ln_1p());
    let (ln_x, ln_y) = if z < 0.0 { (less, more) } else { (more, less) };
    let ln_density = a * ln_x + b * ln_y - ln_beta;
    let (x, y) = (ln_x.exp(), ln_y.exp());
    let ln_below = if x < (a + 1.0) / (a + b + 2.0) {
        ln_density - (a * fraction(a, b, x)).ln()
    } else {
        let above = ln_density - (b * fraction(b, a, y)).ln();
        (-above.exp()).ln_1p()
    };
    (ln_density, ln_below)
}

fn fraction(a: f64, b: f64, x: f64) -> f64 {
    let [a, b, x] = [a, b, x].map(Real::<Plain>::new);
    beta_fraction(a, b, x).value()
}
