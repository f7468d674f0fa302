//! Models as backends see them.

use nalgebra::DMatrix;

use super::along::check_width;
use super::density::{Density, Weights};
use super::information::Information;
use super::listener::Listener;
use crate::error::Result;
use crate::scalar::Plain;
use crate::seed::Rng;

/// A point at which a model is evaluated.
#[derive(Debug)]
pub enum Point<'a> {
    /// Places on the real line, one for each parameter.
    Line(&'a [f64]),
    /// The parameters' values as named.
    Natural(&'a [f64]),
    /// A draw from the prior.
    Prior(&'a mut Rng),
    /// The same given some values as named; those that are NaN are drawn.
    PriorGiven(&'a [f64], &'a mut Rng),
    /// The middle of each parameter's support, to learn what there is.
    Middle,
}

/// A model as backends see it. Implemented for every
/// [`Program`](super::Program).
pub trait Model: Sync {
    /// The density at a point; a listener hears the run.
    ///
    /// # Errors
    /// What no other parameter values would mend.
    fn evaluate(
        &self,
        point: Point<'_>,
        listener: Option<&mut dyn Listener<Plain>>,
    ) -> Result<Density>;

    /// The density at a place on the real line, and the gradient of its
    /// weighted logarithm there, exact to round-off.
    ///
    /// # Errors
    /// As [`Model::evaluate`].
    fn gradient(
        &self,
        z: &[f64],
        weights: Weights,
        gradient: &mut [f64],
    ) -> Result<Density>;

    /// The density at a place on the real line to second order, from first
    /// derivatives.
    ///
    /// # Errors
    /// As [`Model::evaluate`].
    fn information(&self, z: &[f64]) -> Result<Information>;

    /// The same along some directions: rows of a matrix that has a column for
    /// each coordinate. The gradient and the precision have an entry for each
    /// direction.
    ///
    /// # Errors
    /// A matrix of another width, and as [`Model::evaluate`].
    fn information_along(
        &self,
        z: &[f64],
        directions: &DMatrix<f64>,
    ) -> Result<Information> {
        check_width(directions, z.len())?;
        Ok(self.information(z)?.along(directions))
    }
}
