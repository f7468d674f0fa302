//! Every program is a model: the one run, asked in different ways; and one of
//! any type, which is a program again.

use nalgebra::DMatrix;

use super::along::Along;
use super::any_program::{AnyProgram, RunOf};
use super::density::{Density, Weights};
use super::face::{Model, Point};
use super::information::Information;
use super::listener::Listener;
use super::number::Number;
use super::pass::run;
use super::program::Program;
use super::run::{Run, Source};
use super::{fisher, gradient};
use crate::error::{Outcome, Result};
use crate::scalar::Plain;

impl<P: Program> Model for P {
    fn evaluate(
        &self,
        point: Point<'_>,
        listener: Option<&mut dyn Listener<Plain>>,
    ) -> Result<Density> {
        let (source, expected) = match point {
            Point::Line(z) => {
                let along = Along::COORDINATES;
                (Source::Line { z, along }, Some(z.len()))
            }
            Point::Natural(x) => (Source::Natural { x }, Some(x.len())),
            Point::Prior(rng) => (Source::Prior { rng, known: &[] }, None),
            Point::PriorGiven(known, rng) => {
                (Source::Prior { rng, known }, None)
            }
            Point::Middle => (Source::Middle, None),
        };
        let (density, ..) = run::<Plain>(self, source, expected, listener)?;
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
        fisher::information(self, z, Along::COORDINATES)
    }

    fn information_along(
        &self,
        z: &[f64],
        directions: &DMatrix<f64>,
    ) -> Result<Information> {
        fisher::information(self, z, Along::rows(directions, z.len())?)
    }
}

impl<K: Number, P: Program> RunOf<K> for P {
    fn run_of(&self, run: &mut Run<'_, K>) -> Outcome {
        self.run(run)
    }
}

impl<P: Program> AnyProgram for P {
    fn count_of_events(&self) -> usize {
        self.events()
    }

    fn under_noise<'s>(
        &'s self,
        name: &str,
    ) -> Result<Option<Box<dyn AnyProgram + 's>>> {
        let other = self.with_noise(name)?;
        Ok(other.map(|other| Box::new(other) as Box<dyn AnyProgram + 's>))
    }
}

impl Program for dyn AnyProgram + '_ {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        K::run_any(self, run)
    }

    fn events(&self) -> usize {
        self.count_of_events()
    }
}
