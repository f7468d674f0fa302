//! A log density about a point, to second order.

use nalgebra::{DMatrix, DVector};

use super::density::Density;
use super::jacobian::Jacobian;

/// The log density on the real line about a point, to second order.
#[derive(Debug, Clone)]
pub struct Information {
    /// The density there.
    pub density: Density,
    /// The gradient of the log density on the real line.
    pub gradient: DVector<f64>,
    /// About minus its Hessian; positive semidefinite.
    pub precision: DMatrix<f64>,
    /// The derivatives of the innovations and of their scales: `precision` is
    /// their product with themselves, and the bends of the priors. Empty where
    /// the density is put together from others, or taken along directions
    /// afterwards.
    pub(crate) jacobian: Jacobian,
}

impl Information {
    /// Of a density that is 1 everywhere.
    pub(crate) fn zero(dimension: usize) -> Self {
        Self {
            density: Density::ONE,
            gradient: DVector::zeros(dimension),
            precision: DMatrix::zeros(dimension, dimension),
            jacobian: Jacobian::new(dimension),
        }
    }

    /// Along some directions, without the derivatives of single data.
    pub(super) fn along(&self, directions: &DMatrix<f64>) -> Self {
        let precision = directions * &self.precision * directions.transpose();
        Self {
            density: self.density,
            gradient: directions * &self.gradient,
            precision,
            jacobian: Jacobian::new(directions.nrows()),
        }
    }

    /// Multiplies the density by a power of another, of some of the
    /// coordinates.
    pub(crate) fn add(&mut self, other: &Self, places: &[usize], power: f64) {
        self.density.multiply(&other.density, power);
        for (i, &row) in places.iter().enumerate() {
            self.gradient[row] += power * other.gradient[i];
            for (j, &column) in places.iter().enumerate() {
                self.precision[(row, column)] +=
                    power * other.precision[(i, j)];
            }
        }
    }
}
