//! The filter at any times: the state's mean and covariance given the values
//! so far (Kalman 1960).

use super::state::{
    Expected, Follows, Matrix, Values, are_same, blocks, dot, place, settles,
    stationary, sum, times, values,
};
use crate::noise::part::{Lapse, Whole};
use crate::scalar::{Kind, Real};

/// What is known of the state of all processes; those beyond theirs are 0.
pub(super) struct Kalman<'w, 'a, K: Kind, const N: usize> {
    whole: &'w Whole<'a, K>,
    values: Values<N>,
    mean: [Real<K>; N],
    covariance: Matrix<K, N>,
    /// How the state moves over the last lapse asked for.
    lapse: Option<Lapse>,
    matrix: Matrix<K, N>,
    noise: Matrix<K, N>,
    /// How well the last value was known beforehand.
    last: Option<Foreseen<K, N>>,
    /// The variance of the last value's own errors, where nothing changes any
    /// more from value to value as long as that stays.
    steady: Option<Real<K>>,
    /// Whether the last value was one of those.
    is_steady: bool,
}

/// How well a value is known beforehand.
#[derive(Clone, Copy)]
struct Foreseen<K: Kind, const N: usize> {
    variance: Real<K>,
    /// The covariance of the state with it.
    across: [Real<K>; N],
}

impl<K: Kind, const N: usize> Foreseen<K, N> {
    #[inline]
    fn is_same(&self, other: &Self) -> bool {
        let mut pairs = self.across.iter().zip(&other.across);
        are_same(self.variance, other.variance)
            && pairs.all(|(&a, &b)| are_same(a, b))
    }
}

impl<'w, 'a, K: Kind, const N: usize> Kalman<'w, 'a, K, N> {
    /// Before any value.
    pub(super) fn new(whole: &'w Whole<'a, K>) -> Self {
        let values = values(whole);
        let zero = [[Real::new(0.0); N]; N];
        Self {
            whole,
            mean: [Real::new(0.0); N],
            covariance: stationary(whole),
            values,
            lapse: None,
            matrix: zero,
            noise: zero,
            last: None,
            steady: None,
            is_steady: false,
        }
    }

    /// Lets the time before a value pass: x moves to F x, its covariance P to
    /// F P F' + Q.
    #[expect(clippy::needless_range_loop, reason = "two entries at once")]
    #[inline]
    fn advance(&mut self, lapse: Lapse) {
        if lapse.steps == 0.0 {
            return;
        }
        if self.lapse != Some(lapse) {
            self.look_up(lapse);
        }
        let f = &self.matrix;
        self.mean = times(f, &self.mean);
        let ahead = f.map(|row| times(&self.covariance, &row));
        for i in 0..N {
            for j in 0..=i {
                let sum = self.noise[i][j] + dot(&f[i], &ahead[j]);
                self.covariance[i][j] = sum;
                self.covariance[j][i] = sum;
            }
        }
    }

    #[cold]
    fn look_up(&mut self, lapse: Lapse) {
        for (first, memory) in blocks(self.whole) {
            let over = memory.over(lapse);
            let states = memory.states();
            place(&mut self.matrix, first, states, &over.matrix);
            place(&mut self.noise, first, states, &over.noise);
        }
        self.lapse = Some(lapse);
    }

    /// How well the next value is known, with errors of such a variance of its
    /// own.
    #[inline]
    fn foreseen(&self, own: Real<K>) -> Foreseen<K, N> {
        let across =
            std::array::from_fn(|i| sum(&self.values, &self.covariance[i]));
        let variance = sum(&self.values, &across) + own;
        Foreseen { variance, across }
    }
}

impl<K: Kind, const N: usize> Follows<K> for Kalman<'_, '_, K, N> {
    /// At even times what is known of the state soon neither grows nor falls
    /// from value to value (the filter is steady, Harvey 1989, section 3.3);
    /// then only its mean goes on.
    #[inline]
    fn expect(&mut self, lapse: Lapse, own: Real<K>) -> Expected<K> {
        let again = self.lapse == Some(lapse);
        if let (true, Some(last), Some(of)) = (again, self.last, self.steady)
            && of.value() == own.value()
        {
            self.is_steady = true;
            self.mean = times(&self.matrix, &self.mean);
            let mean = sum(&self.values, &self.mean);
            return Expected { mean, variance: last.variance, is_same: true };
        }
        self.is_steady = false;
        self.advance(lapse);
        let next = self.foreseen(own);
        let same = |last: Foreseen<K, N>| next.is_same(&last);
        let settled = settles::<K>() && again && self.last.is_some_and(same);
        self.steady = settled.then_some(own);
        self.last = Some(next);
        let mean = sum(&self.values, &self.mean);
        Expected { mean, variance: next.variance, is_same: false }
    }

    #[expect(clippy::needless_range_loop, reason = "two entries at once")]
    #[inline]
    fn learn(&mut self, error: Real<K>, precision: Real<K>) {
        let Some(Foreseen { across, .. }) = self.last else { return };
        let gain = across.map(|across| across * precision);
        for (mean, &gain) in self.mean.iter_mut().zip(&gain) {
            *mean += gain * error;
        }
        if self.is_steady {
            return;
        }
        for i in 0..N {
            for j in 0..=i {
                let less = self.covariance[i][j] - gain[i] * across[j];
                self.covariance[i][j] = less;
                self.covariance[j][i] = less;
            }
        }
    }
}
