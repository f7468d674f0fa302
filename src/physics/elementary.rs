//! The few functions that the exact solution is made of, free of
//! cancellation at 0 and good for either sign of their argument.
//!
//! Each is entire or analytic at 0, where the textbook form is 0/0: a short
//! series serves there, the closed form elsewhere. The bound of each series
//! is set so that the first term left out is below 1e-16 of the value.

use crate::scalar::{Kind, Real, polynomial};

/// atanh(sqrt z)/sqrt z = sum z^n/(2n+1); atan for z < 0. z < 1.
#[inline(always)]
pub(crate) fn atanhc<K: Kind>(z: Real<K>) -> Real<K> {
    let x = z.value();
    let value = atanhc_value(x);
    let slope = if x.abs() < 3e-3 {
        polynomial(x, &ATANHC_SLOPE[..6])
    } else if x.abs() < 0.05 {
        polynomial(x, &ATANHC_SLOPE)
    } else {
        (1.0 / (1.0 - x) - value) / (2.0 * x)
    };
    z.chain(value, slope)
}

/// 1/(2n+1), and n/(2n+1) one place on.
pub(super) const ATANHC: [f64; 13] = odd_reciprocals();
pub(super) const ATANHC_SLOPE: [f64; 12] = derivative(&ATANHC);

const fn odd_reciprocals() -> [f64; 13] {
    let mut c = [0.0; 13];
    let mut n = 0;
    while n < c.len() {
        c[n] = 1.0 / (2 * n + 1) as f64;
        n += 1;
    }
    c
}

/// The coefficients of the derivative of a power series.
const fn derivative<const N: usize, const M: usize>(c: &[f64; N]) -> [f64; M] {
    let mut d = [0.0; M];
    let mut n = 0;
    while n < M {
        d[n] = (n + 1) as f64 * c[n + 1];
        n += 1;
    }
    d
}

#[inline(always)]
fn atanhc_value(x: f64) -> f64 {
    if x.abs() < 3e-3 {
        polynomial(x, &ATANHC[..6])
    } else if x.abs() < 0.05 {
        polynomial(x, &ATANHC)
    } else if x > 0.0 {
        let r = x.sqrt();
        r.atanh() / r
    } else {
        let r = (-x).sqrt();
        r.atan() / r
    }
}

/// (1 - exp(-x))/x.
#[inline(always)]
pub(crate) fn expc<K: Kind>(x: Real<K>) -> Real<K> {
    let v = x.value();
    if v.abs() < 0.04 {
        x.chain(polynomial(v, &EXPC[..8]), polynomial(v, &EXPC_SLOPE[..8]))
    } else if v.abs() < 0.1 {
        x.chain(polynomial(v, &EXPC), polynomial(v, &EXPC_SLOPE))
    } else {
        let value = -(-v).exp_m1() / v;
        x.chain(value, ((-v).exp() - value) / v)
    }
}

/// (-1)^n/(n+1)!.
pub(super) const EXPC: [f64; 11] = {
    let mut c = [1.0; 11];
    let mut n = 1;
    while n < c.len() {
        c[n] = -c[n - 1] / (n + 1) as f64;
        n += 1;
    }
    c
};
pub(super) const EXPC_SLOPE: [f64; 10] = derivative(&EXPC);

/// ln(1 + x)/x.
#[inline(always)]
pub(crate) fn lnc<K: Kind>(x: Real<K>) -> Real<K> {
    let v = x.value();
    if v.abs() < 3e-3 {
        let (log, slope) = (&LNC[..7], &LNC_SLOPE[..6]);
        return x.chain(polynomial(v, log), polynomial(v, slope));
    }
    if v.abs() < 0.02 {
        return x.chain(polynomial(v, &LNC), polynomial(v, &LNC_SLOPE));
    }
    let value = v.ln_1p() / v;
    x.chain(value, (1.0 / (1.0 + v) - value) / v)
}

/// (-1)^n/(n+1).
const LNC: [f64; 11] = {
    let mut c = [1.0; 11];
    let mut n = 1;
    while n < c.len() {
        let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
        c[n] = sign / (n + 1) as f64;
        n += 1;
    }
    c
};
const LNC_SLOPE: [f64; 10] = derivative(&LNC);

/// tanh(sqrt z)/sqrt z; tan for z < 0 (z > -pi^2/4).
#[inline(always)]
pub(crate) fn tanhc<K: Kind>(z: Real<K>) -> Real<K> {
    let x = z.value();
    if x.abs() < 3e-3 {
        return z.chain(polynomial(x, &TANHC), polynomial(x, &TANHC_SLOPE));
    }
    let value = if x.abs() < 0.05 {
        polynomial(x, &SINHC) / polynomial(x, &COSH)
    } else if x > 0.0 {
        let r = x.sqrt();
        r.tanh() / r
    } else {
        let r = (-x).sqrt();
        r.tan() / r
    };
    // With t = tanhc: (t^2 + ... ) from d/dz, (1 - z t^2 - t)/(2 z).
    let slope = if x.abs() < 0.05 {
        let (s, c) = (polynomial(x, &SINHC), polynomial(x, &COSH));
        let ds = polynomial(x, &SINHC_SLOPE);
        (ds - value * 0.5 * s) / c
    } else {
        (1.0 - x * value * value - value) / (2.0 * x)
    };
    z.chain(value, slope)
}

/// The series of the hyperbolic tangent (Abramowitz and Stegun 1972, 4.5.64).
pub(super) const TANHC: [f64; 7] = [
    1.0,
    -1.0 / 3.0,
    2.0 / 15.0,
    -17.0 / 315.0,
    62.0 / 2835.0,
    -1382.0 / 155_925.0,
    21_844.0 / 6_081_075.0,
];
const TANHC_SLOPE: [f64; 6] = derivative(&TANHC);

/// sinh(sqrt z)/sqrt z; sin for z < 0.
#[inline(always)]
pub(crate) fn sinhc<K: Kind>(z: Real<K>) -> Real<K> {
    let x = z.value();
    if x.abs() < 3e-3 {
        let (value, slope) = (&SINHC[..5], &SINHC_SLOPE[..4]);
        return z.chain(polynomial(x, value), polynomial(x, slope));
    }
    if x.abs() < 0.2 {
        return z.chain(polynomial(x, &SINHC), polynomial(x, &SINHC_SLOPE));
    }
    let (s, c) = sinhc_cosh(x);
    z.chain(s, (c - s) / (2.0 * x))
}

/// (cosh(sqrt z) - 1)/z; cos for z < 0.
#[inline(always)]
pub(crate) fn coshc<K: Kind>(z: Real<K>) -> Real<K> {
    let x = z.value();
    if x.abs() < 3e-3 {
        let (value, slope) = (&COSHC[..5], &COSHC_SLOPE[..4]);
        return z.chain(polynomial(x, value), polynomial(x, slope));
    }
    if x.abs() < 0.2 {
        return z.chain(polynomial(x, &COSHC), polynomial(x, &COSHC_SLOPE));
    }
    let (s, c) = sinhc_cosh(x);
    let value = (c - 1.0) / x;
    z.chain(value, (0.5 * s - value) / x)
}

/// sinh(sqrt x)/sqrt x and cosh(sqrt x), or their circular continuations.
fn sinhc_cosh(x: f64) -> (f64, f64) {
    if x > 0.0 {
        let r = x.sqrt();
        (r.sinh() / r, r.cosh())
    } else {
        let r = (-x).sqrt();
        (r.sin() / r, r.cos())
    }
}

/// 1/(2n + first)!.
const fn even_factorials(first: usize) -> [f64; 10] {
    let mut c = [1.0; 10];
    let mut k = 2;
    while k <= first {
        c[0] /= k as f64;
        k += 1;
    }
    let mut n = 1;
    while n < c.len() {
        let m = 2 * n + first;
        c[n] = c[n - 1] / (m * (m - 1)) as f64;
        n += 1;
    }
    c
}
pub(super) const SINHC: [f64; 10] = even_factorials(1);
pub(super) const COSH: [f64; 10] = even_factorials(0);
const COSHC: [f64; 10] = even_factorials(2);
const SINHC_SLOPE: [f64; 9] = derivative(&SINHC);
const COSHC_SLOPE: [f64; 9] = derivative(&COSHC);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Grad;

    type D = Real<Grad<4>>;

    /// Each function by its textbook form, in the variable's root.
    fn textbook(name: usize, z: f64) -> f64 {
        let r = z.abs().sqrt();
        let positive = z > 0.0;
        match name {
            0 if positive => r.atanh() / r,
            0 => r.atan() / r,
            1 => (1.0 - (-z).exp()) / z,
            2 => (1.0 + z).ln() / z,
            3 if positive => r.tanh() / r,
            3 => r.tan() / r,
            4 if positive => r.sinh() / r,
            4 => r.sin() / r,
            5 if positive => (r.cosh() - 1.0) / z,
            _ => (r.cos() - 1.0) / z,
        }
    }

    const ALL: [fn(D) -> D; 6] = [atanhc, expc, lnc, tanhc, sinhc, coshc];

    #[test]
    fn they_are_what_the_textbook_says() {
        for (name, f) in ALL.iter().enumerate() {
            for z in [-0.9, -0.3, -0.04, -0.01, 0.01, 0.03, 0.15, 0.5, 0.9] {
                let error = f(D::new(z)).value() - textbook(name, z);
                // The textbook form loses 1e-16/|z|.
                assert!(error.abs() < 4e-16 / z.abs() + 1e-15, "{name} {z}");
            }
            assert!(
                (f(D::new(0.0)).value()
                    - [1.0, 1.0, 1.0, 1.0, 1.0, 0.5][name])
                    .abs()
                    < 1e-16
            );
        }
    }

    #[test]
    fn values_and_slopes_join_where_the_series_end() {
        for (name, f) in ALL.iter().enumerate() {
            for bound in [3e-3, 0.02, 0.05, 0.1, 0.2] {
                for bound in [bound, -bound] {
                    let at = |z| f(D::variable(z, 0));
                    let (a, b) = (at(bound * (1.0 - 1e-15)), at(bound));
                    assert!(
                        (a.value() - b.value()).abs() < 2e-15,
                        "{name} {bound}"
                    );
                    let slack = 2e-15 / bound.abs();
                    let jump = a.partial(0) - b.partial(0);
                    assert!(jump.abs() < slack, "{name} {bound} {jump:e}");
                }
            }
        }
    }

    #[test]
    fn slopes_are_the_differences() {
        let h = 1e-4;
        for (name, f) in ALL.iter().enumerate() {
            for z in [-0.7, -0.1, -0.03, -1e-3, 0.0, 2e-3, 0.03, 0.15, 0.7] {
                let at = |z| f(D::new(z)).value();
                let difference = (8.0 * (at(z + h) - at(z - h))
                    - (at(z + 2.0 * h) - at(z - 2.0 * h)))
                    / (12.0 * h);
                let slope = f(D::variable(z, 0)).partial(0);
                assert!(
                    (slope - difference).abs() < 1e-10,
                    "{name} {z}: {slope} {difference}"
                );
            }
        }
    }
}
