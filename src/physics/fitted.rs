//! A law's force over a range of speeds: a polynomial through five values,
//! and the force of the exact family that moves a mass in the same way.
//!
//! With z from -1 to 1 over the range, the polynomial p is the sum of c_k z^k
//! for k from 0 to 4. Beside it stands f = a - c u^2, chosen so that crossing
//! the range takes as long, and leads as far, under either:
//!
//! int (1/p - 1/f) du = int (1/p - 1/f) u du = 0.
//!
//! To first order in what f leaves out, f is p's Legendre projection; the
//! next two orders are closed forms in the relative changes of p.

use super::exact::Force;
use crate::scalar::{Kind, Real};

/// z^2 of the second and the fourth of Lobatto's five nodes.
const INNER: f64 = 3.0 / 7.0;

/// The narrowest range, as a share of its speed: in a narrower one a slope is
/// lost in the round-off of the values.
const NARROW: f64 = 2e-7;

/// From which difference \[m/s2\] between the ends of a narrow range on a law
/// jumps in it.
const JUMP: f64 = 1e-3;

/// A polynomial for a force \[m/s2\] over speeds \[m/s\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Fitted<K: Kind> {
    middle: Real<K>,
    half: Real<K>,
    c: [Real<K>; 5],
}

/// The force of the exact family for a range.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest<K: Kind> {
    pub(super) force: Force<K>,
    /// What it leaves out at the end of the range, as a share of it, and half
    /// the slope of that in the speed.
    further: [Real<K>; 2],
    /// About what is left out of the speed at the range's end \[m/s\].
    pub(super) error: f64,
}

impl<K: Kind> Fitted<K> {
    /// Through the values of `force` over a range, of which the first is
    /// known.
    #[inline(always)]
    pub(super) fn through(
        [from, to]: [Real<K>; 2],
        first: Real<K>,
        force: impl Fn(Real<K>) -> Real<K>,
    ) -> Self {
        let narrow = (to - from).value().abs() < NARROW * from.value();
        let way = NARROW.copysign((to - from).value());
        let to = if narrow { from * (1.0 + way) } else { to };
        let (middle, half) = ((from + to) * 0.5, (to - from) * 0.5);
        let inner = half * INNER.sqrt();
        let [low, centre] = [middle - inner, middle].map(&force);
        let [high, last] = [middle + inner, to].map(&force);
        let even = (first + last) * 0.5 - centre;
        let even_inner = (low + high) * 0.5 - centre;
        let odd = (last - first) * 0.5;
        let odd_inner = (high - low) * (0.5 / INNER.sqrt());
        let c4 = (even - even_inner / INNER) / (1.0 - INNER);
        let c3 = (odd - odd_inner) / (1.0 - INNER);
        Self { middle, half, c: [centre, odd - c3, even - c4, c3, c4] }
    }

    /// The last speed of the range.
    #[inline(always)]
    pub(super) fn to(&self) -> Real<K> {
        self.middle + self.half
    }

    /// Whether it is as narrow as a range may be.
    #[inline(always)]
    pub(super) fn is_narrow(&self) -> bool {
        self.width() <= 2.0 * NARROW * self.middle.value()
    }

    /// Whether the law jumps in a range as narrow as this one.
    #[inline(always)]
    pub(super) fn jumps(&self) -> bool {
        let [_, c1, _, c3, _] = self.c;
        self.is_narrow() && 2.0 * (c1 + c3).value().abs() > JUMP
    }

    /// How wide the range is \[m/s\].
    #[inline(always)]
    pub(super) fn width(&self) -> f64 {
        2.0 * self.half.value().abs()
    }

    /// The same polynomial over another range.
    pub(super) fn over(&self, [from, to]: [Real<K>; 2]) -> Self {
        let (middle, half) = ((from + to) * 0.5, (to - from) * 0.5);
        let shift = (middle - self.middle) / self.half;
        // Horner's scheme, repeated: the Taylor coefficients at `shift`.
        let mut c = self.c;
        for lowest in 0..4 {
            for k in (lowest..4).rev() {
                let higher = c[k + 1];
                c[k] += higher * shift;
            }
        }
        let narrower = half / self.half;
        let mut power = narrower;
        for c in &mut c[1..] {
            *c *= power;
            power *= narrower;
        }
        Self { middle, half, c }
    }

    /// The force that takes a mass through the range in the same time and
    /// over the same distance.
    #[inline(always)]
    pub(super) fn nearest(&self) -> Nearest<K> {
        let Self { middle, half, c: [c0, c1, c2, c3, c4] } = *self;
        // The coefficients of 1, z and z^2 - 1/3.
        let mean = c0 + c2 * (1.0 / 3.0) + c4 * 0.2;
        let slope = c1 + c3 * 0.6;
        let bend = c2 + c4 * (6.0 / 7.0);
        // What f bends by itself: u^2 = middle^2 + 2 middle half z + ..
        let per_slope = 0.5 / middle;
        let own = slope * per_slope * half;
        let rest = bend - own;
        // In a narrow range `rest` is round-off, and the mean may be 0.
        let zero = Real::new(0.0);
        let inverse = if self.is_narrow() { zero } else { 1.0 / mean };
        let [y, p, q] = [slope, own, bend].map(|c| c * inverse);
        let turn = (p * 129.0 - q * 95.0 + 210.0) * y;
        let sum = p + q;
        let shift = (sum + y * y) * 105.0 + p * p * 92.0 - sum * q * 20.0;
        let mean = mean - rest * shift * (4.0 / 4725.0);
        let slope = slope - rest * turn * (4.0 / 1575.0);
        let c = -slope * per_slope / half;
        let a = mean + c * (middle * middle + half * half * (1.0 / 3.0));
        let at_end = inverse / (y + 1.0);
        let share = (rest * (2.0 / 3.0) + c3 * 0.4) * at_end;
        let steep = (rest + c3 * 1.2) * at_end / half;
        Nearest {
            force: Force { a, b: zero, c },
            further: [share, steep],
            error: self.error([c4 * inverse, rest * inverse, y, p, q]),
        }
    }

    /// The polynomial's error, a small part of its last term, and that of the
    /// series, which is of fourth order.
    #[inline(always)]
    fn error(&self, relative: [Real<K>; 5]) -> f64 {
        let [last, rest, y, p, q] = relative.map(|x| x.value().abs());
        let changes = y + p + q;
        let series = 0.1 * rest * changes * changes * changes;
        self.width() * (0.05 * last + series)
    }
}

impl<K: Kind> Nearest<K> {
    /// How much further than the simple force leads the polynomial does, for
    /// a speed that ends somewhat beside the range \[m/s\]: with r = p - f,
    /// the integral of r/f from the range's end to that speed.
    #[inline(always)]
    pub(super) fn further(&self, beside: Real<K>) -> Real<K> {
        (self.further[0] + self.further[1] * beside) * beside
    }
}
