//! A model with a free-form force, to second order about a force and the
//! model's own parameters; and what that says of the force under any process.
//!
//! A process's force is L w, of waves w that are standard normal beforehand.
//! The square of the speed is linear in a force over distance, so that given
//! the process and the model's parameters the waves are nearly normal, with
//! the precision M = 1 + L' A L, A being the information of the data. A
//! tangent of the cells themselves, L = 1, serves all processes; one along
//! the waves of a process serves it alone, and takes derivatives along as few
//! directions as there are waves.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::error::Result;
use crate::infer::Slope;
use crate::model::{Point, Posterior};

/// What makes a force of waves: force = L w.
#[derive(Debug, Clone)]
pub(super) struct Basis {
    /// L: a row for each cell, a column for each wave.
    pub(super) factor: DMatrix<f64>,
    /// L'L: the precision that independent cells, standard normal beforehand,
    /// give the waves.
    squared: DMatrix<f64>,
    /// The waves and the model's own parameters as directions of the cells and
    /// these.
    directions: DMatrix<f64>,
}

impl Basis {
    /// Beside so many own parameters of the model.
    pub(super) fn new(factor: DMatrix<f64>, own: usize) -> Self {
        let (cells, waves) = factor.shape();
        let mut directions = DMatrix::zeros(waves + own, cells + own);
        directions.view_mut((0, 0), (waves, cells)).tr_copy_from(&factor);
        directions.view_mut((waves, cells), (own, own)).fill_with_identity();
        let squared = factor.tr_mul(&factor);
        Self { factor, squared, directions }
    }

    /// The cells themselves.
    pub(super) fn cells(cells: usize, own: usize) -> Self {
        Self::new(DMatrix::identity(cells, cells), own)
    }
}

/// A model with a force of so many independent cells, which come first.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a, 'm> {
    pub(super) posterior: &'a Posterior<'m>,
    pub(super) count: usize,
}

impl Cells<'_, '_> {
    /// How many parameters the model has of its own.
    pub(super) fn own(&self) -> usize {
        self.posterior.dimension() - self.count
    }

    /// ln p(own, data | force).
    pub(super) fn log_density(
        &self,
        force: &DVector<f64>,
        own: &[f64],
    ) -> Result<f64> {
        let line = [force.as_slice(), own].concat();
        let density = self.posterior.density(Point::Line(&line))?;
        Ok(density.on_line() - log_normal(force))
    }

    /// The tangent along waves, at some of these and own parameters; `None`
    /// where there is no density.
    pub(super) fn tangent(
        &self,
        basis: &Basis,
        waves: &DVector<f64>,
        own: DVector<f64>,
    ) -> Result<Option<Tangent>> {
        let Basis { factor, squared, directions } = basis;
        let (force, n, m) = (factor * waves, own.len(), waves.len());
        let line = [force.as_slice(), own.as_slice()].concat();
        let about = self.posterior.information_along(&line, directions)?;
        let height = about.density.on_line() - log_normal(&force);
        let gradient = about.gradient;
        if !height.is_finite() || !gradient.iter().all(|g| g.is_finite()) {
            return Ok(None);
        }
        let view = |at, size| about.precision.view(at, size).into_owned();
        // Without what the prior of the cells says.
        let of_waves = view((0, 0), (m, m)) - squared;
        let across = view((0, m), (m, n));
        let bent = &of_waves * waves;
        let pull = gradient.rows(0, m) + squared * waves;
        Ok(Some(Tangent {
            height: height - pull.dot(waves) - 0.5 * bent.dot(waves),
            pulls: (pull + bent, gradient.rows(m, n) + across.tr_mul(waves)),
            of_waves,
            across,
            of_own: view((m, m), (n, n)),
            own,
            at: waves.clone(),
        }))
    }
}

/// ln of a standard normal density.
pub(super) fn log_normal(x: &DVector<f64>) -> f64 {
    let n = x.len() as f64;
    -0.5 * (x.norm_squared() + n * std::f64::consts::TAU.ln())
}

/// Half of ln det of a precision.
pub(super) fn half_log_det(precision: &Cholesky<f64, Dyn>) -> f64 {
    precision.l_dirty().diagonal().iter().map(|d| d.ln()).sum()
}

/// ln p(own, data | waves) to second order, expanded about zero waves and the
/// own parameters `own`.
#[derive(Debug, Clone)]
pub(super) struct Tangent {
    pub(super) own: DVector<f64>,
    /// The waves that it was made at; of no use where they are others by now.
    pub(super) at: DVector<f64>,
    height: f64,
    /// Along the waves, and along the own parameters.
    pulls: (DVector<f64>, DVector<f64>),
    /// A, and how both go together, and of the own parameters.
    pub(super) of_waves: DMatrix<f64>,
    pub(super) across: DMatrix<f64>,
    pub(super) of_own: DMatrix<f64>,
}

impl Tangent {
    /// One of the cells, along a process's waves.
    pub(super) fn along(&self, Basis { factor, .. }: &Basis) -> Self {
        Self {
            own: self.own.clone(),
            at: DVector::zeros(factor.ncols()),
            height: self.height,
            pulls: (factor.tr_mul(&self.pulls.0), self.pulls.1.clone()),
            of_waves: factor.tr_mul(&(&self.of_waves * factor)),
            across: factor.tr_mul(&self.across),
            of_own: self.of_own.clone(),
        }
    }

    /// The same along waves that are so much larger.
    pub(super) fn scaled(&self, by: f64) -> Self {
        Self {
            own: self.own.clone(),
            at: &self.at / by,
            height: self.height,
            pulls: (&self.pulls.0 * by, self.pulls.1.clone()),
            of_waves: &self.of_waves * (by * by),
            across: &self.across * by,
            of_own: self.of_own.clone(),
        }
    }

    /// The waves that are best at some own parameters, as far as the tangent
    /// holds; `None` where they have no width.
    pub(super) fn waves(&self, own: &DVector<f64>) -> Option<Waves> {
        let mut precision = self.of_waves.clone();
        for i in 0..precision.nrows() {
            precision[(i, i)] += 1.0;
        }
        let precision = precision.cholesky()?;
        let pull = &self.pulls.0 - &self.across * (own - &self.own);
        let mean = precision.solve(&pull);
        let finite = mean.iter().all(|x| x.is_finite());
        finite.then_some(Waves { mean, precision })
    }

    /// ln p(own, data) at the tangent's own parameters, the force integrated,
    /// where such waves are best. Of waves that are best at other own
    /// parameters nearby it says about which tangent promises more.
    pub(super) fn height(&self, Waves { mean, precision }: &Waves) -> f64 {
        self.height_of(mean, precision)
    }

    /// The same with waves that need not be the best. Of those that it was made
    /// at it promises nothing that is not there.
    pub(super) fn height_of(
        &self,
        waves: &DVector<f64>,
        precision: &Cholesky<f64, Dyn>,
    ) -> f64 {
        let bent = waves.dot(&(&self.of_waves * waves)) + waves.norm_squared();
        let half = half_log_det(precision);
        self.height + self.pulls.0.dot(waves) - 0.5 * bent - half
    }

    /// ln p(own, data), the force integrated, about the tangent's own
    /// parameters, to second order. Its gradient is that along the ridge of
    /// the best forces: how these narrow is left to the draws.
    pub(super) fn marginal(&self, waves: &Waves) -> Slope {
        let follows = waves.precision.solve(&self.across);
        Slope {
            height: self.height(waves),
            gradient: &self.pulls.1 - self.across.tr_mul(&waves.mean),
            precision: &self.of_own - self.across.tr_mul(&follows),
        }
    }
}

/// What is known of the waves at some own parameters.
pub(super) struct Waves {
    pub(super) mean: DVector<f64>,
    pub(super) precision: Cholesky<f64, Dyn>,
}

impl Waves {
    /// How much higher, in ln, their mean is than other waves.
    pub(super) fn gain_from(&self, other: &DVector<f64>) -> f64 {
        let off = &self.mean - other;
        0.5 * self.precision.l().tr_mul(&off).norm_squared()
    }
}
