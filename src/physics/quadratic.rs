//! The closed forms of du/dt = a - c u^2, with their derivatives.
//!
//! A number that carries many derivatives takes all of them along through each
//! step of a formula. Here the partial derivatives by the few numbers that a
//! leg depends on are worked out as plain numbers, and put together once. The
//! forms themselves are those of `exact`; its rates are a and c.

use super::elementary::{atanhc, coshc, expc, lnc, sinhc, tanhc};
use crate::scalar::{Grad, Kind, Real};

/// A function of one number at a place, with its slope.
#[inline(always)]
fn sloped(
    function: impl Fn(Real<Grad<1>>) -> Real<Grad<1>>,
    x: f64,
) -> (f64, f64) {
    let y = function(Real::variable(x, 0));
    (y.value(), y.partial(0))
}

/// A speed u with its square w, which the solution over distance needs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pace<K: Kind> {
    pub(crate) u: Real<K>,
    pub(crate) w: Real<K>,
}

impl<K: Kind> Pace<K> {
    #[inline(always)]
    pub(crate) fn new(u: Real<K>) -> Self {
        Self { u, w: u * u }
    }
}

/// 2 c l above which a stretch is left to `Force::cross_far`.
pub(super) const FAR: f64 = 2.0;

/// How a stretch of length l is crossed, and in what time: by the chain rule
/// on w1 = w0 e + a E, where E = (1 - e)/c and e' = -2 l e by c, -2 c e by l;
/// and on T = q h(z), which changes with q as 1/(1 - z).
#[inline(always)]
pub(super) fn cross<K: Kind>(
    rates: [&Real<K>; 2],
    pace: &Pace<K>,
    length: Real<K>,
) -> Option<(Pace<K>, Real<K>)> {
    let ([a, c], l) = (rates.map(|rate| rate.value()), length.value());
    let (u0, w0) = (pace.u.value(), pace.w.value());
    let x = c * l * 2.0;
    let (mean, mean_x) = sloped(expc, x);
    let spread = mean * l * 2.0;
    let decay = 1.0 - c * spread;
    let w = w0 * decay + a * spread;
    if w <= 0.0 || x.abs() > FAR {
        return None;
    }
    let u = w.sqrt();
    let both = u + u0 * decay;
    let q = spread / both;
    let z = a * c * q * q;
    let (bent, bent_z) = sloped(atanhc, z);
    let (spread_c, lost) = (mean_x * l * l * 4.0, 2.0 * l * decay);
    let w1 = Real::combine(
        w,
        [
            (&pace.w, decay),
            (rates[0], spread),
            (rates[1], a * spread_c - lost * w0),
            (&length, 2.0 * decay * (a - c * w0)),
        ],
    );
    let (u_w, swift) = (0.5 / u, q * q * q * bent_z);
    let part = 1.0 / (both * (1.0 - z));
    let after = Real::combine(
        q * bent,
        [
            (&pace.u, -q * part * decay),
            (&w1, -q * part * u_w),
            (rates[0], swift * c),
            (rates[1], part * (spread_c + q * u0 * lost) + swift * a),
            (&length, 2.0 * decay * part * (1.0 + q * u0 * c)),
        ],
    );
    Some((Pace { u: w1.chain(u, u_w), w: w1 }, after))
}

/// a, c, speed and time as plain numbers, and z = a c t^2.
#[inline(always)]
fn numbers<K: Kind>(rates: [&Real<K>; 2], u: Real<K>, t: Real<K>) -> [f64; 5] {
    let [a, c] = rates.map(|rate| rate.value());
    let [u, t] = [u, t].map(Real::value);
    [a, c, u, t, a * c * t * t]
}

/// The speed after time `t`: (a g + u)/(1 + c u g), g = t h(z), h the
/// hyperbolic tangent of the root of z = a c t^2 over that root. By u it
/// changes as 1/cosh^2 over the square of the denominator, with h^2 z the
/// square of the tangent.
#[inline(always)]
pub(super) fn speed<K: Kind>(
    rates: [&Real<K>; 2],
    u: Real<K>,
    t: Real<K>,
) -> Real<K> {
    let [a, c, u0, t0, z] = numbers(rates, u, t);
    let (h, h_z) = sloped(tanhc, z);
    let g = h * t0;
    let below = c * u0 * g + 1.0;
    let v = (a * g + u0) / below;
    let over = 1.0 / below;
    // g by a c, and (g a) by a.
    let steeper = h_z * t0 * t0 * t0;
    let both = g + a * c * steeper;
    Real::combine(
        v,
        [
            (rates[0], (both - v * c * c * u0 * steeper) * over),
            (rates[1], (a * a * steeper - v * u0 * both) * over),
            (&u, (1.0 - z * h * h) * over * over),
            (&t, a - c * v * v),
        ],
    )
}

/// The distance after time `t`. With S = sinh(r t)/(r t) and C =
/// (cosh(r t) - 1)/(r t)^2 of z = (r t)^2 = a c t^2,
///
/// p = (u S + a t C) t,  y = 1 + c p,  s = ln(y)/c,
///
/// so that it changes with a and u as p does over y, with c by p^2 h'(c p) more,
/// h(x) = ln(1 + x)/x, and with t by the speed, (u (1 + z C) + a t S)/y.
#[inline(always)]
pub(super) fn distance<K: Kind>(
    rates: [&Real<K>; 2],
    u: Real<K>,
    t: Real<K>,
) -> Real<K> {
    let [a, c, u0, t0, z] = numbers(rates, u, t);
    let (sine, sine_z) = sloped(sinhc, z);
    let (rise, rise_z) = sloped(coshc, z);
    let p = (u0 * sine + a * t0 * rise) * t0;
    let (log, log_p) = sloped(lnc, c * p);
    let over = 1.0 / (1.0 + c * p);
    // By z, and z by a and by c.
    let p_z = (u0 * sine_z + a * t0 * rise_z) * t0;
    let p_a = t0 * t0 * rise + p_z * c * t0 * t0;
    let p_c = p_z * a * t0 * t0;
    Real::combine(
        p * log,
        [
            (rates[0], p_a * over),
            (rates[1], p_c * over + p * p * log_p),
            (&u, t0 * sine * over),
            (&t, (u0 * (1.0 + z * rise) + a * t0 * sine) * over),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    type D = Real<Grad<4>>;

    /// The slopes along four numbers against differences of fourth order.
    fn slopes_hold(name: &str, f: impl Fn([D; 4]) -> D, at: [f64; 4]) {
        let h = 1e-4;
        let here: [D; 4] = std::array::from_fn(|i| D::variable(at[i], i));
        let found = f(here);
        for i in 0..4 {
            let value = |by: f64| {
                let mut there = at;
                there[i] += by;
                f(there.map(D::new)).value()
            };
            let difference = (8.0 * (value(h) - value(-h))
                - (value(2.0 * h) - value(-2.0 * h)))
                / (12.0 * h);
            // Round-off of a value over h.
            let tolerated = 1e-10 * (1.0 + found.value().abs());
            let off = found.partial(i) - difference;
            assert!(off.abs() < tolerated, "{name} {at:?} {i}: {off:e}");
        }
    }

    /// Forces that push and brake, with drag and without, and that grows.
    const FORCES: [[f64; 2]; 7] = [
        [2.0, 0.01],
        [-1.5, 0.02],
        [0.4, 0.0],
        [-0.3, -0.004],
        [3.0, -0.01],
        [0.0, 0.05],
        [6.0, 0.2],
    ];

    #[test]
    fn slopes_are_the_differences() {
        for [a, c] in FORCES {
            // None so slow, and so long, that the mass rests.
            for [u, t] in [[3.0, 0.2], [12.0, 0.8], [2.0, 1.1]] {
                let at = [a, c, u, t];
                let covered = |x: [D; 4]| distance([&x[0], &x[1]], x[2], x[3]);
                slopes_hold("distance", covered, at);
                let alone = |x: [D; 4]| speed([&x[0], &x[1]], x[2], x[3]);
                slopes_hold("speed", alone, at);
                let crossed = |x: [D; 4]| {
                    let pace = Pace::new(x[2]);
                    cross([&x[0], &x[1]], &pace, x[3]).expect("it is crossed")
                };
                slopes_hold("arrival", |x| crossed(x).0.u, at);
                slopes_hold("after", |x| crossed(x).1, at);
            }
        }
    }

    #[test]
    fn what_is_passed_is_crossed_in_the_same_time() {
        for [a, c] in FORCES {
            let (rates, pace) = ([a, c].map(D::new), Pace::new(7.0.into()));
            let rates = rates.each_ref();
            let (arrival, after) = cross(rates, &pace, D::new(2.5)).unwrap();
            let covered = distance(rates, pace.u, after);
            assert!((covered - 2.5).value().abs() < 1e-14, "{a} {c}");
            let off = speed(rates, pace.u, after) - arrival.u;
            assert!(off.value().abs() < 1e-14, "{a} {c}");
        }
    }
}
