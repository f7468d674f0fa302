//! The filter at even times, of errors that are all of one size.
//!
//! There a stationary process looks the same forwards and backwards, and what
//! a value tells of the next state follows from two vectors instead of the
//! covariance of the state (Lindquist 1974, SIAM Journal on Control 12, 736:
//! the Levinson recursion in state space). With the state's transition F, its
//! stationary covariance P, a value H x with its own error, and S the variance
//! of that value given those before,
//!
//! ```text
//! g = F P H',  b = g                      before the first value
//! c = H b / S                             the reflection coefficient
//! S <- S - c H b
//! g <- g - c F b,  b <- F b - c g
//! ```
//!
//! and the mean moves to F x + g e / S with the prediction error e.

use super::state::{
    Follows, Motion, Values, are_same, settles, stationary, sum, sure, values,
};
use crate::noise::part::{Lapse, Whole};
use crate::scalar::{Kind, Real};

/// What is expected of the next value, and what it will tell.
pub(super) struct Even<K: Kind, const N: usize> {
    values: Values<N>,
    /// F.
    motion: Motion<K, N>,
    mean: [Real<K>; N],
    /// S.
    variance: Real<K>,
    /// g.
    gain: [Real<K>; N],
    /// g / S.
    scaled: [Real<K>; N],
    /// b.
    backward: [Real<K>; N],
    /// How many values in a row told no more than the one before.
    same: usize,
}

impl<K: Kind, const N: usize> Even<K, N> {
    /// Before the first of values that are a lapse apart.
    pub(super) fn new(whole: &Whole<'_, K>, lapse: Lapse) -> Self {
        let values = values(whole);
        let (motion, _) = Motion::over(whole, lapse);
        let covariance = stationary::<K, N>(whole);
        let across = covariance.map(|row| sum(&values, &row));
        let gain = motion.times(&across);
        let variance = sum(&values, &across) + whole.white();
        let (zero, backward, same) = ([Real::new(0.0); N], gain, 0);
        let (mean, scaled) = (zero, zero);
        Self { values, motion, mean, variance, gain, scaled, backward, same }
    }

    /// What a value tells of how well the next will be known.
    #[inline(always)]
    fn reflect(&mut self) {
        let precision = 1.0 / self.variance;
        self.scaled = self.gain.map(|gain| gain * precision);
        let seen = sum(&self.values, &self.backward);
        let reflection = seen * precision;
        let ahead = self.motion.times(&self.backward);
        let variance = self.variance - reflection * seen;
        let mut same = settles::<K>() && are_same(variance, self.variance);
        let pairs = self.gain.iter_mut().zip(&mut self.backward);
        for ((gain, backward), ahead) in pairs.zip(ahead) {
            let next = *gain - reflection * ahead;
            *backward = ahead - reflection * *gain;
            same = same && are_same(next, *gain);
            *gain = next;
        }
        self.variance = variance;
        self.same = if same { self.same + 1 } else { 0 };
    }
}

impl<K: Kind, const N: usize> Follows<K> for Even<K, N> {
    #[inline(always)]
    fn expect(&mut self, _: Lapse, _: &Real<K>) -> bool {
        self.same >= sure(N)
    }

    #[inline(always)]
    fn mean(&self) -> Real<K> {
        sum(&self.values, &self.mean)
    }

    #[inline(always)]
    fn variance(&self) -> &Real<K> {
        &self.variance
    }

    #[inline(always)]
    fn learn(&mut self, error: &Real<K>) {
        if self.same < sure(N) {
            self.reflect();
        }
        let mut mean = self.motion.times(&self.mean);
        for (mean, gain) in mean.iter_mut().zip(&self.scaled) {
            mean.add_product(gain, error);
        }
        self.mean = mean;
    }
}
