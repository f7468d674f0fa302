//! A density with two peaks, and proposals for it, for tests.

use nalgebra::{DMatrix, DVector};

use crate::error::Outcome;
use crate::infer::adapt::Frozen;
use crate::infer::proposal::Mixture;
use crate::model::{Label, Number, Program, Run};
use crate::prior::{AnyPrior, Normal};
use crate::scalar::Real;

/// 1 was seen of N(x^2, 0.45), with x ~ N(1, 0.8): a hill near 1, and one near
/// -1 that is 3 lower in ln, with a saddle of a twelfth between them. No data
/// are of y ~ N(0, 1).
pub(crate) struct Hills;

impl Program for Hills {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let prior = AnyPrior::Normal(1.0, 0.8);
        let x = run.scalar(Label::new("x", "1"), prior)?;
        run.observe_each(&1.0, Normal::new(x * x, Real::new(0.45)))?;
        run.scalar(Label::new("y", "1"), AnyPrior::Normal(0.0, 1.0))?;
        Ok(())
    }
}

/// A proposal for the hill about a place only, that has learned nothing.
pub(crate) fn proposal_for_hill(x: f64) -> Frozen {
    let mean = DVector::from_vec(vec![x, 0.0]);
    // The likelihood's width, 0.45/2.
    let covariance =
        DMatrix::from_diagonal(&DVector::from_vec(vec![0.225 * 0.225, 1.0]));
    Frozen::new(Mixture::of([(1.0, mean, covariance)].into_iter()).unwrap())
}
