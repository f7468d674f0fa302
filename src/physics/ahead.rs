//! Eight pieces crossed at once, ahead of the motion that asks for them.
//!
//! On the way over a border only the squared speed has to be known piece
//! after piece, w1 = w0 e + a E (see `exact`). What costs time, the spread E
//! before it and the roots and travel times after it, is the same for each
//! piece and is worked out for eight of them as one vector. What comes out
//! is what `Force::cross` gives, to round-off.

#![allow(
    clippy::needless_range_loop,
    reason = "loops over an index become vectors, chains of iterators do not"
)]

use super::eight::{EIGHT, Eight, atanhc, expc};
use super::exact::FAR;
use super::track::Columns;

/// What resists along the whole track: du/dt = pull - mu load - constant
/// - c u^2.
#[derive(Debug, Clone, Copy)]
pub(super) struct Resistance {
    pub(super) mu: f64,
    pub(super) constant: f64,
    pub(super) c: f64,
}

/// The crossings of up to eight pieces that follow each other.
#[derive(Debug, Default)]
pub(super) struct Ahead {
    first: usize,
    /// How many of the pieces are left over their border.
    whole: usize,
    /// Speed [m/s] and its square at the far borders.
    u: Eight,
    w: Eight,
    /// The travel times [s].
    after: Eight,
}

/// Speed, squared speed and travel time of a crossing.
pub(super) type Crossing = (f64, f64, f64);

impl Ahead {
    /// How a piece is crossed that is entered with speed `u` and its square
    /// `w`; `None` where its end is not known to be a border. Pieces have to be
    /// asked for one after the other, of one motion.
    #[inline(always)]
    pub(super) fn crossing(
        &mut self,
        columns: &Columns,
        index: usize,
        (u, w): (f64, f64),
        law: &Resistance,
    ) -> Option<Crossing> {
        let mut at = index.wrapping_sub(self.first);
        if at >= self.whole {
            self.cross(columns, index, (u, w), law);
            at = 0;
        }
        let known = at < self.whole.min(EIGHT);
        known.then(|| (self.u[at], self.w[at], self.after[at]))
    }

    #[inline(never)]
    fn cross(
        &mut self,
        columns: &Columns,
        first: usize,
        (u, w): (f64, f64),
        law: &Resistance,
    ) {
        (self.first, self.whole) = (first, 0);
        let Some([pull, load, length]) = columns.eight(first) else { return };
        let c = law.c;
        let (mut x, mut a) = ([0.0; EIGHT], [0.0; EIGHT]);
        for i in 0..EIGHT {
            x[i] = c * length[i] * 2.0;
            a[i] = pull[i] - law.mu * load[i] - law.constant;
        }
        let mut spread = expc(&x);
        let (mut decay, mut gain) = ([0.0; EIGHT], [0.0; EIGHT]);
        for i in 0..EIGHT {
            spread[i] = spread[i] * length[i] * 2.0;
            decay[i] = 1.0 - c * spread[i];
            gain[i] = a[i] * spread[i];
        }
        let mut before = w;
        for i in 0..EIGHT {
            before = before * decay[i] + gain[i];
            self.w[i] = before;
        }
        // The speeds at all nine borders.
        let mut speeds = [u; EIGHT + 1];
        for i in 0..EIGHT {
            speeds[i + 1] = self.w[i].sqrt();
        }
        let (mut q, mut z) = ([0.0; EIGHT], [0.0; EIGHT]);
        for i in 0..EIGHT {
            q[i] = spread[i] / (speeds[i + 1] + speeds[i] * decay[i]);
            z[i] = a[i] * c * q[i] * q[i];
        }
        let slowed = atanhc(&z);
        for i in 0..EIGHT {
            self.u[i] = speeds[i + 1];
            self.after[i] = q[i] * slowed[i];
        }
        self.whole = self.leading(&x);
    }

    /// How many crossings there are before something else happens.
    #[inline(always)]
    fn leading(&self, x: &Eight) -> usize {
        let mut all = true;
        for i in 0..EIGHT {
            all &= (self.w[i] > 0.0) & (x[i].abs() <= FAR);
            all &= self.after[i] < f64::INFINITY;
        }
        if all { EIGHT } else { self.leading_some(x) }
    }

    /// Beyond a stop nothing is a number.
    #[cold]
    fn leading_some(&self, x: &Eight) -> usize {
        let crossed = |i: &usize| {
            let moves = self.w[*i] > 0.0 && x[*i].abs() <= FAR;
            moves && self.after[*i] < f64::INFINITY
        };
        (0..EIGHT).take_while(crossed).count()
    }
}
