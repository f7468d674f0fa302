//! How the crossings of eight pieces change with what they depend on.
//!
//! By the chain rule on w1 = w0 e + a E and T = q h(z), h(z) = atanh(sqrt z)
//! / sqrt z (see `exact`): with e' = -2 l e and E' by c, and since q h(a c
//! q^2) changes with q as 1/(1 - z) and with a c as q^3 h'(z),
//!
//! dw1 = e dw0 + E da + (a E' - 2 l e w0) dc,
//! dT = dq/(1 - z) + q^3 h' (c da + a dc),
//! dq = (E' dc - q (du1 + e du0 - 2 l e u0 dc))/(u1 + u0 e).

#![allow(
    clippy::needless_range_loop,
    reason = "loops over an index become vectors, chains of iterators do not"
)]

use super::eight::{EIGHT, Eight, expc};
use super::exact::{Force, Pace};
use super::resistance::Even;
use crate::scalar::{Kind, Plain, Real};

/// What eight pieces do to any speed.
pub(super) struct Pieces {
    pub(super) length: Eight,
    /// The force a - c u^2, and 2 c l.
    pub(super) a: Eight,
    pub(super) c: f64,
    pub(super) x: Eight,
    /// E and its derivative by c, and e.
    pub(super) spread: Eight,
    pub(super) spread_c: Eight,
    pub(super) decay: Eight,
}

impl Pieces {
    /// From pull, load and length; `sloped` says whether derivatives are
    /// asked for.
    #[inline(always)]
    pub(super) fn new(
        [pull, load, length]: [Eight; 3],
        even: &Even<Plain>,
        sloped: bool,
    ) -> Self {
        let [along, across, constant, c] =
            [even.along, even.across, even.constant, even.c].map(Real::value);
        let (mut x, mut a) = ([0.0; EIGHT], [0.0; EIGHT]);
        for i in 0..EIGHT {
            x[i] = c * length[i] * 2.0;
            a[i] = along * pull[i] - across * load[i] - constant;
        }
        let (mut spread, mut spread_c) = expc(&x, sloped);
        let mut decay = [0.0; EIGHT];
        for i in 0..EIGHT {
            spread[i] = spread[i] * length[i] * 2.0;
            spread_c[i] = spread_c[i] * length[i] * length[i] * 4.0;
            decay[i] = 1.0 - c * spread[i];
        }
        Self { length, a, c, x, spread, spread_c, decay }
    }
}

/// What eight crossings were worked out from.
pub(super) struct Solved<'a> {
    pub(super) pieces: &'a Pieces,
    /// Squared speeds on entering, and the speeds at all nine borders.
    pub(super) entered: Eight,
    pub(super) speeds: [f64; EIGHT + 1],
    pub(super) q: Eight,
    pub(super) z: Eight,
    /// h'(z).
    pub(super) bent: Eight,
}

/// The partial derivatives of eight crossings.
#[derive(Debug, Default)]
pub(super) struct Slopes {
    /// Of w1 by w0, a and c.
    w_w: Eight,
    w_a: Eight,
    w_c: Eight,
    /// Of u1 by w1.
    u_w: Eight,
    /// Of the travel time by u0, w1, a and c.
    t_u: Eight,
    t_w: Eight,
    t_a: Eight,
    t_c: Eight,
}

impl Slopes {
    #[inline(always)]
    pub(super) fn set(&mut self, of: &Solved<'_>) {
        let Pieces { length, a, c, spread, spread_c, decay, .. } = of.pieces;
        for i in 0..EIGHT {
            let q = of.q[i];
            let lost = 2.0 * length[i] * decay[i];
            let part = q / (spread[i] * (1.0 - of.z[i]));
            let swift = q * q * q * of.bent[i];
            self.w_w[i] = decay[i];
            self.w_a[i] = spread[i];
            self.w_c[i] = a[i] * spread_c[i] - lost * of.entered[i];
            self.u_w[i] = 0.5 / of.speeds[i + 1];
            self.t_w[i] = -q * part * self.u_w[i];
            self.t_u[i] = -q * part * decay[i];
            self.t_a[i] = swift * c;
            self.t_c[i] =
                part * (spread_c[i] + q * of.speeds[i] * lost) + swift * a[i];
        }
    }

    /// One crossing with its derivatives, from its values.
    #[inline(always)]
    pub(super) fn crossing<K: Kind>(
        &self,
        i: usize,
        [u1, w1, after]: [f64; 3],
        pace: &Pace<K>,
        force: &Force<K>,
    ) -> (Pace<K>, Real<K>) {
        let (a, c) = (&force.a, &force.c);
        let w = Real::combine(
            w1,
            [(a, self.w_a[i]), (c, self.w_c[i]), (&pace.w, self.w_w[i])],
        );
        let after = Real::combine(
            after,
            [
                (a, self.t_a[i]),
                (c, self.t_c[i]),
                (&pace.u, self.t_u[i]),
                (&w, self.t_w[i]),
            ],
        );
        (Pace { u: w.chain(u1, self.u_w[i]), w }, after)
    }
}
