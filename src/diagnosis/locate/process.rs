//! The Gaussian process that a free-form force is drawn from beforehand.

use nalgebra::{DMatrix, DVector};
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

    /// One of such a length \[m\].
    pub(super) fn of_length(length: f64) -> Self {
        let (median, spread) = LENGTH;
        Self((length / median).ln() / spread, 0.0)
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

    /// How any two of so many cells go together beforehand, the size being 1.
    /// Its length stands for as large a part of the run on axes other than
    /// distance.
    fn correlation(&self, extent: &Extent, cells: usize) -> DMatrix<f64> {
        let step = extent.run / cells as f64 / self.length();
        DMatrix::from_fn(cells, cells, |i, j| {
            let apart = (i as f64 - j as f64) * step;
            (-0.5 * apart * apart).exp()
        })
    }

    /// L with force = L w, w independent standard normal waves: as few as make
    /// all of the force but a hundredth of its size. A smooth force has far
    /// fewer waves than cells.
    pub(super) fn factor(
        &self,
        extent: &Extent,
        cells: usize,
    ) -> DMatrix<f64> {
        pivoted(&self.correlation(extent, cells)) * self.size()
    }

    /// The same of [`CELLS`] cells with as many waves, so that these make any
    /// force: L is lower triangular.
    pub(super) fn whole_factor(
        &self,
        extent: &Extent,
    ) -> Result<DMatrix<f64>> {
        let mut correlation = self.correlation(extent, CELLS);
        correlation.fill_diagonal(1.0 + 1e-6);
        let factor = correlation.cholesky().map(|factor| factor.unpack());
        let missing = || Error::inference("no such Gaussian process");
        Ok(factor.ok_or_else(missing)? * self.size())
    }
}

/// The share of its variance that a cell's force may lack.
const LACKING: f64 = 1e-4;

/// L with L L' about a matrix of correlations: Cholesky's factor, the
/// coordinate with the most variance left first, until none has more than a
/// little (Harbrecht, Peters, Schneider 2012).
fn pivoted(correlation: &DMatrix<f64>) -> DMatrix<f64> {
    let mut left = correlation.diagonal();
    let mut columns: Vec<DVector<f64>> = Vec::new();
    while columns.len() < left.len() {
        let (pivot, variance) = left.argmax();
        if variance < LACKING {
            break;
        }
        let mut column = correlation.column(pivot).into_owned();
        for known in &columns {
            column.axpy(-known[pivot], known, 1.0);
        }
        column /= variance.sqrt();
        left -= column.component_mul(&column);
        columns.push(column);
    }
    DMatrix::from_columns(&columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_waves_make_nearly_all_of_the_force() {
        let extent = Extent { run: 200.0, ..Extent::EVERYTHING };
        for (length, fewest, most) in
            [(-2.0, 38, 40), (0.0, 10, 20), (3.0, 2, 5)]
        {
            let process = Process(length, 0.7);
            let factor = process.factor(&extent, CELLS);
            let waves = factor.ncols();
            assert!((fewest..=most).contains(&waves), "{length}: {waves}");
            let whole =
                process.correlation(&extent, CELLS) * process.size().powi(2);
            let lacks = (whole - &factor * factor.transpose()).amax();
            let tolerated = LACKING * process.size().powi(2);
            assert!(lacks < tolerated, "{length}: {lacks}");
        }
    }
}
