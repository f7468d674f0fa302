//! A component of a mixture: a multivariate Student-t distribution with a
//! weight.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use statrs::function::gamma::ln_gamma;

/// Degrees of freedom of each component: heavy enough to bound the weights
/// of a posterior whose tails are those of its prior.
pub(super) const FREEDOM: f64 = 5.0;

/// ln of the density of a multivariate Student-t distribution of unit shape at
/// its middle.
pub(crate) fn student_constant(freedom: f64, dimension: f64) -> f64 {
    ln_gamma(0.5 * (freedom + dimension))
        - ln_gamma(0.5 * freedom)
        - 0.5 * dimension * (freedom * std::f64::consts::PI).ln()
}

/// A weighted Student-t distribution.
#[derive(Debug, Clone)]
pub(super) struct Component {
    pub(super) weight: f64,
    pub(super) mean: DVector<f64>,
    pub(super) shape: Cholesky<f64, Dyn>,
    /// The rows of the shape's inverse factor, one after the other, each after
    /// minus what it makes of the mean.
    pub(super) whitening: Vec<f64>,
    pub(super) log_constant: f64,
}

impl Component {
    pub(super) fn new(
        weight: f64,
        mean: DVector<f64>,
        covariance: &DMatrix<f64>,
    ) -> Option<Self> {
        let n = mean.len();
        let dimension = n as f64;
        let shape = Cholesky::new(nudged(covariance))?;
        let log_det = 2.0 * shape.l().diagonal().map(f64::ln).sum();
        let log_constant =
            student_constant(FREEDOM, dimension) - 0.5 * log_det;
        let inverse =
            shape.l().solve_lower_triangular(&DMatrix::identity(n, n))?;
        let white = &inverse * &mean;
        let whitening = (0..n)
            .flat_map(|i| {
                let row = (0..=i).map(|j| inverse[(i, j)]);
                std::iter::once(-white[i]).chain(row).collect::<Vec<_>>()
            })
            .collect();
        Some(Self { weight, mean, shape, whitening, log_constant })
    }

    /// The squared distance from the mean, in units of the shape.
    pub(super) fn distance(&self, z: &[f64]) -> f64 {
        let (mut sum, mut rest) = (0.0, &self.whitening[..]);
        for i in 1..=z.len() {
            let (row, after) = rest.split_at(i + 1);
            let white: f64 = row[1..].iter().zip(z).map(|(r, z)| r * z).sum();
            sum += (white + row[0]).powi(2);
            rest = after;
        }
        sum
    }

    /// ln of the weighted density at such a squared distance, also where that
    /// is beyond what a number can hold.
    pub(super) fn log_density_at(&self, distance: f64) -> f64 {
        let n = self.mean.len() as f64;
        self.weight.ln() + self.log_constant
            - 0.5 * (FREEDOM + n) * (distance / FREEDOM).ln_1p()
    }
}

/// A covariance made surely positive definite.
fn nudged(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let mut c = covariance.clone();
    let trace = c.trace().max(1e-12) / c.nrows() as f64;
    for i in 0..c.nrows() {
        c[(i, i)] = c[(i, i)] * (1.0 + 1e-9) + 1e-9 * trace;
    }
    c
}
