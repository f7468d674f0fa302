//! The Gaussian process that a free-form force is drawn from beforehand.

use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::error::{Error, Result};
use crate::mechanism::Extent;
use crate::prior::AnyPrior;

/// How many cells a free-form force has.
pub const CELLS: usize = 40;
/// The prior median of the process's length \[m\], and the sd of its log.
const LENGTH: (f64, f64) = (20.0, 0.7);
/// The prior scale of the force \[m/s2\].
const SIZE: f64 = 1.0;

/// A process, as two numbers that are standard normal beforehand: of its
/// length and of its size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Process(pub(crate) f64, pub(crate) f64);

impl Process {
    /// The first coordinates of a place, and the rest.
    pub(super) fn parted(z: &[f64]) -> (Self, &[f64]) {
        (Self(z[0], z[1]), &z[2..])
    }

    /// Its length \[m\].
    pub(super) fn length(&self) -> f64 {
        let (median, spread) = LENGTH;
        // Beyond these a process is as good as white, or as constant.
        median * (spread * self.0).exp().clamp(1e-3, 1e3)
    }

    /// Its size \[m/s2\].
    pub(super) fn size(&self) -> f64 {
        let p = Normal::standard().cdf(self.1).clamp(1e-9, 1.0 - 1e-9);
        AnyPrior::HalfNormal(SIZE).quantile(p).unwrap_or(SIZE)
    }

    pub(super) fn log_prior(&self) -> f64 {
        let Self(a, b) = self;
        -0.5 * (a * a + b * b) - std::f64::consts::TAU.ln()
    }

    /// The squared distance of another.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        (self.0 - other.0).powi(2) + (self.1 - other.1).powi(2)
    }

    /// L with force = L w, w independent standard normal waves. Its length
    /// stands for as large a part of the run on axes other than distance.
    pub(super) fn factor(&self, extent: &Extent) -> Result<DMatrix<f64>> {
        let (length, size) = (self.length(), self.size());
        let step = extent.run / CELLS as f64;
        let covariance = DMatrix::from_fn(CELLS, CELLS, |i, j| {
            let apart = (i as f64 - j as f64) * step / length;
            let nugget = if i == j { 1e-6 } else { 0.0 };
            size * size * ((-0.5 * apart * apart).exp() + nugget)
        });
        let factor = covariance.cholesky().map(|factor| factor.unpack());
        factor.ok_or_else(|| Error::inference("no such Gaussian process"))
    }

    /// The same with one wave more: a force that is the same along the whole
    /// run, beforehand as large as the others are in any place.
    pub(super) fn factor_with_level(
        &self,
        extent: &Extent,
    ) -> Result<DMatrix<f64>> {
        Ok(self.factor(extent)?.insert_column(CELLS, self.size()))
    }
}
