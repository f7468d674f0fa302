//! Normal approximations of a posterior about its modes and along its ridges,
//! of which mixtures are made.

use nalgebra::{DMatrix, DVector};

use crate::infer::climb::Peak;

/// A normal approximation of the posterior about a place.
#[derive(Debug, Clone)]
pub(in crate::infer) struct Component {
    /// About what it holds, in ln and up to a constant of the posterior.
    pub(in crate::infer) log: f64,
    pub(in crate::infer) mean: DVector<f64>,
    pub(in crate::infer) covariance: DMatrix<f64>,
}

impl Component {
    fn new(peak: &Peak, precision: DMatrix<f64>) -> Option<Self> {
        let factor = precision.cholesky()?;
        let log_det: f64 = factor.l_dirty().diagonal().map(f64::ln).sum();
        Some(Self {
            log: peak.height - log_det,
            mean: peak.line.clone(),
            covariance: factor.inverse(),
        })
    }

    /// The same of some of the coordinates.
    pub(in crate::infer) fn marginal(&self, of: &[usize]) -> Self {
        let covariance = self.covariance.select_rows(of).select_columns(of);
        Self { log: self.log, mean: self.mean.select_rows(of), covariance }
    }

    /// About a peak, along some coordinates no wider than told; `None` where
    /// it has no width.
    pub(in crate::infer) fn within(
        peak: &Peak,
        held: &[usize],
        widths: &[f64],
    ) -> Option<Self> {
        let mut precision = peak.precision.clone();
        for (&i, width) in held.iter().zip(widths) {
            precision[(i, i)] += width.powi(-2);
        }
        Self::new(peak, precision)
    }

    /// About the best place with some coordinates held: as wide as the next
    /// ones are far along these, the others following as the precision tells.
    pub(in crate::infer) fn of_place(
        peak: &Peak,
        held: &[usize],
        apart: &[f64],
    ) -> Option<Self> {
        let n = peak.line.len();
        let free: Vec<usize> = (0..n).filter(|i| !held.contains(i)).collect();
        let mut joint = peak.precision.clone();
        let inner = joint.select_rows(&free).select_columns(&free);
        let across = joint.select_rows(&free).select_columns(held);
        let follows = across.tr_mul(&inner.cholesky()?.solve(&across));
        for (i, &row) in held.iter().enumerate() {
            for (j, &column) in held.iter().enumerate() {
                joint[(row, column)] = follows[(i, j)];
            }
            joint[(row, row)] += 1.0 / apart[i].powi(2);
        }
        Self::new(peak, joint)
    }
}
