//! A distribution cut off at one end or both.

use rand_distr::{Distribution as _, Open01};

use super::cumulative::ln_1m_exp;
use super::special::root;
use super::{
    Cumulative, Distribution, Prior, Support, impossible, quantile_of,
};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Truncated(D, low, high), for low < x < high:
/// p(x) = p_D(x) / P_D(low < X < high). An end may be infinite.
///
/// ```
/// use couloir::prior::{Distribution, Normal, Prior, Truncated};
/// use couloir::scalar::{Plain, Real};
/// let whole = Normal::<Plain>::new(0.0, 2.0);
/// let half = Truncated::new(whole, 0.0, f64::INFINITY);
/// let x = Real::new(1.0);
/// let ratio = half.log_density(x) - whole.log_density(x);
/// assert!((ratio.value() - 2.0_f64.ln()).abs() < 1e-15);
/// assert!(half.quantile(0.1).unwrap() > 0.0);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Truncated<K: Kind, D> {
    of: D,
    low: Real<K>,
    high: Real<K>,
}

impl<K: Kind, D: Cumulative<K>> Truncated<K, D> {
    /// A distribution and the two ends of what is left of it.
    #[inline]
    pub fn new(
        of: D,
        low: impl Into<Real<K>>,
        high: impl Into<Real<K>>,
    ) -> Self {
        Self { of, low: low.into(), high: high.into() }
    }

    /// ln of the probability below `x` and above it, at any `x`.
    fn log_parts(&self, x: Real<K>) -> (Real<K>, Real<K>) {
        let (low, high) = self.of.support().ends();
        let (none, all) = (Real::new(f64::NEG_INFINITY), Real::new(0.0));
        match x.value() {
            x if x <= low => (none, all),
            x if x >= high => (all, none),
            _ => (self.of.log_below(x), self.of.log_above(x)),
        }
    }

    /// ln of the probability between two numbers, in the smaller tail.
    fn log_between(&self, low: Real<K>, high: Real<K>) -> Real<K> {
        if !(low < high) {
            return impossible();
        }
        let (below_low, above_low) = self.log_parts(low);
        let (below_high, above_high) = self.log_parts(high);
        match below_high < above_low {
            true => difference(below_high, below_low),
            false => difference(above_low, above_high),
        }
    }

    fn log_mass(&self) -> Real<K> {
        self.log_between(self.low, self.high)
    }

    /// The number below which a share of `p` of what is left lies, by
    /// Newton's steps and bisection.
    fn solve(&self, p: f64) -> f64 {
        let goal = self.log_mass().value() + p.ln();
        let f = |x: f64| {
            let x = Real::new(x);
            let below = self.log_between(self.low, x).value();
            let slope = self.of.log_density(x).value() - below;
            (below - goal, slope.exp())
        };
        let ends = self.bracket(&f);
        root(ends, 0.5 * (ends.0 + ends.1), f)
    }

    /// Finite numbers below and above a root of an increasing function.
    fn bracket(&self, f: impl Fn(f64) -> (f64, f64)) -> (f64, f64) {
        let (low, high) = self.support().ends();
        let middle = self.of.quantile(0.5).unwrap_or(0.0);
        let (mut below, mut above) = (low, high);
        let mut step = 1.0;
        if low.is_infinite() {
            below = middle.min(high) - step;
            while f(below).0 > 0.0 && below.is_finite() {
                step *= 2.0;
                below -= step;
            }
        }
        if high.is_infinite() {
            above = middle.max(low) + step;
            while f(above).0 < 0.0 && above.is_finite() {
                step *= 2.0;
                above += step;
            }
        }
        (below.max(f64::MIN), above.min(f64::MAX))
    }
}

/// ln(e^a - e^b) for a > b.
fn difference<K: Kind>(a: Real<K>, b: Real<K>) -> Real<K> {
    match b.value() == f64::NEG_INFINITY {
        true => a,
        false => a + ln_1m_exp(b - a),
    }
}

/// A bound, where it is one.
fn finite<K: Kind>(bound: Real<K>) -> Option<Real<K>> {
    bound.value().is_finite().then_some(bound)
}

impl<K: Kind, D: Cumulative<K>> Distribution<K> for Truncated<K, D> {
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !(x > self.low && x < self.high) {
            return impossible();
        }
        let mass = self.log_mass();
        match mass.value().is_finite() {
            true => self.of.log_density(x) - mass,
            false => impossible(),
        }
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        self.quantile(Open01.sample(rng))
    }
}

impl<K: Kind, D: Cumulative<K>> Prior<K> for Truncated<K, D> {
    fn support(&self) -> Support<K> {
        self.of.support().cut(finite(self.low), finite(self.high))
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        // There is none where the distribution itself does not exist.
        self.of.quantile(0.5)?;
        self.log_mass().value().is_finite().then_some(())?;
        quantile_of(&self.support(), p, |p| self.solve(p))
    }
}
