//! Climbing to a peak of the posterior with the Fisher information.
//!
//! Levenberg and Marquardt's method on the real line: each step solves
//! (P + lambda diag P) step = gradient, with P about minus the Hessian from
//! first derivatives. It needs a dozen steps where a quasi-Newton method
//! needs a hundred, because a recording is nearly a least-squares problem.

use nalgebra::{DMatrix, DVector};

use crate::error::Result;
use crate::model::{Information, Point, Posterior};

/// A peak of the density on the real line, with its normal approximation.
#[derive(Debug, Clone)]
pub struct Peak {
    /// Where it is, on the real line.
    pub line: DVector<f64>,
    /// The log density there, as one on the real line.
    pub height: f64,
    /// About minus the Hessian there.
    pub precision: DMatrix<f64>,
}

impl Peak {
    /// The log of what the normal approximation integrates to (Laplace);
    /// `None` where the precision is not positive definite.
    pub fn log_evidence(&self) -> Option<f64> {
        let factor = self.precision.clone().cholesky()?;
        let log_det = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
        let n = self.line.len() as f64;
        Some(
            self.height + 0.5 * n * std::f64::consts::TAU.ln() - 0.5 * log_det,
        )
    }

    /// The squared distance of a place, in units of the peak's width.
    pub fn distance(&self, line: &DVector<f64>) -> f64 {
        let off = line - &self.line;
        off.dot(&(&self.precision * &off))
    }
}

/// The most steps of a climb.
const STEPS: usize = 60;
/// The most of one that begins nearby.
const FEW: usize = 8;
/// A gain of the log density below which a climb has arrived.
const ARRIVED: f64 = 1e-3;
/// The longest step along one axis of the line.
const LONGEST: f64 = 2.0;

/// The peak that a start leads to; `None` where the start has no density.
///
/// # Errors
/// What no other parameter values would mend.
pub fn climb(
    posterior: &Posterior<'_>,
    start: &[f64],
) -> Result<Option<Peak>> {
    ascend(posterior, start, &[], STEPS)
}

/// The same within the places that share some coordinates with the start, near
/// which the best of them lies.
pub(super) fn climb_holding(
    posterior: &Posterior<'_>,
    start: &[f64],
    held: &[usize],
) -> Result<Option<Peak>> {
    ascend(posterior, start, held, FEW)
}

/// A climb in so many steps at most, some coordinates held.
fn ascend(
    posterior: &Posterior<'_>,
    start: &[f64],
    held: &[usize],
    steps: usize,
) -> Result<Option<Peak>> {
    let mut line = DVector::from_column_slice(start);
    let mut about = posterior.information(start)?;
    if !is_usable(&about) {
        return Ok(None);
    }
    let mut lambda = 1e-2;
    let mut idle = 0;
    for _ in 0..steps {
        let height = about.density.on_line();
        let Some(next) = step(posterior, &line, &about, held, &mut lambda)?
        else {
            break;
        };
        let information = posterior.information(next.as_slice())?;
        if !is_usable(&information) {
            break;
        }
        (line, about) = (next, information);
        let gain = about.density.on_line() - height;
        idle = if gain < ARRIVED { idle + 1 } else { 0 };
        if idle == 2 {
            break;
        }
    }
    let height = about.density.on_line();
    Ok(Some(Peak { line, height, precision: about.precision }))
}

fn is_usable(about: &Information) -> bool {
    about.density.on_line().is_finite()
        && about.gradient.iter().all(|g| g.is_finite())
        && about.precision.iter().all(|p| p.is_finite())
}

/// A step that climbs, with ever more damping until one does.
fn step(
    posterior: &Posterior<'_>,
    line: &DVector<f64>,
    about: &Information,
    held: &[usize],
    lambda: &mut f64,
) -> Result<Option<DVector<f64>>> {
    let height = about.density.on_line();
    let (mut precision, mut gradient) =
        (about.precision.clone(), about.gradient.clone());
    for &i in held {
        precision.row_mut(i).fill(0.0);
        precision.column_mut(i).fill(0.0);
        (precision[(i, i)], gradient[i]) = (1.0, 0.0);
    }
    for _ in 0..10 {
        if let Some(mut off) = damped_step(&precision, &gradient, *lambda) {
            off *= (LONGEST / off.amax()).min(1.0);
            let next = line + off;
            let density = posterior.density(Point::Line(next.as_slice()))?;
            if density.on_line() > height && density.rejected.is_none() {
                *lambda = (*lambda * 0.2).max(1e-9);
                return Ok(Some(next));
            }
        }
        *lambda = (*lambda * 5.0).max(1e-6);
    }
    Ok(None)
}

/// The step that solves (P + lambda diag P) step = gradient; `None` where that
/// is not positive definite.
pub(crate) fn damped_step(
    precision: &DMatrix<f64>,
    gradient: &DVector<f64>,
    lambda: f64,
) -> Option<DVector<f64>> {
    let mut damped = precision.clone();
    for i in 0..gradient.len() {
        damped[(i, i)] += lambda * damped[(i, i)] + 1e-6;
    }
    Some(damped.cholesky()?.solve(gradient))
}
