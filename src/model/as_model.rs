//! From a program to a model: the one run, asked in different ways.

use super::information::{Information, information};
use super::listener::Listener;
use super::number::Number;
use super::program::{Density, Point, Program, Weights, run};
use super::run::Source;
use crate::error::{Error, Result};
use crate::scalar::{Grad, Plain};

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
}

impl<P: Program> Model for P {
    fn evaluate(
        &self,
        point: Point<'_>,
        listener: Option<&mut dyn Listener<Plain>>,
    ) -> Result<Density> {
        let (source, expected) = match point {
            Point::Line(z) => (Source::Line { z, first: 0 }, Some(z.len())),
            Point::Natural(x) => (Source::Natural { x }, Some(x.len())),
            Point::Prior(rng) => (Source::Prior { rng }, None),
            Point::Middle => (Source::Middle, None),
        };
        let (density, ..) = run::<Plain, P>(self, source, expected, listener)?;
        Ok(density)
    }

    fn gradient(
        &self,
        z: &[f64],
        weights: Weights,
        gradient: &mut [f64],
    ) -> Result<Density> {
        match z.len() {
            0..=2 => pass::<Grad<2>, P>(self, z, weights, gradient),
            3..=4 => pass::<Grad<4>, P>(self, z, weights, gradient),
            _ => pass::<Grad<8>, P>(self, z, weights, gradient),
        }
    }

    fn information(&self, z: &[f64]) -> Result<Information> {
        information(self, z)
    }
}

/// The gradient, as many directions at a time as the kind carries.
fn pass<K: Number, P: Program>(
    program: &P,
    z: &[f64],
    weights: Weights,
    gradient: &mut [f64],
) -> Result<Density> {
    let mut density = None;
    let mut first = 0;
    loop {
        let source = Source::Line { z, first };
        let (found, prior, jacobian, likelihood) =
            run::<K, P>(program, source, Some(z.len()), None)?;
        let total = prior * weights.prior
            + jacobian * weights.jacobian
            + likelihood * weights.likelihood;
        for (i, slot) in gradient.iter_mut().skip(first).enumerate() {
            if i < K::DIRECTIONS {
                *slot = total.partial(i);
            }
        }
        let slides = density.map_or(0, |d: Density| d.slides) + found.slides;
        let zero = found.rejected.is_some();
        density = Some(Density { slides, ..found });
        first += K::DIRECTIONS;
        if first >= z.len() || zero {
            break;
        }
    }
    density.ok_or_else(|| Error::inference("the model has no parameters"))
}
