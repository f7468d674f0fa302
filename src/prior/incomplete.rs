//! The regularised incomplete gamma and beta functions as logarithms, with
//! derivatives along every argument.
//!
//! Numbers with derivatives go through a series or a continued fraction as
//! values do, so that no formula for the derivative along a shape is needed.

use super::cumulative::ln_1m_exp;
use super::special::ln_gamma;
use crate::scalar::{Kind, Real};

/// The most terms: both need about the square root of a shape.
const TERMS: u32 = 20_000;
/// A factor that differs from 1 by less ends a fraction, and a term that is
/// less than such a part of its sum ends a series.
const SMALL: f64 = 1e-16;

/// ln P(shape, x) and ln Q(shape, x), for x > 0: the probabilities that
/// Gamma(shape, 1) falls below and above x.
pub(super) fn ln_gamma_parts<K: Kind>(
    shape: Real<K>,
    x: Real<K>,
) -> (Real<K>, Real<K>) {
    let log = shape * x.ln() - x - ln_gamma(shape);
    if x < shape + 1.0 {
        let below = log + gamma_series(shape, x).ln();
        (below, ln_1m_exp(below))
    } else {
        let above = log + gamma_fraction(shape, x).ln();
        (ln_1m_exp(above), above)
    }
}

/// 1/a + x/(a (a + 1)) + x^2/(a (a + 1) (a + 2)) + ... (DLMF 8.7.1).
fn gamma_series<K: Kind>(a: Real<K>, x: Real<K>) -> Real<K> {
    let mut term = 1.0 / a;
    let mut sum = term;
    for n in 1..TERMS {
        term *= x / (a + f64::from(n));
        sum += term;
        if term.value() < SMALL * sum.value() {
            break;
        }
    }
    sum
}

/// 1/(x + 1 - a - 1 (1 - a)/(x + 3 - a - 2 (2 - a)/(x + 5 - a - ...)))
/// (DLMF 8.9.2), from the left (Lentz).
fn gamma_fraction<K: Kind>(a: Real<K>, x: Real<K>) -> Real<K> {
    let mut b = x + 1.0 - a;
    let mut d = 1.0 / off_zero(b);
    let mut c = Real::new(1e300);
    let mut value = d;
    let least = least_terms(&[a]);
    for k in 1..TERMS {
        let n = f64::from(k);
        let term = n * (a - n);
        b += 2.0;
        d = 1.0 / off_zero(term * d + b);
        c = off_zero(b + term / c);
        value *= c * d;
        if k >= least && ((c * d).value() - 1.0).abs() < SMALL {
            break;
        }
    }
    value
}

/// ln I_x(a, b) and ln (1 - I_x(a, b)), for 0 < x < 1 and y = 1 - x: the
/// probabilities that Beta(a, b) falls below and above x. `ln_beta` is
/// ln B(a, b).
pub(super) fn ln_beta_parts<K: Kind>(
    [a, b]: [Real<K>; 2],
    [x, y]: [Real<K>; 2],
    ln_beta: Real<K>,
) -> (Real<K>, Real<K>) {
    let log = a * x.ln() + b * y.ln() - ln_beta;
    let mean = (a + 1.0) / (a + b + 2.0);
    if x < mean {
        let below = log - (a * beta_fraction(a, b, x)).ln();
        (below, ln_1m_exp(below))
    } else {
        let above = log - (b * beta_fraction(b, a, y)).ln();
        (ln_1m_exp(above), above)
    }
}

/// The continued fraction 1 + d1/(1 + d2/(1 + ..)) of x^a (1 - x)^b / (a B)
/// over the regularised incomplete beta function (DLMF 8.17.22), from the
/// left (Lentz); quick below the mean, in about sqrt(a + b) terms.
pub(super) fn beta_fraction<K: Kind>(
    a: Real<K>,
    b: Real<K>,
    x: Real<K>,
) -> Real<K> {
    let one = Real::new(1.0);
    let (mut value, mut c, mut d) = (one, one, Real::new(0.0));
    let least = least_terms(&[a, b]);
    for k in 1..TERMS {
        let m = f64::from(k / 2);
        let term = if k % 2 == 1 {
            -(a + m) * (a + b + m) / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        } else {
            m * (b - m) / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } * x;
        d = 1.0 / off_zero(1.0 + term * d);
        c = off_zero(1.0 + term / c);
        value *= c * d;
        if k >= least && ((c * d).value() - 1.0).abs() < SMALL {
            break;
        }
    }
    value
}

/// How many terms a fraction has at the least. For whole shapes a term is 0,
/// which ends the fraction, but not its derivative along the shape.
fn least_terms<K: Kind>(shapes: &[Real<K>]) -> u32 {
    match shapes.iter().all(|shape| shape.is_constant()) {
        true => 1,
        false => {
            let sum: f64 = shapes.iter().map(|shape| shape.value()).sum();
            // Enough for 16 digits near the mean, where it is slowest.
            (100.0 + 10.0 * sum.sqrt()).min(f64::from(TERMS - 1)) as u32
        }
    }
}

/// `x`, or a tiny number in place of 0.
fn off_zero<K: Kind>(x: Real<K>) -> Real<K> {
    if x == 0.0 { Real::new(1e-300) } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Grad;

    /// Derivatives along three arguments beside central differences.
    fn check(f: impl Fn([Real<Grad<3>>; 3]) -> Real<Grad<3>>, at: [f64; 3]) {
        let found = f([0, 1, 2].map(|i| Real::variable(at[i], i)));
        for i in 0..3 {
            let h = 1e-4 * at[i];
            let off = |by: f64| {
                let mut at = at;
                at[i] += by;
                f(at.map(Real::new)).value()
            };
            let expected = (off(h) - off(-h)) / (2.0 * h);
            // h^2 of third derivatives, and round-off of ln Γ over h.
            let error = 2e-7 * (1.0 + expected.abs());
            let found = found.partial(i);
            assert!((found - expected).abs() < error, "{found} {expected}");
        }
    }

    #[test]
    fn derivatives_are_differences() {
        for shape in [0.3, 1.0, 2.5, 4.0, 40.0] {
            for part in [0.2, 0.9, 1.4, 3.0] {
                let at = [shape, part * shape, 1.0];
                let of = |[a, x, _]: [_; 3]| ln_gamma_parts::<Grad<3>>(a, x);
                check(|at| of(at).0, at);
                check(|at| of(at).1, at);
            }
        }
        for [a, b] in [[0.4, 2.0], [3.0, 0.5], [2.0, 3.0], [20.0, 30.0]] {
            for x in [0.1, 0.4, 0.8] {
                let of = |[a, b, x]: [Real<Grad<3>>; 3]| {
                    let ln_beta = ln_gamma(a) + ln_gamma(b) - ln_gamma(a + b);
                    ln_beta_parts([a, b], [x, 1.0 - x], ln_beta)
                };
                check(|at| of(at).0, [a, b, x]);
                check(|at| of(at).1, [a, b, x]);
            }
        }
    }
}
