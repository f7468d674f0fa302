//! Nelder and Mead's search by argmin: it asks for no gradient.

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;
use nalgebra::DVector;

/// What a rejected place costs: finite, so that a simplex can compare it.
pub(crate) const WALL: f64 = 1e12;

/// The least cost that a search from a simplex comes to, and where, when its
/// corners differ by less than the tolerance or after so many iterations;
/// `None` where the search fails.
pub(crate) fn descend<C>(
    problem: C,
    corners: Vec<DVector<f64>>,
    tolerance: f64,
    iterations: u64,
) -> Option<(f64, DVector<f64>)>
where
    C: CostFunction<Param = DVector<f64>, Output = f64>,
{
    let solver = NelderMead::new(corners).with_sd_tolerance(tolerance).ok()?;
    let run = Executor::new(problem, solver)
        .configure(|state| state.max_iters(iterations))
        .run()
        .ok()?;
    let state = run.state();
    Some((state.get_best_cost(), state.get_best_param()?.clone()))
}
