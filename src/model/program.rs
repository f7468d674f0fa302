//! Programs, and models as backends see them.

use super::density::{Density, Weights};
use super::information::Information;
use super::listener::Listener;
use super::number::Number;
use super::run::Run;
use crate::error::{Outcome, Result};
use crate::scalar::Plain;
use crate::seed::Rng;

/// A model's body: declares parameters, scores data.
///
/// Written by the `model!` macro, or by hand as in the example
/// `without_the_macro`.
pub trait Program: Sync {
    /// Runs the body.
    ///
    /// # Errors
    /// [`Stop::Reject`](crate::error::Stop::Reject) gives the point density
    /// zero, [`Stop::Fail`](crate::error::Stop::Fail) ends the inference.
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome;

    /// How many events the body passes to [`Run::of_event`], where inference
    /// may take them apart: what they have in common is declared before the
    /// first of them, and all data are scored within them.
    fn events(&self) -> usize {
        1
    }

    /// The same model with another noise, by the name that event files give
    /// it; `None` where the noise is written into the body, as `model!` does.
    ///
    /// # Errors
    /// A name that no noise has.
    fn with_noise(&self, _name: &str) -> Result<Option<Self>>
    where
        Self: Sized,
    {
        Ok(None)
    }
}

/// A point at which a model is evaluated.
#[derive(Debug)]
pub enum Point<'a> {
    /// Places on the real line, one for each parameter.
    Line(&'a [f64]),
    /// The parameters' values as named.
    Natural(&'a [f64]),
    /// A draw from the prior.
    Prior(&'a mut Rng),
    /// The middle of each parameter's support, to learn what there is.
    Middle,
}

/// A model as backends see it. Implemented for every [`Program`].
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

    /// The same along one coordinate alone.
    ///
    /// # Errors
    /// As [`Model::evaluate`].
    fn information_along(
        &self,
        z: &[f64],
        coordinate: usize,
    ) -> Result<Information> {
        Ok(self.information(z)?.of_some(&[coordinate]))
    }
}
