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
            _ => self.of.log_parts(x),
        }
    }

    /// ln of the probability between two numbers, in the smaller tail.
    fn log_between(&self, low: Real<K>, high: Real<K>) -> Real<K> {
        let is_range = low < high;
        if !is_range {
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
        let ends = self.bracket(f);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prior::{
        Beta, Cauchy, Exponential, Gamma, HalfCauchy, HalfNormal,
        InverseGamma, LogNormal, Normal, StudentT, Uniform,
    };
    use crate::scalar::{Grad, Plain};
    use crate::seed::Seed;

    /// Probabilities below and above each quantile, far into both tails.
    fn check<D: Cumulative<Plain>>(of: &D) {
        for p in [1e-12, 1e-4, 0.3, 0.5, 0.9, 0.9999] {
            let x = Real::new(of.quantile(p).unwrap());
            let (below, above) = (of.log_below(x), of.log_above(x));
            // Of the quantile's round-off, seen through the density, of 1 - p
            // as a number, and of statrs's normal quantile.
            let slope = (of.log_density(x).value() - p.ln()).exp();
            let error = 1e-9 + 1e-14 * slope * x.value().abs();
            let off = (below.value() - p.ln()).abs();
            assert!(off < error, "{p} {off}");
            let slope = (of.log_density(x) - above).value().exp();
            let error = 1e-9 + 1e-14 * slope * x.value().abs();
            let off = (above.value() - (-p).ln_1p()).abs();
            assert!(off < error, "{p} {off}");
        }
    }

    #[test]
    fn probabilities_are_those_of_quantiles() {
        check(&Normal::new(1.0, 2.0));
        check(&LogNormal::new(-1.0, 0.5));
        check(&Exponential::new(3.0));
        check(&Uniform::new(-1.0, 4.0));
        check(&HalfNormal::new(2.0));
        check(&Cauchy::new(1.0, 2.0));
        check(&HalfCauchy::new(2.0));
        for shape in [0.4, 3.0, 60.0] {
            check(&Gamma::new(shape, 2.0));
            check(&InverseGamma::new(shape, 2.0));
            check(&Beta::new(shape, 1.5));
            check(&Beta::new(0.7, shape));
            check(&StudentT::new(shape, 1.0, 2.0));
        }
    }

    #[test]
    fn what_is_left_integrates_to_one() {
        let normal = || Normal::<Plain>::new(0.0, 1.0);
        for (low, high) in [(-0.5, 2.0), (8.0, 9.0), (-21.0, -20.5)] {
            let cut = Truncated::new(normal(), low, high);
            let n = 20_000;
            let h = (high - low) / f64::from(n);
            let at = |i| Real::new(low + h * (f64::from(i) + 0.5));
            let sum: f64 =
                (0..n).map(|i| cut.log_density(at(i)).value().exp()).sum();
            // Midpoints: h^2/24 times the change of slope, below 1e-7 here.
            assert!((sum * h - 1.0).abs() < 1e-6, "{low} {}", sum * h);
        }
    }

    #[test]
    fn quantiles_and_draws_lie_inside() {
        let infinite = f64::INFINITY;
        let ends =
            [(-1.0, 0.5), (30.0, infinite), (-infinite, -9.0), (1.0, 1.5)];
        for (low, high) in ends {
            let cut =
                Truncated::new(Normal::<Plain>::new(0.0, 1.0), low, high);
            let of = |p| cut.quantile(p).unwrap();
            let part = |x| cut.log_between(Real::new(low), Real::new(x));
            for p in [1e-6, 0.2, 0.5, 0.8] {
                let share = (part(of(p)) - cut.log_mass()).value().exp();
                // Of 30 + 3e-8 the last digit is a 1e-7th of the rest.
                assert!((share / p - 1.0).abs() < 1e-6, "{low} {p} {share}");
            }
            let x = cut.draw(&mut Seed::new(1).rng()).unwrap();
            assert!(x > low && x < high && cut.support().contains(x));
        }
    }

    /// Of a distribution with two parameters, cut off from the third on, at
    /// the fourth.
    fn check_derivatives<D: Cumulative<Grad<4>>>(
        of: impl Fn([Real<Grad<4>>; 2]) -> D,
        at: [f64; 4],
    ) {
        let log = |v: [f64; 4]| {
            let x: Vec<_> =
                (0..4).map(|i| Real::<Grad<4>>::variable(v[i], i)).collect();
            let cut = Truncated::new(of([x[0], x[1]]), x[2], f64::INFINITY);
            cut.log_density(x[3])
        };
        for i in 0..4 {
            let moved = |h: f64| {
                let mut v = at;
                v[i] += h;
                log(v).value()
            };
            let known = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            // A central difference: 1e-10 of curvature, 1e-11 of round-off.
            assert!((log(at).partial(i) - known).abs() < 1e-8, "{i}");
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        check_derivatives(|[a, b]| Normal::new(a, b), [0.3, 1.2, -0.4, 0.9]);
        check_derivatives(|[a, b]| Gamma::new(a, b), [2.3, 1.2, 0.4, 0.9]);
        let inverse = |[a, b]: [_; 2]| InverseGamma::new(a, b);
        check_derivatives(inverse, [2.3, 1.2, 0.4, 0.9]);
        check_derivatives(|[a, b]| Beta::new(a, b), [2.3, 1.2, 0.4, 0.9]);
        for cut in [-0.7, 0.0, 0.5] {
            let student = |[a, b]: [_; 2]| StudentT::new(a, b, 1.3);
            check_derivatives(student, [3.3, cut, cut, 0.9]);
            check_derivatives(student, [3.3, 0.2, cut, 0.9]);
        }
    }

    #[test]
    fn impossible_ends_have_no_density() {
        let cut = |low, high| {
            Truncated::new(Normal::<Plain>::new(0.0, 1.0), low, high)
        };
        for empty in [cut(1.0, 1.0), cut(2.0, 1.0), cut(f64::NAN, 1.0)] {
            let log = empty.log_density(Real::new(1.0)).value();
            assert_eq!(log, f64::NEG_INFINITY);
            assert!(empty.quantile(0.5).is_none());
        }
        let own = Truncated::new(Uniform::<Plain>::new(0.0, 1.0), -1.0, 9.0);
        assert_eq!(own.support().ends(), (0.0, 1.0));
        assert_eq!(own.log_density(Real::new(0.5)).value(), 0.0);
    }
}
