//! Nelder and Mead's search by argmin: it asks for no gradient.

use std::cell::RefCell;

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;
use nalgebra::DVector;

use crate::error::{Error, Result};

/// What a rejected place costs: finite, so that a simplex can compare it.
pub(crate) const WALL: f64 = 1e12;

/// The least cost that a search from a simplex comes to, and where, when its
/// corners differ by less than the tolerance or after so many iterations;
/// `None` where the search fails.
///
/// # Errors
/// A model that fails.
pub(crate) fn descend<C>(
    problem: C,
    corners: Vec<DVector<f64>>,
    tolerance: f64,
    iterations: u64,
) -> Result<Option<(f64, DVector<f64>)>>
where
    C: CostFunction<Param = DVector<f64>, Output = f64>,
{
    let failure = RefCell::new(None);
    let problem = Costing { problem, failure: &failure };
    let run = NelderMead::new(corners).with_sd_tolerance(tolerance).and_then(
        |solver| {
            Executor::new(problem, solver)
                .configure(|state| state.max_iters(iterations))
                .run()
        },
    );
    if let Some(error) = failure.take() {
        return finished(Err(error));
    }
    let Some(run) = finished(run)? else { return Ok(None) };
    let state = run.state();
    let best = state.get_best_param().cloned();
    Ok(best.map(|place| (state.get_best_cost(), place)))
}

/// A cost that keeps the first failure to itself, as a wall: argmin's simplex
/// does not pass failures on but panics.
struct Costing<'f, C> {
    problem: C,
    failure: &'f RefCell<Option<argmin::core::Error>>,
}

impl<C> CostFunction for Costing<'_, C>
where
    C: CostFunction<Param = DVector<f64>, Output = f64>,
{
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, x: &DVector<f64>) -> Result<f64, argmin::core::Error> {
        if self.failure.borrow().is_some() {
            return Ok(WALL);
        }
        self.problem.cost(x).or_else(|error| {
            self.failure.replace(Some(error));
            Ok(WALL)
        })
    }
}

/// What a search came to; `None` where it failed by itself.
///
/// # Errors
/// That of a model that failed under way.
pub(crate) fn finished<T>(
    run: std::result::Result<T, argmin::core::Error>,
) -> Result<Option<T>> {
    match run {
        Ok(done) => Ok(Some(done)),
        Err(error) => match error.downcast::<Error>() {
            Ok(of_model) => Err(of_model),
            Err(_) => Ok(None),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// |x|, of a model that fails beyond 2.
    struct Failing;

    impl CostFunction for Failing {
        type Param = DVector<f64>;
        type Output = f64;

        fn cost(&self, x: &DVector<f64>) -> Result<f64, argmin::core::Error> {
            match x[0].abs() {
                far if far > 2.0 => Err(Error::system("too far").into()),
                near => Ok(near),
            }
        }
    }

    #[test]
    fn a_model_that_fails_ends_the_search_with_its_reason() {
        let corners = |x: [f64; 2]| x.map(|x| DVector::from_element(1, x));
        let from = |x| descend(Failing, corners(x).to_vec(), 1e-6, 100);
        let (least, _) = from([1.5, 0.5]).unwrap().unwrap();
        assert!(least < 1e-5, "{least}");
        let error = from([1.0, 3.0]).unwrap_err();
        assert_eq!(error.to_string(), "too far");
    }
}
