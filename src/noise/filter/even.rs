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
    Expected, Follows, Matrix, Values, are_same, blocks, place, settles,
    stationary, sum, times, values,
};
use crate::noise::part::{Lapse, Whole};
use crate::scalar::{Kind, Real};

/// After how many values in a row that told no more than the one before none
/// will: a single one may do so by chance.
const SURE: usize = 2;

/// What is expected of the next value, and what it will tell.
pub(super) struct Even<K: Kind, const N: usize> {
    values: Values<N>,
    /// F.
    matrix: Matrix<K, N>,
    mean: [Real<K>; N],
    /// S.
    variance: Real<K>,
    /// g.
    gain: [Real<K>; N],
    /// b.
    backward: [Real<K>; N],
    /// How many values in a row told no more than the one before.
    same: usize,
}

impl<K: Kind, const N: usize> Even<K, N> {
    /// Before the first of values that are a lapse apart.
    pub(super) fn new(whole: &Whole<'_, K>, lapse: Lapse) -> Self {
        let values = values(whole);
        let mut matrix = [[Real::new(0.0); N]; N];
        for (first, memory) in blocks(whole) {
            let over = memory.over(lapse).matrix;
            place(&mut matrix, first, memory.states(), &over);
        }
        let covariance = stationary::<K, N>(whole);
        let across = covariance.map(|row| sum(&values, &row));
        let gain = times(&matrix, &across);
        let variance = sum(&values, &across) + whole.white();
        let (mean, backward, same) = ([Real::new(0.0); N], gain, 0);
        Self { values, matrix, mean, variance, gain, backward, same }
    }

    /// What a value tells of how well the next will be known.
    #[expect(clippy::needless_range_loop, reason = "two entries at once")]
    #[inline(always)]
    fn reflect(&mut self, precision: Real<K>) {
        let seen = sum(&self.values, &self.backward);
        let reflection = seen * precision;
        let ahead = times(&self.matrix, &self.backward);
        let variance = self.variance - reflection * seen;
        let mut same = settles::<K>() && are_same(variance, self.variance);
        for i in 0..N {
            let gain = self.gain[i];
            let next = gain - reflection * ahead[i];
            same = same && are_same(next, gain);
            self.gain[i] = next;
            self.backward[i] = ahead[i] - reflection * gain;
        }
        self.variance = variance;
        self.same = if same { self.same + 1 } else { 0 };
    }
}

impl<K: Kind, const N: usize> Follows<K> for Even<K, N> {
    #[inline(always)]
    fn expect(&mut self, _: Lapse, _: Real<K>) -> Expected<K> {
        let mean = sum(&self.values, &self.mean);
        let is_same = self.same >= SURE;
        Expected { mean, variance: self.variance, is_same }
    }

    #[inline(always)]
    fn learn(&mut self, error: Real<K>, precision: Real<K>) {
        let scaled = error * precision;
        self.mean = times(&self.matrix, &self.mean);
        for (mean, &gain) in self.mean.iter_mut().zip(&self.gain) {
            *mean += gain * scaled;
        }
        if self.same < SURE {
            self.reflect(precision);
        }
    }
}
