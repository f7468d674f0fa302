//! The posterior mode, by argmin.
//!
//! L-BFGS with the exact gradient climbs from each of several starts; where
//! the density has kinks (a recording time that passes a piece's border) it
//! stalls, and Nelder-Mead, which asks for no gradient, goes on from there.
//! The mode is that of prior times likelihood in the parameters as named; the
//! search runs on the real line, where there are no bounds.

use argmin::core::{CostFunction, Executor, Gradient, State};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::neldermead::NelderMead;
use argmin::solver::quasinewton::LBFGS;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::mh::{best_start, value};
use super::{Backend, Inference, Progress};
use crate::error::{Error, Result};
use crate::model::{Point, Posterior, Weights};
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

/// The posterior mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// The parameters as named.
    pub natural: Vec<f64>,
    /// Their places on the real line.
    pub line: Vec<f64>,
    /// ln(prior x likelihood) there, in the parameters as named.
    pub log_density: f64,
    /// The inverse of the negative Hessian on the real line, from exact
    /// gradients: the covariance of a normal approximation. `None` where the
    /// Hessian is not negative definite, as it may be at a kink.
    pub covariance: Option<DMatrix<f64>>,
    /// The log density that each start led to, best first.
    pub reached: Vec<f64>,
}

/// The problem as argmin sees it: minus the log density, on the line.
struct Descent<'p, 'm>(&'p Posterior<'m>);

/// What a rejected place costs: finite, so that a simplex can compare it.
const WALL: f64 = 1e12;

impl CostFunction for Descent<'_, '_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, z: &DVector<f64>) -> Result<f64, argmin::core::Error> {
        let density = self.0.density(Point::Line(z.as_slice()))?;
        let height = value(&density, density.natural());
        Ok(if height.is_finite() { -height } else { WALL })
    }
}

impl Gradient for Descent<'_, '_> {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(
        &self,
        z: &DVector<f64>,
    ) -> Result<DVector<f64>, argmin::core::Error> {
        let mut gradient = DVector::zeros(z.len());
        let slots = gradient.as_mut_slice();
        self.0.gradient(z.as_slice(), Weights::NATURAL, slots)?;
        Ok(-gradient)
    }
}

impl Map {
    /// The best place that one start leads to.
    fn climb(
        posterior: &Posterior<'_>,
        start: &[f64],
    ) -> Result<(f64, DVector<f64>)> {
        let z = DVector::from_vec(posterior.line(start)?);
        let height = |z: &DVector<f64>| -> Result<f64> {
            let density = posterior.density(Point::Line(z.as_slice()))?;
            Ok(value(&density, density.natural()))
        };
        let mut best = (height(&z)?, z);
        for round in 0..12 {
            let before = best.0;
            let smooth = quasi_newton(posterior, &best.1);
            let spread = if round == 0 { 0.3 } else { 0.05 };
            for found in
                smooth.into_iter().chain(simplex(posterior, &best.1, spread))
            {
                let at = height(&found)?;
                if at > best.0 {
                    best = (at, found);
                }
            }
            let polished = simplex(posterior, &best.1, 0.5 * spread);
            if let Some(found) = polished {
                let at = height(&found)?;
                if at > best.0 {
                    best = (at, found);
                }
            }
            if best.0 - before < 1e-7 && round > 0 {
                break;
            }
        }
        Ok(best)
    }
}

/// L-BFGS from `start`; `None` where its line search fails.
fn quasi_newton(
    posterior: &Posterior<'_>,
    start: &DVector<f64>,
) -> Option<DVector<f64>> {
    let solver = LBFGS::new(MoreThuenteLineSearch::new(), 7);
    let run = Executor::new(Descent(posterior), solver)
        .configure(|state| state.param(start.clone()).max_iters(200))
        .run()
        .ok()?;
    run.state().get_best_param().cloned()
}

/// Nelder-Mead from a simplex of the given spread about `start`.
fn simplex(
    posterior: &Posterior<'_>,
    start: &DVector<f64>,
    spread: f64,
) -> Option<DVector<f64>> {
    let mut corners = vec![start.clone()];
    for i in 0..start.len() {
        let mut corner = start.clone();
        corner[i] += spread;
        corners.push(corner);
    }
    let solver = NelderMead::new(corners).with_sd_tolerance(1e-10).ok()?;
    let run = Executor::new(Descent(posterior), solver)
        .configure(|state| state.max_iters(400 * start.len() as u64))
        .run()
        .ok()?;
    run.state().get_best_param().cloned()
}

/// The covariance of a normal approximation at the mode, from central
/// differences of the exact gradient.
fn covariance(
    posterior: &Posterior<'_>,
    z: &DVector<f64>,
) -> Result<Option<DMatrix<f64>>> {
    let n = z.len();
    let mut hessian = DMatrix::zeros(n, n);
    let h = 1e-4;
    for j in 0..n {
        for side in [1.0, -1.0] {
            let mut at = z.clone();
            at[j] += side * h;
            let mut gradient = vec![0.0; n];
            posterior.gradient(
                at.as_slice(),
                Weights::NATURAL,
                &mut gradient,
            )?;
            for i in 0..n {
                hessian[(i, j)] -= side * gradient[i] / (2.0 * h);
            }
        }
    }
    let even: DMatrix<f64> = (&hessian + hessian.transpose()) * 0.5;
    Ok(even.cholesky().map(|c| c.inverse()))
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
        for i in 0..self.starts {
            let mut rng = seed.child(i as u64).rng();
            starts.push(best_start(posterior, &mut rng)?);
        }
        progress.begin("climbing", Some(starts.len() as u64));
        let mut ends = starts
            .par_iter()
            .map(|start| {
                let end = Self::climb(posterior, start);
                progress.advance(1);
                end
            })
            .collect::<Result<Vec<_>>>()?;
        ends.sort_by(|a, b| b.0.total_cmp(&a.0));
        let reached: Vec<f64> = ends.iter().map(|end| end.0).collect();
        let Some((log_density, line)) = ends.into_iter().next() else {
            return Err(Error::input("the search needs at least one start"));
        };
        let mode = Mode {
            natural: posterior.natural(line.as_slice())?,
            covariance: covariance(posterior, &line)?,
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
