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
use super::exact::{FAR, Pace};
use super::resistance::Even;
use super::track::Columns;
use crate::scalar::{Kind, Plain, Real};

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

impl Ahead {
    /// The arrival at the far border of a piece, and the time it takes;
    /// `None` where its end is not known to be a border, and of numbers with
    /// derivatives. Pieces have to be asked for one after the other, of one
    /// motion under one force.
    #[inline(always)]
    pub(super) fn crossing<K: Kind>(
        &mut self,
        columns: &Columns,
        index: usize,
        pace: &Pace<K>,
        even: &Even<K>,
    ) -> Option<(Pace<K>, Real<K>)> {
        if K::DIRECTIONS > 0 {
            return None;
        }
        let mut at = index.wrapping_sub(self.first);
        if at >= self.whole {
            let entered = (pace.u.value(), pace.w.value());
            self.cross(columns, index, entered, &even.values());
            at = 0;
        }
        let number = |row: &Eight| Real::new(row[at]);
        (at < self.whole.min(EIGHT)).then(|| {
            let pace = Pace { u: number(&self.u), w: number(&self.w) };
            (pace, number(&self.after))
        })
    }

    #[inline(never)]
    fn cross(
        &mut self,
        columns: &Columns,
        first: usize,
        (u, w): (f64, f64),
        even: &Even<Plain>,
    ) {
        (self.first, self.whole) = (first, 0);
        let Some([pull, load, length]) = columns.eight(first) else { return };
        let [along, across, constant, c] =
            [even.along, even.across, even.constant, even.c].map(Real::value);
        let (mut x, mut a) = ([0.0; EIGHT], [0.0; EIGHT]);
        for i in 0..EIGHT {
            x[i] = c * length[i] * 2.0;
            a[i] = along * pull[i] - across * load[i] - constant;
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
