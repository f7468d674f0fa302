//! The exact solution of du/dt = a - b u - c u^2 on a stretch of slope.
//!
//! A [`Leg`] is a stretch on which a, b and c are constant and u > 0. Where
//! it is left, when, and the state at any time between are closed forms. With
//! w = u^2 and b = 0, dw/ds = 2 (a - c w) gives over a length l
//!
//! w1 = w0 e + a E,  e = exp(-2 c l),  E = (1 - e)/c,
//! travel time = q atanh(sqrt(z))/sqrt(z),  q = E/(u1 + u0 e),  z = a c q^2,
//!
//! good for either sign of a and c and for c = 0. With b the equation is
//! Riccati's in time; its speed is closed, its place closed in logarithms.

use std::f64::consts::PI;

use super::elementary::{atanhc, coshc, expc, lnc, sinhc, tanhc};
use super::quadratic;
pub(super) use super::quadratic::{FAR, Pace};
use crate::scalar::{Kind, Real};

/// The coefficients of du/dt = a - b u - c u^2.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Force<K: Kind> {
    pub(crate) a: Real<K>,
    pub(crate) b: Real<K>,
    pub(crate) c: Real<K>,
}

/// How a leg ends.
#[derive(Debug, Clone, Copy)]
pub(crate) enum End<K: Kind> {
    /// At its far border, with this speed after this time.
    Leaves { arrival: Pace<K>, after: Real<K> },
    /// At rest, after this distance and time.
    Stops { distance: Real<K>, after: Real<K> },
    /// Never: the border is not reached in any time.
    Never,
}

impl<K: Kind> Force<K> {
    /// du/dt at speed `u`.
    #[inline]
    pub(crate) fn acceleration(&self, u: Real<K>) -> Real<K> {
        self.a - self.b * u - self.c * u * u
    }

    /// How a stretch of the given length ends that is entered with speed `u`
    /// (positive, or 0 with a > 0).
    #[inline(always)]
    pub(crate) fn traverse(&self, pace: Pace<K>, length: Real<K>) -> End<K> {
        if self.b.is_constantly_zero() {
            self.traverse_quadratic(pace, length)
        } else {
            self.traverse_riccati(pace.u, length)
        }
    }

    #[inline(always)]
    fn traverse_quadratic(&self, pace: Pace<K>, length: Real<K>) -> End<K> {
        if length.value() == f64::INFINITY {
            return self.endless(pace.u);
        }
        match self.cross(pace, length) {
            Some((arrival, after)) => End::Leaves { arrival, after },
            None => self.end_otherwise(pace, length),
        }
    }

    /// Crosses a finite stretch, b = 0: the arrival at its far border and the
    /// time it takes; `None` where the mass stops on the way, or the stretch
    /// is long (see [`Force::cross_far`]).
    #[inline(always)]
    pub(crate) fn cross(
        &self,
        pace: Pace<K>,
        length: Real<K>,
    ) -> Option<(Pace<K>, Real<K>)> {
        quadratic::cross([&self.a, &self.c], &pace, length)
    }

    #[inline(never)]
    fn end_otherwise(&self, pace: Pace<K>, length: Real<K>) -> End<K> {
        if (self.c * length).value().abs() > 0.5 * FAR
            && let Some((arrival, after)) = self.cross_far(pace, length)
        {
            return End::Leaves { arrival, after };
        }
        // Without a brake it is only too slow for a number.
        if self.a >= 0.0 { End::Never } else { self.stop(pace.u) }
    }

    /// The same over so long a stretch that the speed forgets its beginning:
    /// e from its own exponential, since 1 - c E has lost its digits, and the
    /// time as (c l + ln((v + u1)/(v + u0)))/(c v), v = sqrt(a/c) the terminal
    /// speed, where z is too near 1 for atanh.
    fn cross_far(
        &self,
        pace: Pace<K>,
        length: Real<K>,
    ) -> Option<(Pace<K>, Real<K>)> {
        let (a, c) = (self.a, self.c);
        let x = c * length;
        let decay = (-2.0 * x).exp();
        let spread = (1.0 - decay) / c;
        let w = pace.w * decay + a * spread;
        // Where c is negative both terms may be infinite: a mass that stops.
        if w.value() <= 0.0 || w.value().is_nan() {
            return None;
        }
        let u = w.sqrt();
        let q = spread / (u + pace.u * decay);
        let z = a * c * q * q;
        let after = if z > 0.5 {
            let v = (a / c).sqrt();
            (x + ((v + u) / (v + pace.u)).ln()) / (c * v)
        } else {
            q * atanhc(z)
        };
        Some((Pace { u, w }, after))
    }

    /// On a slope without end the mass stops or goes on for ever.
    #[cold]
    fn endless(&self, u: Real<K>) -> End<K> {
        let runs_away = self.c < 0.0 && (self.a + self.c.abs() * u * u) >= 0.0;
        if self.a < 0.0 && !runs_away { self.stop(u) } else { End::Never }
    }

    /// The stop of a mass that does stop, b = 0.
    #[inline(never)]
    fn stop(&self, u: Real<K>) -> End<K> {
        let braked = u / -self.a;
        let y = self.c * u * braked;
        End::Stops {
            distance: 0.5 * u * braked * lnc(y),
            after: braked * atanhc(-y),
        }
    }

    /// The time after which the speed is `target`, b = 0 or not; not finite
    /// or negative where it never is.
    pub(crate) fn time_to_speed(
        &self,
        u: Real<K>,
        target: Real<K>,
    ) -> Real<K> {
        let mean = 0.5 * (u + target);
        let rate = self.a - self.b * mean - self.c * u * target;
        let t = (target - u) / rate;
        let discriminant = self.discriminant();
        let after = t * atanhc(discriminant * t * t);
        if after < 0.0 && discriminant < 0.0 {
            // More than a quarter turn: the next branch of the arc tangent.
            return after + PI / (-discriminant).sqrt();
        }
        after
    }

    /// b^2/4 + a c, the squared rate of approach to the terminal speed.
    #[inline]
    fn discriminant(&self) -> Real<K> {
        self.a * self.c + 0.25 * self.b * self.b
    }

    /// The speed after time `t` on the leg.
    #[inline]
    pub(crate) fn speed_after(&self, u: Real<K>, t: Real<K>) -> Real<K> {
        if self.b.is_constantly_zero() {
            return quadratic::speed([&self.a, &self.c], u, t);
        }
        let g = tanhc(self.discriminant() * t * t) * t;
        let half = 0.5 * self.b;
        ((self.a - half * u) * g + u) / ((self.c * u + half) * g + 1.0)
    }

    /// The distance covered after time `t` on the leg.
    pub(crate) fn distance_after(&self, u: Real<K>, t: Real<K>) -> Real<K> {
        let rate = self.discriminant().value().abs().sqrt();
        if !self.b.is_constantly_zero() {
            self.distance_riccati(u, t)
        } else if rate * t.value() > 20.0 {
            // y = cosh(r t) + c u sinh(r t)/r overflows; its log does not.
            let r = self.discriminant().sqrt();
            ln_of_growth(r * t, self.c * u / r) / self.c
        } else {
            quadratic::distance([&self.a, &self.c], u, t)
        }
    }

    /// The distance with b: ln(y)/c - b t/(2 c), y = cosh(r t) + (c u + b/2)
    /// sinh(r t)/r. Where c is too small for that difference, the integral of
    /// the closed-form speed by Gauss's rule, exact to round-off.
    fn distance_riccati(&self, u: Real<K>, t: Real<K>) -> Real<K> {
        let (a, b, c) = (self.a, self.b, self.c);
        if c.is_constantly_zero() {
            let x = b * t;
            return (u * expc(x) + a * t * ramp(x)) * t;
        }
        if c.value().abs() < 1e-5 {
            return self.distance_by_quadrature(u, t);
        }
        let z = self.discriminant() * t * t;
        let k = (c * u + 0.5 * b) * t;
        let ln_y = if z > 400.0 {
            let r = z.sqrt();
            ln_of_growth(r, k / r)
        } else {
            (sinhc(z) * k + coshc(z) * z).ln_1p()
        };
        (ln_y - 0.5 * b * t) / c
    }

    fn distance_by_quadrature(&self, u: Real<K>, t: Real<K>) -> Real<K> {
        let rate = self.discriminant().value().abs().sqrt();
        let panels = (rate * t.value()).ceil().clamp(1.0, 1e4);
        let width = t / panels;
        let mut sum = Real::new(0.0);
        for panel in 0..panels as usize {
            for (node, weight) in GAUSS {
                for node in [node, -node] {
                    let at = width * (panel as f64 + 0.5 + 0.5 * node);
                    sum += self.speed_after(u, at) * weight;
                }
            }
        }
        sum * width * 0.5
    }

    #[inline(never)]
    fn traverse_riccati(&self, u: Real<K>, length: Real<K>) -> End<K> {
        let stop = self.stop_riccati(u);
        if let Some(End::Stops { distance, .. }) = stop
            && distance <= length
        {
            return stop.unwrap_or(End::Never);
        }
        if length.value() == f64::INFINITY {
            return End::Never;
        }
        let within = match stop {
            Some(End::Stops { after, .. }) => after.value(),
            _ => f64::INFINITY,
        };
        let Some(t) = self.time_to_place(u, length.value(), within) else {
            return End::Never;
        };
        // One Newton step in full arithmetic carries the derivatives.
        let t = Real::new(t);
        let miss = self.distance_after(u, t) - length;
        let after = t - miss / self.speed_after(u, t).value();
        let arrival = Pace::new(self.speed_after(u, after));
        End::Leaves { arrival, after }
    }

    fn stop_riccati(&self, u: Real<K>) -> Option<End<K>> {
        if self.a >= 0.0 {
            return None;
        }
        let after = self.time_to_speed(u, Real::new(0.0));
        (after.value().is_finite() && after >= 0.0).then(|| End::Stops {
            distance: self.distance_after(u, after),
            after,
        })
    }

    /// How long a stretch lasts that is left to its far border, or ends at
    /// rest: about, where the mass is far from both.
    #[inline(always)]
    pub(crate) fn lasts_about(
        &self,
        pace: &Pace<K>,
        length: Real<K>,
    ) -> Real<K> {
        let push = self.acceleration(pace.u);
        let w = pace.w + push * length * 2.0;
        if w.value() > 0.0 && w.value().is_finite() {
            return length * 2.0 / (pace.u + w.sqrt());
        }
        self.lasts(*pace, length)
    }

    #[inline(never)]
    fn lasts(&self, pace: Pace<K>, length: Real<K>) -> Real<K> {
        match self.traverse(pace, length) {
            End::Leaves { after, .. } | End::Stops { after, .. } => after,
            End::Never => Real::new(f64::INFINITY),
        }
    }

    /// About how long `length` takes, from the force at its beginning.
    fn guess_time(&self, u: Real<K>, length: f64) -> f64 {
        let w = u * u;
        let gain = self.acceleration(u) * (2.0 * length);
        let arrival = (w + gain).max(w * 0.25).sqrt();
        (2.0 * length / (u + arrival)).value()
    }

    /// The time to cover `length`, by Newton's method kept in its bracket.
    fn time_to_place(
        &self,
        u: Real<K>,
        length: f64,
        within: f64,
    ) -> Option<f64> {
        let plain = Force::<crate::scalar::Plain> {
            a: self.a.value().into(),
            b: self.b.value().into(),
            c: self.c.value().into(),
        };
        let u = Real::new(u.value());
        let place = |t: f64| plain.distance_after(u, t.into()).value();
        let guess = plain.guess_time(u, length).min(0.5 * within);
        let (mut low, mut high) = match within {
            f64::INFINITY => beyond(guess, |t| place(t) < length)?,
            within => (0.0, within),
        };
        let mut t = if within.is_finite() { guess } else { high };
        for _ in 0..100 {
            let miss = place(t) - length;
            // Beyond a speed without bound the place is not a number.
            if miss <= 0.0 {
                low = t
            } else {
                high = t
            }
            let speed = plain.speed_after(u, t.into()).value();
            let newton = t - miss / speed;
            // The caller takes one more step.
            if (newton - t).abs() <= 1e-12 * t {
                return Some(newton);
            }
            t = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
        }
        Some(t)
    }
}

/// A time that is not before what is looked for, by doubling a first one, and
/// the last one before it; `None` where there is none. The first may be 0,
/// where a force is too large for a number.
fn beyond(first: f64, is_before: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    let (mut low, mut high) = (0.0, first.max(f64::MIN_POSITIVE));
    while is_before(high) {
        low = high;
        high *= 2.0;
        if high > 1e9 {
            return None;
        }
    }
    Some((low, high))
}

/// ln(cosh(x) + k sinh(x)) for large x.
fn ln_of_growth<K: Kind>(x: Real<K>, k: Real<K>) -> Real<K> {
    x + (((1.0 + k) + (1.0 - k) * (-2.0 * x).exp()) * 0.5).ln()
}

/// (x - 1 + exp(-x))/x^2: the ramp of a mass pulled from rest.
fn ramp<K: Kind>(x: Real<K>) -> Real<K> {
    if x.value().abs() > 0.1 {
        return (1.0 - expc(x)) / x;
    }
    let mut term = Real::new(0.5);
    let mut sum = term;
    for n in 3..14 {
        term = term * x / -f64::from(n);
        sum += term;
    }
    sum
}

/// Nodes and weights of the 16-point Gauss-Legendre rule (one half; the rule
/// is symmetric), Abramowitz & Stegun table 25.4.
const GAUSS: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_73),
    (0.755_404_408_355_003, 0.124_628_971_255_533_87),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_78),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_89),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_095),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_bracketed_from_any_first_one() {
        for first in [0.0, 1e-300, 0.7, 5.0] {
            let (low, high) = beyond(first, |t| t < 3.0).unwrap();
            assert!(low < 3.0 && high >= 3.0, "{first}: {low} to {high}");
        }
        assert_eq!(beyond(0.0, |_| true), None);
    }
}
