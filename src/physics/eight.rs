//! The functions of `elementary`, of eight numbers at once.
//!
//! Plain loops over an array, which the compiler turns into vector
//! instructions of the machine it builds for: two vectors of AVX2, one of
//! AVX-512. The same series serve as for one number; where one of the eight
//! lies outside them, all go the long way.

#![allow(
    clippy::needless_range_loop,
    reason = "loops over an index become vectors, chains of iterators do not"
)]

use super::elementary::{
    self, ATANHC, ATANHC_SLOPE, COSH, EXPC, EXPC_SLOPE, SINHC, TANHC,
};
use super::exact::FAR;
use crate::scalar::{Grad, Plain, Real, polynomial};

/// How many numbers there are.
pub(super) const EIGHT: usize = 8;

/// Eight numbers.
pub(super) type Eight = [f64; EIGHT];

/// Whether all lie nearer to 0 than a bound.
#[inline(always)]
fn near(x: &Eight, bound: f64) -> bool {
    let mut near = true;
    for x in x {
        near &= x.abs() < bound;
    }
    near
}

#[inline(always)]
fn series(x: &Eight, coefficients: &[f64]) -> Eight {
    let mut sums = [0.0; EIGHT];
    for i in 0..EIGHT {
        sums[i] = polynomial(x[i], coefficients);
    }
    sums
}

/// `elementary::expc` of each, and its derivative if asked for; beyond its
/// series by doubling, as f(2y) = f (1 - y f/2) for f = (1 - exp(-y))/y.
#[inline(always)]
pub(super) fn expc(x: &Eight, sloped: bool) -> (Eight, Eight) {
    if near(x, 0.04) {
        both(x, &EXPC[..8], &EXPC_SLOPE[..8], sloped)
    } else if near(x, 0.1) {
        both(x, &EXPC, &EXPC_SLOPE, sloped)
    } else {
        doubled_expc(x)
    }
}

/// A series and, if asked for, the one of its derivative.
#[inline(always)]
fn both(x: &Eight, of: &[f64], slope: &[f64], sloped: bool) -> (Eight, Eight) {
    let slopes = if sloped { series(x, slope) } else { [0.0; EIGHT] };
    (series(x, of), slopes)
}

#[inline(never)]
fn doubled_expc(x: &Eight) -> (Eight, Eight) {
    let bound = x.iter().fold(0.0, |a: f64, x| a.max(x.abs())).min(FAR);
    let doublings = (bound / 0.1).log2().ceil().max(0.0) as i32;
    let mut y = x.map(|x| x * 0.5_f64.powi(doublings));
    let (mut f, mut slope) = both(&y, &EXPC, &EXPC_SLOPE, true);
    for _ in 0..doublings {
        for l in 0..EIGHT {
            let yf = y[l] * f[l];
            slope[l] = 0.5 * (slope[l] * (1.0 - yf) - 0.5 * f[l] * f[l]);
            f[l] *= 1.0 - 0.5 * yf;
            y[l] *= 2.0;
        }
    }
    (f, slope)
}

/// `elementary::atanhc` of each, and its derivative if asked for.
#[inline(always)]
pub(super) fn atanhc(z: &Eight, sloped: bool) -> (Eight, Eight) {
    if near(z, 3e-3) {
        both(z, &ATANHC[..6], &ATANHC_SLOPE[..6], sloped)
    } else if near(z, 0.05) {
        both(z, &ATANHC, &ATANHC_SLOPE, sloped)
    } else {
        beyond_series(z)
    }
}

#[inline(never)]
fn beyond_series(z: &Eight) -> (Eight, Eight) {
    let all = z.map(|z| elementary::atanhc(Real::<Grad<1>>::variable(z, 0)));
    (all.map(Real::value), all.map(|f| f.partial(0)))
}

/// `elementary::tanhc` of each.
#[inline(always)]
pub(super) fn tanhc(z: &Eight) -> Eight {
    if near(z, 3e-3) {
        series(z, &TANHC)
    } else if near(z, 0.05) {
        let (sine, cosine) = (series(z, &SINHC), series(z, &COSH));
        let mut tangent = [0.0; EIGHT];
        for i in 0..EIGHT {
            tangent[i] = sine[i] / cosine[i];
        }
        tangent
    } else {
        one_by_one(z, elementary::tanhc)
    }
}

#[inline(never)]
fn one_by_one(x: &Eight, f: fn(Real<Plain>) -> Real<Plain>) -> Eight {
    x.map(|x| f(x.into()).value())
}

#[cfg(test)]
mod tests {
    use super::*;

    type Number = Real<Plain>;

    #[test]
    fn series_are_those_of_one_number() {
        for size in [1e-3, 0.01, 0.06, 0.3, 1.9] {
            let x: Eight = std::array::from_fn(|l| size * (l as f64 / 7.0));
            let one = |f: fn(Number) -> Number, x: f64| f(x.into()).value();
            for (l, x) in x.iter().enumerate() {
                let all = [*x; EIGHT];
                let exact = one(elementary::expc, *x);
                // Half an ulp for each doubling.
                assert!((expc(&all, false).0[l] - exact).abs() < 6e-16, "{x}");
                let z = x.min(0.9);
                let exact = one(elementary::atanhc, z);
                assert_eq!(atanhc(&[z; EIGHT], false).0[l], exact);
                let exact = one(elementary::tanhc, -z);
                assert_eq!(tanhc(&[-z; EIGHT])[l], exact);
            }
        }
    }
}
