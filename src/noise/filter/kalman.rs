//! The filter at any times: the state's mean and covariance given the values
//! so far (Kalman 1960).

use super::state::{
    Follows, Matrix, Motion, Values, are_same, settles, stationary, sum, sure,
    values,
};
use crate::noise::part::{Lapse, Whole};
use crate::scalar::{Kind, Real};

/// What is known of the state of all processes; those beyond theirs are 0.
pub(super) struct Kalman<'w, 'a, K: Kind, const N: usize> {
    whole: &'w Whole<'a, K>,
    values: Values<N>,
    mean: [Real<K>; N],
    covariance: Matrix<K, N>,
    /// How the state moves over the last lapse asked for, F and Q.
    over: Option<(Lapse, Motion<K, N>, Matrix<K, N>)>,
    /// How well the next value is known beforehand.
    next: Foreseen<K, N>,
    /// The covariance of the state with it over its variance.
    gain: [Real<K>; N],
    /// The variance of the last value's own errors, where nothing changes any
    /// more from value to value as long as that stays.
    steady: Option<Real<K>>,
    /// How many values in a row were known as well beforehand as the one before.
    same: usize,
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
        let zero = [Real::new(0.0); N];
        // Of a variance that no value has.
        let nothing = Real::new(f64::NAN);
        Self {
            whole,
            mean: zero,
            covariance: stationary(whole),
            values: values(whole),
            over: None,
            next: Foreseen { variance: nothing, across: zero },
            gain: zero,
            steady: None,
            same: 0,
            is_steady: false,
        }
    }

    /// Lets the time before a value pass: x moves to F x, its covariance P to
    /// F P F' + Q.
    #[inline]
    fn advance(&mut self, lapse: Lapse) {
        if lapse.steps == 0.0 {
            return;
        }
        if self.over.as_ref().is_none_or(|(of, ..)| *of != lapse) {
            let (motion, noise) = Motion::over(self.whole, lapse);
            self.over = Some((lapse, motion, noise));
        }
        let Some((_, motion, noise)) = &self.over else { return };
        self.mean = motion.times(&self.mean);
        // P F', whose columns F moves.
        let ahead = self.covariance.map(|row| motion.times(&row));
        for j in 0..N {
            let column = ahead.map(|row| row[j]);
            for (i, noise) in noise.iter().enumerate().skip(j) {
                let moved = motion.row(i, &column) + noise[j];
                self.covariance[i][j] = moved;
                self.covariance[j][i] = moved;
            }
        }
    }

    /// How well the next value is known, with errors of such a variance of its
    /// own.
    #[inline]
    fn foreseen(&self, own: &Real<K>) -> Foreseen<K, N> {
        let across =
            std::array::from_fn(|i| sum(&self.values, &self.covariance[i]));
        let variance = sum(&self.values, &across) + own;
        Foreseen { variance, across }
    }

    /// What a value tells of the state.
    #[inline]
    fn narrow(&mut self) {
        let Foreseen { variance, across } = self.next;
        let precision = 1.0 / variance;
        self.gain = across.map(|across| across * precision);
        for i in 0..N {
            for (j, &across) in across.iter().enumerate().take(i + 1) {
                let less = self.covariance[i][j] - self.gain[i] * across;
                self.covariance[i][j] = less;
                self.covariance[j][i] = less;
            }
        }
    }
}

impl<K: Kind, const N: usize> Follows<K> for Kalman<'_, '_, K, N> {
    /// At even times what is known of the state soon neither grows nor falls
    /// from value to value (the filter is steady, Harvey 1989, section 3.3);
    /// then only its mean goes on.
    #[inline]
    fn expect(&mut self, lapse: Lapse, own: &Real<K>) -> bool {
        let again = self.over.as_ref().filter(|(of, ..)| *of == lapse);
        if let (Some((_, motion, _)), Some(of)) = (again, self.steady)
            && of.value() == own.value()
        {
            self.is_steady = true;
            self.mean = motion.times(&self.mean);
            return true;
        }
        let again = again.is_some();
        self.is_steady = false;
        self.advance(lapse);
        let next = self.foreseen(own);
        let same = settles::<K>() && again && next.is_same(&self.next);
        self.same = if same { self.same + 1 } else { 0 };
        self.steady = (self.same >= sure(N)).then_some(*own);
        self.next = next;
        false
    }

    #[inline]
    fn mean(&self) -> Real<K> {
        sum(&self.values, &self.mean)
    }

    #[inline]
    fn variance(&self) -> &Real<K> {
        &self.next.variance
    }

    #[inline]
    fn learn(&mut self, error: &Real<K>) {
        if !self.is_steady {
            self.narrow();
        }
        for (mean, gain) in self.mean.iter_mut().zip(&self.gain) {
            mean.add_product(gain, error);
        }
    }
}
