//! A model with a free-form force, to second order about a force and the
//! model's own parameters; and what that says of the force under any process.
//!
//! The square of the speed is linear in a force over distance, so that given
//! the process and the model's parameters the force is nearly normal. The
//! tangent is that of the cells themselves, each standard normal beforehand;
//! that prior is taken out of it again. Under a process with force = L w, w
//! standard normal, the waves w then have the precision M = 1 + L' A L, with A
//! the information of the data, and one tangent serves all processes.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::error::Result;
use crate::infer::Slope;
use crate::model::{Information, Point, Posterior};

/// A model with a force of so many independent cells, which come first.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a, 'm> {
    pub(super) posterior: &'a Posterior<'m>,
    pub(super) count: usize,
}

impl Cells<'_, '_> {
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

    /// The tangent at a force and own parameters; `None` where there is no
    /// density.
    pub(super) fn tangent(
        &self,
        force: DVector<f64>,
        own: DVector<f64>,
    ) -> Result<Option<Tangent>> {
        let line = [force.as_slice(), own.as_slice()].concat();
        let about = self.posterior.information(&line)?;
        let usable = about.density.on_line().is_finite()
            && about.gradient.iter().all(|g| g.is_finite());
        Ok(usable.then(|| Tangent::new(force, own, &about)))
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

/// ln p(own, data | force) to second order.
#[derive(Debug, Clone)]
pub(super) struct Tangent {
    pub(super) force: DVector<f64>,
    pub(super) own: DVector<f64>,
    height: f64,
    /// Along the force, and along the own parameters.
    pulls: (DVector<f64>, DVector<f64>),
    /// A, and how both go together, and of the own parameters.
    pub(super) of_force: DMatrix<f64>,
    pub(super) across: DMatrix<f64>,
    pub(super) of_own: DMatrix<f64>,
}

impl Tangent {
    fn new(
        force: DVector<f64>,
        own: DVector<f64>,
        about: &Information,
    ) -> Self {
        let (cells, n) = (force.len(), own.len());
        let view = |at, size| about.precision.view(at, size).into_owned();
        let one = DMatrix::identity(cells, cells);
        Self {
            height: about.density.on_line() - log_normal(&force),
            pulls: (
                about.gradient.rows(0, cells) + &force,
                about.gradient.rows(cells, n).into_owned(),
            ),
            of_force: view((0, 0), (cells, cells)) - one,
            across: view((0, cells), (cells, n)),
            of_own: view((cells, cells), (n, n)),
            force,
            own,
        }
    }

    /// The waves of a process that are best at some own parameters, as far as
    /// the tangent holds; `None` where they have no width.
    pub(super) fn waves(
        &self,
        factor: &DMatrix<f64>,
        own: &DVector<f64>,
    ) -> Option<Waves> {
        let n = factor.ncols();
        let precision = DMatrix::identity(n, n)
            + factor.tr_mul(&(&self.of_force * factor));
        let precision = precision.cholesky()?;
        let pull = &self.pulls.0 + &self.of_force * &self.force
            - &self.across * (own - &self.own);
        let mean = precision.solve(&factor.tr_mul(&pull));
        let finite = mean.iter().all(|x| x.is_finite());
        finite.then_some(Waves { mean, precision })
    }

    /// ln p(own, data) at the own parameters that the waves are best at, the
    /// force integrated.
    pub(super) fn height(&self, factor: &DMatrix<f64>, waves: &Waves) -> f64 {
        self.height_off(&(factor * &waves.mean - &self.force), waves)
    }

    /// The same, the best force being so far off the tangent's.
    fn height_off(&self, off: &DVector<f64>, waves: &Waves) -> f64 {
        let bend = off.dot(&(&self.of_force * off));
        self.height + self.pulls.0.dot(off)
            - 0.5 * bend
            - 0.5 * waves.mean.norm_squared()
            - half_log_det(&waves.precision)
    }

    /// ln p(own, data), the force integrated, about the tangent's own
    /// parameters, to second order. Its gradient is that along the ridge of
    /// the best forces: how these narrow is left to the draws.
    pub(super) fn marginal(
        &self,
        factor: &DMatrix<f64>,
        waves: &Waves,
    ) -> Slope {
        let off = factor * &waves.mean - &self.force;
        let height = self.height_off(&off, waves);
        let across = factor.tr_mul(&self.across);
        let follows = waves.precision.solve(&across);
        let gradient = &self.pulls.1 - self.across.tr_mul(&off);
        let precision = &self.of_own - across.tr_mul(&follows);
        Slope { height, gradient, precision }
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
