//! The Kalman filter of an autoregression, in square-root form.
//!
//! The last k values are x = m + S z with z standard normal; S is carried, and
//! never the covariance S S', so that no difference of large variances is
//! formed when phi is near 1 (Kailath, Sayed and Hassibi 2000, chapter 12).
//! S is kept column after column, k numbers each, and has no column for what
//! is known exactly.

use std::ops::Range;

use rand_distr::{Distribution, StandardNormal};

use super::levinson::Predictor;
use crate::block::List;
use crate::noise::gaussian::Gaussian;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Gaps longer than this are crossed by doubling.
const LONG: usize = 32;

/// What is known of the last k values, latest first.
#[derive(Debug, Clone)]
pub(super) struct Filter<K: Kind> {
    coefficients: List<Real<K>>,
    /// The standard deviation of an innovation, in the unit of the recording.
    sd: Real<K>,
    mean: List<Real<K>>,
    factor: Vec<Real<K>>,
}

impl<K: Kind> Filter<K> {
    /// The stationary process of a variance, nothing measured.
    pub(super) fn new(
        phi: &[Real<K>],
        sigma2: Real<K>,
        variance: Real<K>,
    ) -> Self {
        let k = phi.len();
        let mut predictor = Predictor::new(variance);
        let mut factor = vec![Real::new(0.0); k * k];
        for (j, &partial) in phi.iter().enumerate() {
            // Value j, at row k - 1 - j, on each of the j deviates before its
            // own: the rows below it are the values it is predicted from.
            let row = k - 1 - j;
            for column in factor.chunks_exact_mut(k).take(j) {
                column[row] = dot(&predictor.coefficients, &column[row + 1..]);
            }
            factor[j * k + row] = predictor.variance.sqrt();
            predictor.raise(partial);
        }
        Self {
            coefficients: predictor.coefficients,
            sd: sigma2.sqrt(),
            mean: List::from_elem(Real::new(0.0), k),
            factor,
        }
    }

    /// Lets some steps pass.
    pub(super) fn advance(&mut self, steps: usize) {
        if steps > LONG {
            return self.jump(steps);
        }
        let k = self.mean.len();
        for _ in 0..steps {
            shift(&self.coefficients, &mut self.mean);
            for column in self.factor.chunks_exact_mut(k) {
                shift(&self.coefficients, column);
            }
            self.factor.push(self.sd);
            self.factor.extend((1..k).map(|_| Real::new(0.0)));
            // Not at every step: a few columns too many cost less.
            if self.factor.len() > (2 * k + 2) * k {
                compress(&mut self.factor, k);
            }
        }
    }

    /// Many steps in as many doublings as their number has binary digits.
    fn jump(&mut self, steps: usize) {
        let k = self.mean.len();
        let mut leap = Leap::one_step(&self.coefficients, self.sd);
        let mut left = steps;
        loop {
            if left & 1 == 1 {
                leap.matrix_times(&mut self.mean);
                leap.matrix_times(&mut self.factor);
                self.factor.extend_from_slice(&leap.noise);
                compress(&mut self.factor, k);
            }
            left >>= 1;
            if left == 0 {
                return;
            }
            leap.double();
        }
    }

    /// Takes the latest value as measured with a normal error of standard
    /// deviation `error`: returns the law and the value of the difference
    /// from the prediction.
    pub(super) fn measure(
        &mut self,
        value: Real<K>,
        error: f64,
    ) -> (Gaussian<K>, Real<K>) {
        let k = self.mean.len();
        let mut row: List<Real<K>> =
            self.factor.iter().step_by(k).copied().collect();
        let exact = error == 0.0;
        if !exact {
            row.push(Real::new(error));
            self.factor.extend((0..k).map(|_| Real::new(0.0)));
        }
        // After the reflection one column alone is measured; the others stay.
        let law = Gaussian::new(row.iter().map(|&a| a * a).sum());
        let alpha = reflect(&mut self.factor, k, 0..k, &row);
        let difference = value - self.mean[0];
        let scaled = difference / alpha;
        for (m, &s) in self.mean.iter_mut().zip(&self.factor[..k]) {
            *m += s * scaled;
        }
        self.factor.drain(..k);
        if exact {
            self.mean[0] = value;
            let latest = self.factor.iter_mut().step_by(k);
            latest.for_each(|s| *s = Real::new(0.0));
        }
        (law, difference)
    }

    /// Draws the state as far as it is unknown, and returns the latest value.
    pub(super) fn settle(&mut self, rng: &mut Rng) -> f64 {
        let k = self.mean.len();
        for column in self.factor.chunks_exact(k) {
            let z: f64 = StandardNormal.sample(rng);
            for (m, &s) in self.mean.iter_mut().zip(column) {
                *m += s * z;
            }
        }
        self.factor.clear();
        self.mean[0].value()
    }
}

/// Many steps at once: x moves to A x + B z.
#[derive(Debug)]
struct Leap<K: Kind> {
    matrix: Vec<Real<K>>,
    noise: Vec<Real<K>>,
    k: usize,
}

impl<K: Kind> Leap<K> {
    fn one_step(coefficients: &[Real<K>], sd: Real<K>) -> Self {
        let k = coefficients.len();
        let mut matrix = vec![Real::new(0.0); k * k];
        for (j, &c) in coefficients.iter().enumerate() {
            matrix[j * k] = c;
            if j + 1 < k {
                matrix[j * k + j + 1] = Real::new(1.0);
            }
        }
        let mut noise = vec![Real::new(0.0); k];
        noise[0] = sd;
        Self { matrix, noise, k }
    }

    /// Twice as many steps: A^2 and [A B, B].
    fn double(&mut self) {
        let mut later = self.noise.clone();
        self.matrix_times(&mut later);
        self.noise.append(&mut later);
        compress(&mut self.noise, self.k);
        let mut square = self.matrix.clone();
        self.matrix_times(&mut square);
        self.matrix = square;
    }

    /// A x for every column x of `columns`.
    fn matrix_times(&self, columns: &mut [Real<K>]) {
        let mut image = List::from_elem(Real::new(0.0), self.k);
        for column in columns.chunks_exact_mut(self.k) {
            image.fill(Real::new(0.0));
            for (a, &x) in self.matrix.chunks_exact(self.k).zip(&*column) {
                for (y, &a) in image.iter_mut().zip(a) {
                    *y += a * x;
                }
            }
            column.copy_from_slice(&image);
        }
    }
}

fn dot<K: Kind>(x: &[Real<K>], y: &[Real<K>]) -> Real<K> {
    x.iter().zip(y).map(|(&x, &y)| x * y).sum()
}

/// One step of the recursion, values latest first.
fn shift<K: Kind>(coefficients: &[Real<K>], values: &mut [Real<K>]) {
    let next = dot(coefficients, values);
    values.rotate_right(1);
    values[0] = next;
}

/// Turns S into one of at most k columns with the same S S': lower
/// triangular, by Householder reflections.
fn compress<K: Kind>(columns: &mut Vec<Real<K>>, k: usize) {
    let mut done = 0;
    for i in 0..k {
        let rest = &mut columns[done..];
        let row: List<Real<K>> =
            rest.iter().skip(i).step_by(k).copied().collect();
        let size: f64 = row.iter().map(|a| a.value() * a.value()).sum();
        let mut alpha = Real::new(0.0);
        if size > f64::MIN_POSITIVE {
            alpha = reflect(rest, k, i + 1..k, &row);
            done += k;
        }
        for column in rest.chunks_exact_mut(k) {
            column[i] = std::mem::take(&mut alpha);
        }
    }
    columns.truncate(done);
}

/// Reflects the rows `rows` of S, by the reflection that takes `row` to
/// (alpha, 0, .., 0); returns alpha.
fn reflect<K: Kind>(
    columns: &mut [Real<K>],
    k: usize,
    rows: Range<usize>,
    row: &[Real<K>],
) -> Real<K> {
    let norm = row.iter().map(|&a| a * a).sum::<Real<K>>().sqrt();
    let alpha = if row[0] > 0.0 { -norm } else { norm };
    let scale = 1.0 / (alpha * (alpha - row[0]));
    let mut normal: List<Real<K>> = List::from_slice(row);
    normal[0] -= alpha;
    for i in rows {
        let mut along = Real::new(0.0);
        for (column, &v) in columns.chunks_exact(k).zip(&normal) {
            along += column[i] * v;
        }
        along *= scale;
        for (column, &v) in columns.chunks_exact_mut(k).zip(&normal) {
            column[i] -= along * v;
        }
    }
    alpha
}
