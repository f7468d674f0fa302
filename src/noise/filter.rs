//! The exact filter of a noise that is a sum of parts.
//!
//! The state of all its processes is normal given the values so far (Kalman
//! 1960); the likelihood is that of each value given those before it
//! (prediction error decomposition, Harvey 1989, chapter 3). Cost is linear in
//! the number of values, for any times.

use rand_distr::{Distribution, StandardNormal, StudentT};
use smallvec::SmallVec;

use super::gaussian::Gaussian;
use super::like::noise_like;
use super::part::{Lapse, MOST_STATES, Part, Square, Whole};
use super::student::{Known, Law, log_peak, normal_score};
use super::{Conditional, Grid, Matern32, Noise, Ou, White, one_per_time};
use crate::block::Sum;
use crate::error::Stop;
use crate::prior::LN_SQRT_2PI;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

type Matrix<K, const N: usize> = [[Real<K>; N]; N];

/// What is known of the state of all processes; those beyond theirs are 0.
struct Filter<'w, 'a, K: Kind, const N: usize> {
    whole: &'w Whole<'a, K>,
    /// Which states are the processes' values.
    values: SmallVec<[usize; 4]>,
    mean: [Real<K>; N],
    covariance: Matrix<K, N>,
    /// How the state moves over the last lapse asked for.
    lapse: Option<Lapse>,
    matrix: Matrix<K, N>,
    noise: Matrix<K, N>,
    /// What was expected of the last value, and of all where that no longer
    /// changes, with the variance of their own errors.
    last: Option<Predicted<K, N>>,
    steady: Option<(Predicted<K, N>, Real<K>)>,
    /// Whether the last value was expected so.
    is_steady: bool,
    /// Whether it is seen when nothing changes: a tape has its derivatives
    /// later.
    settles: bool,
}

impl<'w, 'a, K: Kind, const N: usize> Filter<'w, 'a, K, N> {
    /// Before any value.
    fn new(whole: &'w Whole<'a, K>) -> Self {
        let zero = Real::new(0.0);
        let mut values = SmallVec::new();
        let mut covariance = [[zero; N]; N];
        let mut first = 0;
        for memory in whole.memories() {
            let states = memory.states();
            place(&mut covariance, first, states, &memory.covariance());
            values.push(first);
            first += states;
        }
        let (matrix, noise) = ([[zero; N]; N], [[zero; N]; N]);
        let (mean, lapse) = ([zero; N], None);
        let settles = K::DIRECTIONS > 0 || !K::DIFFERENTIATES;
        Self {
            whole,
            values,
            mean,
            covariance,
            lapse,
            matrix,
            noise,
            last: None,
            steady: None,
            is_steady: false,
            settles,
        }
    }

    /// Lets the time before a value pass: x moves to F x, its covariance P to
    /// F P F' + Q.
    #[expect(clippy::needless_range_loop, reason = "two entries at once")]
    #[inline]
    fn advance(&mut self, lapse: Lapse) {
        if lapse.steps == 0.0 || self.values.is_empty() {
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
        for (memory, &first) in self.whole.memories().zip(&self.values) {
            let over = memory.over(lapse);
            let states = memory.states();
            place(&mut self.matrix, first, states, &over.matrix);
            place(&mut self.noise, first, states, &over.noise);
        }
        self.lapse = Some(lapse);
    }

    /// What the next value is expected to be, and its variance with that of
    /// errors of its own; and how the state goes with it.
    #[inline]
    fn predict(&self, own: Real<K>) -> Predicted<K, N> {
        let mut across = [Real::new(0.0); N];
        for (sum, row) in across.iter_mut().zip(&self.covariance) {
            *sum = self.values.iter().map(|&v| row[v]).sum();
        }
        let each = || self.values.iter();
        let mean = each().map(|&v| self.mean[v]).sum();
        let variance = each().map(|&v| across[v]).sum::<Real<K>>() + own;
        Predicted { mean, variance, across }
    }

    /// Lets the time before a value pass that has errors of such a variance of
    /// its own, and says what is expected of it.
    ///
    /// At even times what is known of the state soon neither grows nor falls
    /// from value to value (the filter is steady, Harvey 1989, section 3.3);
    /// then only its mean goes on.
    #[inline]
    fn next(&mut self, lapse: Lapse, own: Real<K>) -> Predicted<K, N> {
        if let Some((steady, of)) = self.steady
            && of.value() == own.value()
            && self.lapse == Some(lapse)
        {
            self.is_steady = true;
            self.mean = times(&self.matrix, &self.mean);
            let mean = self.values.iter().map(|&v| self.mean[v]).sum();
            return Predicted { mean, ..steady };
        }
        self.is_steady = false;
        let again = self.lapse == Some(lapse);
        self.advance(lapse);
        let predicted = self.predict(own);
        self.steady = None;
        let same = |last: &Predicted<K, N>| predicted.is_as_sure_as(last);
        if again && self.settles && self.last.is_some_and(|last| same(&last)) {
            self.steady = Some((predicted, own));
        }
        self.last = Some(predicted);
        predicted
    }

    /// Takes a value in that differs so much from the prediction.
    #[expect(clippy::needless_range_loop, reason = "two entries at once")]
    #[inline]
    fn learn(
        &mut self,
        predicted: &Predicted<K, N>,
        error: Real<K>,
        precision: Real<K>,
    ) {
        let across = &predicted.across;
        if self.is_steady {
            for i in 0..N {
                self.mean[i] += across[i] * precision * error;
            }
            return;
        }
        for i in 0..N {
            let gain = across[i] * precision;
            self.mean[i] += gain * error;
            for j in 0..=i {
                let less = self.covariance[i][j] - gain * across[j];
                self.covariance[i][j] = less;
                self.covariance[j][i] = less;
            }
        }
    }
}

/// What a filter expects of a value.
#[derive(Clone, Copy)]
struct Predicted<K: Kind, const N: usize> {
    mean: Real<K>,
    variance: Real<K>,
    /// The covariance of the state with it.
    across: [Real<K>; N],
}

/// A share of a variance that is round-off.
const ROUND_OFF: f64 = 1e-14;

impl<K: Kind, const N: usize> Predicted<K, N> {
    /// Whether the state is known as well as it was before another value.
    #[inline]
    fn is_as_sure_as(&self, last: &Self) -> bool {
        self.variance.is_near(last.variance, ROUND_OFF)
            && self
                .across
                .iter()
                .zip(&last.across)
                .all(|(a, b)| a.is_near(*b, ROUND_OFF))
    }
}

/// F x.
#[inline]
fn times<K: Kind, const N: usize>(
    matrix: &Matrix<K, N>,
    x: &[Real<K>; N],
) -> [Real<K>; N] {
    std::array::from_fn(|i| dot(&matrix[i], x))
}

#[inline]
fn dot<K: Kind, const N: usize>(
    x: &[Real<K>; N],
    y: &[Real<K>; N],
) -> Real<K> {
    x.iter().zip(y).map(|(&x, &y)| x * y).sum()
}

/// Puts a block on the diagonal.
fn place<K: Kind, const N: usize>(
    matrix: &mut Matrix<K, N>,
    first: usize,
    states: usize,
    block: &Square<K>,
) {
    for (i, row) in block.chunks_exact(states.max(1)).enumerate() {
        matrix[first + i][first..first + states].copy_from_slice(row);
    }
}

/// Residuals to be looked at, or none yet: to be drawn.
enum Residuals<'r, K: Kind> {
    Seen(&'r [Real<K>]),
    Drawn(&'r mut Rng, &'r mut Vec<f64>),
}

/// The prediction error of a value over its size.
struct Innovation<K: Kind> {
    error: Real<K>,
    /// Its variance, and one over that.
    variance: Real<K>,
    precision: Real<K>,
    /// The logarithm of the value's size.
    log_size: Option<Real<K>>,
}

impl<K: Kind> Innovation<K> {
    /// The same value's law with what its size takes off the density.
    fn sized(&self, mut value: Conditional<K>) -> Conditional<K> {
        if let Some(log_size) = self.log_size {
            value.log_density -= log_size;
            value.informing.size += log_size;
        }
        value
    }
}

/// The sum of logarithms, by that of the product as far as a number holds it.
struct LogSum<K: Kind> {
    sum: Real<K>,
    product: Real<K>,
}

impl<K: Kind> LogSum<K> {
    fn new() -> Self {
        Self { sum: Real::new(0.0), product: Real::new(1.0) }
    }

    #[inline(always)]
    fn add(&mut self, x: Real<K>) {
        // Of either as far from 1 as this the product is a number.
        const FAR: f64 = 1e140;
        let far = |x: Real<K>| !(1.0 / FAR..=FAR).contains(&x.value());
        if far(x) || far(self.product) {
            self.sum += self.product.ln();
            self.product = Real::new(1.0);
        }
        self.product *= x;
    }

    fn total(self) -> Real<K> {
        self.sum + self.product.ln()
    }
}

impl<K: Kind> Whole<'_, K> {
    /// Visits each value's prediction error.
    fn each(
        &self,
        at: &Grid,
        residuals: Residuals<'_, K>,
        visit: impl FnMut(&Innovation<K>),
    ) -> Result<(), Stop> {
        self.admit(at)?;
        match self.states() {
            0..=1 => self.filtered::<1>(at, residuals, visit),
            2 => self.filtered::<2>(at, residuals, visit),
            3 => self.filtered::<3>(at, residuals, visit),
            4..=6 => self.filtered::<6>(at, residuals, visit),
            _ => self.filtered::<MOST_STATES>(at, residuals, visit),
        }
    }

    fn filtered<const N: usize>(
        &self,
        at: &Grid,
        mut residuals: Residuals<'_, K>,
        mut visit: impl FnMut(&Innovation<K>),
    ) -> Result<(), Stop> {
        let errors = at.standard_errors();
        let white = self.white();
        let mut filter = Filter::<K, N>::new(self);
        for i in 0..at.len() {
            let log_size = self.log_size(at, i);
            let over = log_size.map(|log| (-log).exp());
            let known = errors.map_or(0.0, |s| s[i] * s[i]);
            let own = match over {
                Some(over) => white + over * over * known,
                None => white + known,
            };
            let predicted = filter.next(Lapse::before(at, i), own);
            let variance = predicted.variance;
            if variance <= 0.0 || variance.value().is_nan() {
                return Err(Stop::Reject("a value has no error of its own"));
            }
            let error = match &mut residuals {
                Residuals::Seen(all) => {
                    over.map_or(all[i], |over| all[i] * over) - predicted.mean
                }
                Residuals::Drawn(rng, drawn) => {
                    let error = variance.value().sqrt() * self.deviate(rng)?;
                    let size = log_size.map_or(1.0, |log| log.value().exp());
                    drawn.push((predicted.mean.value() + error) * size);
                    Real::new(error)
                }
            };
            let precision = 1.0 / variance;
            visit(&Innovation { error, variance, precision, log_size });
            filter.learn(&predicted, error, precision);
        }
        Ok(())
    }

    /// A draw of unit scale with the tails there are.
    fn deviate(&self, rng: &mut Rng) -> Result<f64, Stop> {
        let Some(nu) = self.tails() else {
            return Ok(StandardNormal.sample(rng));
        };
        let nu = nu.value();
        let law = StudentT::new(nu)
            .map_err(|_| Stop::Reject("nu is not positive"))?;
        Ok(law.sample(rng))
    }
}

impl<K: Kind> Noise<K> for Whole<'_, K> {
    fn check(&self, at: &Grid) -> crate::Result<()> {
        self.check(at)
    }

    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        one_per_time(at, residuals)?;
        let seen = Residuals::Seen(residuals);
        let Some(nu) = self.tails() else {
            return self.each(at, seen, |next| {
                let law = Gaussian::new(next.variance);
                visit(next.sized(law.at(next.error)));
            });
        };
        let (peak, known) = (log_peak(nu), Known::of(nu.value()));
        self.each(at, seen, |next| {
            let law = Law::new(nu, peak, next.variance);
            visit(law.at(next.error, next.log_size, &known));
        })
    }

    fn log_likelihood(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
    ) -> Result<Real<K>, Stop> {
        one_per_time(at, residuals)?;
        let mut total = Real::new(0.0);
        let (mut squares, mut logs) = (total, LogSum::new());
        // One plus each square over nu, where there are tails.
        let mut tails = LogSum::new();
        let over = self.tails().map(|nu| 1.0 / nu);
        self.each(at, Residuals::Seen(residuals), |next| {
            let square = next.error * next.error * next.precision;
            match over {
                None => squares += square,
                Some(over) => tails.add(square * over + 1.0),
            }
            logs.add(next.variance);
            if let Some(log_size) = next.log_size {
                total -= log_size;
            }
        })?;
        total -= 0.5 * logs.total();
        let n = at.len() as f64;
        Ok(match self.tails() {
            None => total - 0.5 * squares - LN_SQRT_2PI * n,
            Some(nu) => {
                total - 0.5 * (nu + 1.0) * tails.total() + log_peak(nu) * n
            }
        })
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        let mut drawn = Vec::with_capacity(at.len());
        self.each(at, Residuals::Drawn(rng, &mut drawn), |_| {})?;
        Ok(drawn)
    }

    fn standardise(&self, deviate: f64) -> f64 {
        match self.tails() {
            None => deviate,
            Some(nu) => normal_score(deviate, nu.value()),
        }
    }
}

// A block, or a sum of blocks, is the noise that its parts say.
noise_like!(impl[] White<Real<K>>, self => Whole::<K>::of(self));
noise_like!(impl[] Ou<Real<K>>, self => Whole::<K>::of(self));
noise_like!(impl[] Matern32<Real<K>>, self => Whole::<K>::of(self));
noise_like! {
    impl[A: Part<K>, B: Part<K>] Sum<A, B>, self => Whole::<K>::of(self)
}
