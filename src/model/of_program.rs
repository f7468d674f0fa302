//! Every program is a model: the one run, asked in different ways.

use super::density::{Density, Weights};
use super::information::Information;
use super::listener::Listener;
use super::pass::run;
use super::program::{Model, Point, Program};
use super::run::Source;
use super::{fisher, gradient};
use crate::error::Result;
use crate::scalar::Plain;

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
        gradient::gradient(self, z, weights, gradient)
    }

    fn information(&self, z: &[f64]) -> Result<Information> {
        fisher::information(self, z, 0..z.len())
    }

    fn information_along(
        &self,
        z: &[f64],
        coordinate: usize,
    ) -> Result<Information> {
        fisher::information(self, z, coordinate..coordinate + 1)
    }
}
