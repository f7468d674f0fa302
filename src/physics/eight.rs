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

use super::elementary::{self, ATANHC, COSH, EXPC, SINHC};
use super::exact::FAR;
use crate::scalar::{Plain, Real, polynomial};

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

/// `elementary::expc` of each; beyond its series by doubling, as
/// (1 - exp(-2y))/(2y) = f (1 - y f/2) for f = (1 - exp(-y))/y.
#[inline(always)]
pub(super) fn expc(x: &Eight) -> Eight {
    if near(x, 0.04) {
        series(x, &EXPC[..8])
    } else if near(x, 0.1) {
        series(x, &EXPC)
    } else {
        doubled_expc(x)
    }
}

#[inline(never)]
fn doubled_expc(x: &Eight) -> Eight {
    let bound = x.iter().fold(0.0, |a: f64, x| a.max(x.abs())).min(FAR);
    let doublings = (bound / 0.1).log2().ceil().max(0.0) as i32;
    let mut y = x.map(|x| x * 0.5_f64.powi(doublings));
    let mut f = series(&y, &EXPC);
    for _ in 0..doublings {
        for l in 0..EIGHT {
            f[l] *= 1.0 - 0.5 * y[l] * f[l];
            y[l] *= 2.0;
        }
    }
    f
}

/// `elementary::atanhc` of each.
#[inline(always)]
pub(super) fn atanhc(z: &Eight) -> Eight {
    if near(z, 3e-3) {
        series(z, &ATANHC[..6])
    } else if near(z, 0.05) {
        series(z, &ATANHC)
    } else {
        one_by_one(z, elementary::atanhc)
    }
}

/// `elementary::tanhc` of each.
#[inline(always)]
pub(super) fn tanhc(z: &Eight) -> Eight {
    if near(z, 0.05) {
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
                assert!((expc(&all)[l] - exact).abs() < 6e-16, "{x}");
                let z = x.min(0.9);
                let exact = one(elementary::atanhc, z);
                assert_eq!(atanhc(&[z; EIGHT])[l], exact);
                let exact = one(elementary::tanhc, -z);
                assert_eq!(tanhc(&[-z; EIGHT])[l], exact);
            }
        }
    }
}
