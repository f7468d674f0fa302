//! The posterior mode, by argmin.
//!
//! L-BFGS with the exact gradient climbs from each of several starts; where
//! the density has kinks (a recording time that passes a piece's border) it
//! stalls, and Nelder-Mead, which asks for no gradient, goes on from there.
//! The mode is that of prior times likelihood in the parameters as named; the
//! search runs on the real line, where there are no bounds, and measures steps
//! there by the density's own curvature, so that no parameter is long.

use argmin::core::{CostFunction, Executor, Gradient, State};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use nalgebra::{DMatrix, DVector};

use crate::error::{Error, Result};
use crate::infer::simplex::{WALL, descend, finished};
use crate::infer::start::apart;
use crate::infer::{Backend, Inference, Mode, Progress};
use crate::model::{Point, Posterior, Weights};
use crate::parallel;
use crate::seed::Seed;

/// The search for the mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// From how many starts drawn from the prior.
    pub starts: usize,
    /// Further starts, parameters as named.
    pub from: Vec<Vec<f64>>,
}

impl Default for Map {
    fn default() -> Self {
        Self { starts: 8, from: Vec::new() }
    }
}

/// The problem as argmin sees it: minus the log density at centre + factor y.
#[derive(Clone, Copy)]
struct Descent<'a, 'm> {
    posterior: &'a Posterior<'m>,
    centre: &'a DVector<f64>,
    factor: &'a DMatrix<f64>,
}

impl Descent<'_, '_> {
    fn line(&self, y: &DVector<f64>) -> DVector<f64> {
        self.centre + self.factor * y
    }
}

impl CostFunction for Descent<'_, '_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, y: &DVector<f64>) -> Result<f64, argmin::core::Error> {
        let height = height(self.posterior, &self.line(y))?;
        Ok(if height.is_finite() { -height } else { WALL })
    }
}

impl Gradient for Descent<'_, '_> {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(
        &self,
        y: &DVector<f64>,
    ) -> Result<DVector<f64>, argmin::core::Error> {
        let gradient = gradient(self.posterior, &self.line(y))?;
        Ok(-self.factor.tr_mul(&gradient))
    }
}

/// ln(prior x likelihood) in the parameters as named, at a place on the line.
fn height(posterior: &Posterior<'_>, z: &DVector<f64>) -> Result<f64> {
    let density = posterior.density(Point::Line(z.as_slice()))?;
    Ok(density.natural())
}

/// Its gradient along the line.
fn gradient(
    posterior: &Posterior<'_>,
    z: &DVector<f64>,
) -> Result<DVector<f64>> {
    let mut gradient = DVector::zeros(z.len());
    let slots = gradient.as_mut_slice();
    posterior.gradient(z.as_slice(), Weights::NATURAL, slots)?;
    Ok(gradient)
}

/// How thoroughly to climb: argmin's iterations, per dimension for the
/// simplex, and the gain below which a round is the last.
struct Pains {
    quasi_newton: u64,
    simplex: u64,
    gain: f64,
}

/// Enough to tell which peak a start leads to.
const ROUGH: Pains = Pains { quasi_newton: 50, simplex: 40, gain: 0.05 };
/// Enough for the peak itself.
const FINE: Pains = Pains { quasi_newton: 200, simplex: 400, gain: 1e-6 };

/// The best place that one start leads to, and its height.
fn climb(
    posterior: &Posterior<'_>,
    start: DVector<f64>,
    pains: &Pains,
) -> Result<(f64, DVector<f64>)> {
    let mut best = (height(posterior, &start)?, start);
    for round in 0..12 {
        let before = best.0;
        let centre = best.1.clone();
        let factor = steps(posterior, &centre)?;
        let descent = Descent { posterior, centre: &centre, factor: &factor };
        let smooth = quasi_newton(descent, pains.quasi_newton)?;
        let from = smooth.unwrap_or_else(|| DVector::zeros(centre.len()));
        let spread = if round == 0 { 1.0 } else { 0.3 };
        let kinked = simplex(descent, &from, spread, pains.simplex)?;
        for found in [Some(from), kinked].into_iter().flatten() {
            let found = descent.line(&found);
            let at = height(posterior, &found)?;
            if at > best.0 {
                best = (at, found);
            }
        }
        if best.0 - before < pains.gain && round > 0 {
            break;
        }
    }
    Ok(best)
}

/// Steps on the line over which the height changes by about 1/2, one in each
/// column, none longer than 1.
fn steps(posterior: &Posterior<'_>, z: &DVector<f64>) -> Result<DMatrix<f64>> {
    let curvature = curvature(posterior, z)?;
    if curvature.iter().any(|c| !c.is_finite()) {
        return Ok(DMatrix::identity(z.len(), z.len()) * 0.3);
    }
    let eigen = curvature.symmetric_eigen();
    let mut steps = eigen.eigenvectors;
    for (mut step, bend) in steps.column_iter_mut().zip(&eigen.eigenvalues) {
        step /= bend.abs().max(1.0).sqrt();
    }
    Ok(steps)
}

/// L-BFGS from the centre; `None` where its line search fails.
fn quasi_newton(
    descent: Descent<'_, '_>,
    iterations: u64,
) -> Result<Option<DVector<f64>>> {
    let start = DVector::zeros(descent.centre.len());
    let solver = LBFGS::new(MoreThuenteLineSearch::new(), 7);
    let run = Executor::new(descent, solver)
        .configure(|state| state.param(start).max_iters(iterations))
        .run();
    let run = finished(run)?;
    Ok(run.and_then(|run| run.state().get_best_param().cloned()))
}

/// Nelder-Mead from a simplex of the given spread about `start`.
fn simplex(
    descent: Descent<'_, '_>,
    start: &DVector<f64>,
    spread: f64,
    iterations: u64,
) -> Result<Option<DVector<f64>>> {
    let mut corners = vec![start.clone()];
    for i in 0..start.len() {
        let mut corner = start.clone();
        corner[i] += spread;
        corners.push(corner);
    }
    let iterations = iterations * start.len() as u64;
    let found = descend(descent, corners, 1e-10, iterations)?;
    Ok(found.map(|(_, place)| place))
}

/// Minus the Hessian of the height on the line, from central differences of
/// the exact gradient.
fn curvature(
    posterior: &Posterior<'_>,
    z: &DVector<f64>,
) -> Result<DMatrix<f64>> {
    let n = z.len();
    let mut curvature = DMatrix::zeros(n, n);
    let h = 1e-4;
    for j in 0..n {
        for side in [1.0, -1.0] {
            let mut at = z.clone();
            at[j] += side * h;
            let slope = gradient(posterior, &at)? * (side / (2.0 * h));
            let mut column = curvature.column_mut(j);
            column -= slope;
        }
    }
    Ok((&curvature + curvature.transpose()) * 0.5)
}

impl Backend for Map {
    fn name(&self) -> &'static str {
        "map"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        let mut starts = self.from.clone();
        starts.extend(apart(posterior, self.starts, seed)?);
        progress.begin("climbing", Some(starts.len() as u64));
        let mut ends = parallel::try_map(&starts, |start| {
            let start = DVector::from_vec(posterior.line(start)?);
            let end = climb(posterior, start, &ROUGH);
            progress.advance(1);
            end
        })?;
        ends.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut reached: Vec<f64> = ends.iter().map(|end| end.0).collect();
        let Some((_, highest)) = ends.into_iter().next() else {
            return Err(Error::input("the search needs at least one start"));
        };
        let (log_density, line) = climb(posterior, highest, &FINE)?;
        reached[0] = log_density;
        let curvature = curvature(posterior, &line)?;
        let mode = Mode {
            natural: posterior.natural(line.as_slice())?,
            covariance: curvature.cholesky().map(|c| c.inverse()),
            line: line.as_slice().to_vec(),
            log_density,
            reached,
        };
        let mut warnings = Vec::new();
        let apart = mode.reached.iter().filter(|r| log_density - *r > 0.5);
        let apart = apart.count();
        if apart > 0 {
            warnings.push(format!(
                "{apart} of {} starts ended on a lower peak: the posterior \
                 may have several modes",
                mode.reached.len()
            ));
        }
        Ok(Inference { mode: Some(mode), warnings, ..Inference::default() })
    }
}
