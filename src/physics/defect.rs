//! What a force that varies on a leg does beside its mean.
//!
//! On a leg the mass moves in closed form under a mean force a - c u^2. What
//! the force is beyond that at the beginning, in the middle and at the end
//! adds up to nothing by Simpson's rule, e0 + 4 em + e1 = 0. Over x, the part
//! of the leg's time h that is over, the parabola through them is
//!
//! e(x) = k (x - 1/2) + l (x^2 - x + 1/6),  k = e1 - e0,  l = 3 (e0 + e1).
//!
//! Integrated once and twice it is what speed and distance are off,
//!
//! du = h (x^2 - x)(k + l (2 x - 1)/3)/2 - (b + 2 c u) ds,
//! ds = h^2 x^2 (k (2 x - 3) + l (1 - x)^2)/12,
//!
//! where the drag answers to what the speed is off, to first order. At the end
//! of the leg ds = -k h^2/12.

use super::exact::{Force, Pace};
use crate::scalar::{Kind, Real};

/// The parabola of a leg.
#[derive(Debug, Clone, Copy)]
pub(super) struct Defect<K: Kind> {
    slope: Real<K>,
    bow: Real<K>,
    /// b + 2 c u in the middle of the leg [1/s].
    damping: Real<K>,
    /// How long the leg lasts under the mean force [s].
    pub(super) lasts: Real<K>,
}

impl<K: Kind> Defect<K> {
    /// The mean of a force on a leg that lasts so long \[s\], with the drag of
    /// its middle, and the parabola beyond it: from the force at the beginning,
    /// in the middle and at the end, and the speeds there.
    pub(super) fn of(
        [first, middle, last]: [Force<K>; 3],
        [u0, u, u1]: [Real<K>; 3],
        lasts: Real<K>,
    ) -> (Force<K>, Self) {
        let c = middle.c;
        let a0 = first.a + (c - first.c) * u0 * u0;
        let a1 = last.a + (c - last.c) * u1 * u1;
        let a = (a0 + middle.a * 4.0 + a1) * (1.0 / 6.0);
        let (slope, bow) = (a1 - a0, (a0 + a1 - a * 2.0) * 3.0);
        let damping = middle.b + c * u * 2.0;
        (Force { a, ..middle }, Self { slope, bow, damping, lasts })
    }

    /// How much more the force is after a time \[m/s2\].
    pub(super) fn force(&self, after: Real<K>) -> Real<K> {
        let x = after / self.lasts;
        self.slope * (x - 0.5) + self.bow * (x * x - x + 1.0 / 6.0)
    }

    /// How much faster the mass is \[m/s\].
    pub(super) fn speed(&self, after: Real<K>) -> Real<K> {
        let x = after / self.lasts;
        let bent = self.slope + self.bow * (x * 2.0 - 1.0) * (1.0 / 3.0);
        let free = self.lasts * (x * x - x) * bent * 0.5;
        free - self.damping * self.distance(after)
    }

    /// How much farther it is \[m\].
    pub(super) fn distance(&self, after: Real<K>) -> Real<K> {
        let x = after / self.lasts;
        let left = 1.0 - x;
        let bent = self.slope * (x * 2.0 - 3.0) + self.bow * left * left;
        after * after * bent * (1.0 / 12.0)
    }

    /// The arrival at the far border and the time it takes, from those under
    /// the mean force; `None` where the mass stops before it.
    pub(super) fn mended(
        &self,
        force: &Force<K>,
        arrival: Pace<K>,
        after: Real<K>,
    ) -> Option<(Pace<K>, Real<K>)> {
        // How much of the way is left at the same time, less than none where
        // the mass is beyond, and the force on it.
        let left = self.slope * after * after * (1.0 / 12.0);
        let last = self.slope * 0.5 + self.bow * (1.0 / 6.0);
        let push = force.acceleration(arrival.u) + last;
        let w = arrival.w + left * (push + self.damping * arrival.u) * 2.0;
        if w.value() <= 0.0 {
            return None;
        }
        let u = w.sqrt();
        Some((Pace { u, w }, after + left * 2.0 / (arrival.u + u)))
    }
}
