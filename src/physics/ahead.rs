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

use std::ops::Range;

use super::eight::{EIGHT, Eight, atanhc};
use super::exact::{FAR, Force, Pace};
use super::resistance::Even;
use super::skim::{Crossing, Entry, skim};
use super::slopes::{Pieces, Slopes, Solved};
use super::track::{Columns, Piece, Track};
use crate::scalar::{Kind, Plain, Real, fused};

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
    /// How they change, for numbers with derivatives.
    slopes: Slopes,
}

impl Ahead {
    /// Crosses whole pieces as `skim` does, under a force that is the same on
    /// each but for its slope; `entry` becomes how the last one was entered.
    /// Pieces have to be asked for one after the other, of one motion.
    ///
    /// The loop that a simulation spends its time in: a function of its own,
    /// so that its state is in registers whoever calls it.
    #[inline(never)]
    pub(super) fn skim<K: Kind>(
        &mut self,
        track: &Track,
        even: &Even<K>,
        entry: &mut Entry<K>,
        last: usize,
        time: f64,
    ) -> Option<Crossing<K>> {
        let pieces = track.pieces();
        while entry.index < last {
            let from = entry.index;
            let known = self.known(track.columns(), last, entry, even);
            let crossing = if known.is_empty() {
                skim_one(pieces, even, entry, time)
            } else {
                self.pass(known, pieces, even, entry, time)
            };
            if crossing.is_some() || entry.index == from {
                return crossing;
            }
        }
        None
    }

    /// Knows no crossing any more: the force has changed.
    pub(super) fn forget(&mut self) {
        self.whole = 0;
    }

    /// Which of the eight are those that come next; none where their end is
    /// not known to be a border.
    #[inline(always)]
    fn known<K: Kind>(
        &mut self,
        columns: &Columns,
        last: usize,
        entry: &Entry<K>,
        even: &Even<K>,
    ) -> Range<usize> {
        let mut at = entry.index.wrapping_sub(self.first);
        if at >= self.whole {
            let pace = &entry.pace;
            let entered = (pace.u.value(), pace.w.value());
            self.cross::<K>(columns, entry.index, entered, &even.values());
            at = 0;
        }
        at..self.whole.min(EIGHT).min(at + last - entry.index)
    }

    /// Crosses pieces that are known.
    #[inline(always)]
    fn pass<K: Kind>(
        &self,
        known: Range<usize>,
        pieces: &[Piece],
        even: &Even<K>,
        entry: &mut Entry<K>,
        time: f64,
    ) -> Option<Crossing<K>> {
        let (from, last) = (entry.index, entry.index + known.len());
        let cross = |piece: &Piece, Entry { index, pace, .. }: &Entry<K>| {
            let force = even.on(piece);
            let at = known.start + index - from;
            (force, Some(self.crossing(at, pace, &force)))
        };
        let (next, crossing) = skim(pieces, *entry, last, time, cross);
        *entry = next;
        crossing
    }

    /// The arrival at the far border of one of the eight, and the time it
    /// takes.
    #[inline(always)]
    fn crossing<K: Kind>(
        &self,
        i: usize,
        pace: &Pace<K>,
        force: &Force<K>,
    ) -> (Pace<K>, Real<K>) {
        let values = [self.u[i], self.w[i], self.after[i]];
        if K::DIFFERENTIATES {
            return self.slopes.crossing(i, values, pace, force);
        }
        let [u, w, after] = values.map(Real::new);
        (Pace { u, w }, after)
    }

    #[inline(never)]
    fn cross<K: Kind>(
        &mut self,
        columns: &Columns,
        first: usize,
        (u, w): (f64, f64),
        even: &Even<Plain>,
    ) {
        (self.first, self.whole) = (first, 0);
        let Some(rows) = columns.eight(first) else { return };
        let pieces = Pieces::new(rows, even, K::DIFFERENTIATES);
        let Pieces { a, c, spread, decay, .. } = &pieces;
        let entered = self.set_squares(w, &pieces);
        let speeds = self.set_speeds(u);
        let (mut q, mut z) = ([0.0; EIGHT], [0.0; EIGHT]);
        for i in 0..EIGHT {
            q[i] = spread[i] / (speeds[i + 1] + speeds[i] * decay[i]);
            z[i] = a[i] * c * q[i] * q[i];
        }
        let (slowed, bent) = atanhc(&z, K::DIFFERENTIATES);
        for i in 0..EIGHT {
            self.after[i] = q[i] * slowed[i];
        }
        self.whole = self.leading(&pieces.x);
        if K::DIFFERENTIATES {
            let pieces = &pieces;
            self.slopes.set(&Solved { pieces, entered, speeds, q, z, bent });
        }
    }

    /// The squared speeds at the far borders; those on entering.
    #[inline(always)]
    fn set_squares(&mut self, w: f64, pieces: &Pieces) -> Eight {
        let mut gain = [0.0; EIGHT];
        for i in 0..EIGHT {
            gain[i] = pieces.a[i] * pieces.spread[i];
        }
        let (mut before, mut entered) = (w, [w; EIGHT]);
        for i in 0..EIGHT {
            entered[i] = before;
            before = fused(before, pieces.decay[i], gain[i]);
            self.w[i] = before;
        }
        entered
    }

    /// The speeds at all nine borders.
    #[inline(always)]
    fn set_speeds(&mut self, u: f64) -> [f64; EIGHT + 1] {
        let mut speeds = [u; EIGHT + 1];
        for i in 0..EIGHT {
            speeds[i + 1] = self.w[i].sqrt();
            self.u[i] = speeds[i + 1];
        }
        speeds
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

/// Crosses one piece that is not among eight.
#[inline(never)]
fn skim_one<K: Kind>(
    pieces: &[Piece],
    even: &Even<K>,
    entry: &mut Entry<K>,
    time: f64,
) -> Option<Crossing<K>> {
    let cross = |piece: &Piece, entry: &Entry<K>| {
        let force = even.on(piece);
        (force, force.cross(entry.pace, Real::new(piece.length)))
    };
    let (next, crossing) = skim(pieces, *entry, entry.index + 1, time, cross);
    *entry = next;
    crossing
}
