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

use super::eight::{EIGHT, Eight};
use super::exact::{Force, Pace};
use crate::scalar::{Kind, Real};

/// What eight crossings were worked out from.
pub(super) struct Solved {
    pub(super) length: Eight,
    pub(super) a: Eight,
    pub(super) c: f64,
    /// E and its derivative by c, and e.
    pub(super) spread: Eight,
    pub(super) spread_c: Eight,
    pub(super) decay: Eight,
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
    pub(super) fn set(&mut self, of: &Solved) {
        let c = of.c;
        for i in 0..EIGHT {
            let (a, q, decay) = (of.a[i], of.q[i], of.decay[i]);
            let lost = 2.0 * of.length[i] * decay;
            let part = q / (of.spread[i] * (1.0 - of.z[i]));
            let swift = q * q * q * of.bent[i];
            self.w_w[i] = decay;
            self.w_a[i] = of.spread[i];
            self.w_c[i] = a * of.spread_c[i] - lost * of.entered[i];
            self.u_w[i] = 0.5 / of.speeds[i + 1];
            self.t_w[i] = -q * part * self.u_w[i];
            self.t_u[i] = -q * part * decay;
            self.t_a[i] = swift * c;
            self.t_c[i] =
                part * (of.spread_c[i] + q * of.speeds[i] * lost) + swift * a;
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
