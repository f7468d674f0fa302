//! A model as a backend works on it: dimension, names, and a count of every
//! evaluation.
//!
//! All evaluations of an inference pass through here, so that what a result
//! cost is counted in one place.

use std::collections::HashSet;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use nalgebra::DMatrix;

use super::density::{Density, Weights};
use super::face::{Model, Point};
use super::information::Information;
use super::listener::{Collected, Collector, Listener, Places};
use super::run::SAME_PARAMETERS;
use crate::error::{Error, Result};
use crate::scalar::Plain;
use crate::seed::Rng;

/// A parameter of a model.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its unit; "1" for a pure number.
    pub unit: String,
    /// The bounds of its prior's support, in the middle of those above it.
    pub bounds: (f64, f64),
}

/// What an inference cost.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Cost {
    /// Evaluations of the log density.
    pub densities: u64,
    /// Evaluations of its gradient.
    pub gradients: u64,
    /// Motions solved: the simulations.
    pub simulations: u64,
    /// Evaluations that found no flow or noise: density zero.
    pub rejections: u64,
    /// Wall-clock time \[s\].
    pub seconds: f64,
}

/// A posterior distribution to be explored.
pub struct Posterior<'m> {
    model: &'m dyn Model,
    parameters: Vec<Parameter>,
    /// The first parameter whose prior is improper.
    improper: Option<usize>,
    tally: Tally,
}

impl std::fmt::Debug for Posterior<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Posterior")
            .field("parameters", &self.parameters)
            .field("cost", &self.cost())
            .finish_non_exhaustive()
    }
}

impl<'m> Posterior<'m> {
    /// The posterior of a model.
    ///
    /// # Errors
    /// A model without parameters or with two of one name, and whatever the
    /// model itself fails with.
    pub fn new(model: &'m dyn Model) -> Result<Self> {
        let mut collector = Collector::default();
        model.evaluate(Point::Middle, Some(&mut collector))?;
        let found = collector.collected;
        if found.names.is_empty() {
            return Err(Error::input("the model has no parameters"));
        }
        let mut seen = HashSet::new();
        if let Some(name) = found.names.iter().find(|name| !seen.insert(*name))
        {
            return Err(Error::input(format!(
                "two parameters are called {name}; rename one"
            )));
        }
        let parts = found.names.into_iter().zip(found.units);
        Ok(Self {
            model,
            parameters: parts
                .zip(found.bounds)
                .map(|((name, unit), bounds)| Parameter { name, unit, bounds })
                .collect(),
            improper: found.proper.iter().position(|proper| !proper),
            tally: Tally::default(),
        })
    }

    /// The parameters, in the order declared.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// How many there are.
    pub fn dimension(&self) -> usize {
        self.parameters.len()
    }

    /// Whether every prior is proper, so that it can be drawn from and an
    /// evidence exists.
    pub fn is_proper(&self) -> bool {
        self.improper.is_none()
    }

    /// An input error unless every prior is proper.
    ///
    /// # Errors
    /// A flat prior.
    pub fn require_proper(&self, backend: &str) -> Result<()> {
        let Some(index) = self.improper else { return Ok(()) };
        Err(Error::input(format!(
            "{backend} needs proper priors, but that of {} is improper, as \
             Flat() is; give it one that integrates to 1, or use mh or map",
            self.parameters[index].name
        )))
    }

    /// The density at a point.
    ///
    /// # Errors
    /// What no other parameter values would mend.
    #[inline]
    pub fn density(&self, point: Point<'_>) -> Result<Density> {
        let density = self.model.evaluate(point, None)?;
        self.tally.count(DENSITIES, &density);
        Ok(density)
    }

    /// The density at a place on the real line with its gradient.
    ///
    /// # Errors
    /// As [`Posterior::density`].
    pub fn gradient(
        &self,
        z: &[f64],
        weights: Weights,
        gradient: &mut [f64],
    ) -> Result<Density> {
        let density = self.model.gradient(z, weights, gradient)?;
        self.tally.count(GRADIENTS, &density);
        Ok(density)
    }

    /// The density at a place on the real line to second order.
    ///
    /// # Errors
    /// As [`Posterior::density`].
    pub fn information(&self, z: &[f64]) -> Result<Information> {
        let information = self.model.information(z)?;
        self.tally.count(GRADIENTS, &information.density);
        Ok(information)
    }

    /// The same along some directions: rows of a matrix that has a column for
    /// each parameter. The gradient and the precision have an entry for each
    /// direction. Few of them cost less than all parameters.
    ///
    /// # Errors
    /// A matrix of another width, and as [`Posterior::density`].
    pub fn information_along(
        &self,
        z: &[f64],
        directions: &DMatrix<f64>,
    ) -> Result<Information> {
        let information = self.model.information_along(z, directions)?;
        self.tally.count(GRADIENTS, &information.density);
        Ok(information)
    }

    /// The density at a point, with a listener of one's own.
    ///
    /// # Errors
    /// As [`Posterior::density`].
    pub(crate) fn hear(
        &self,
        point: Point<'_>,
        listener: &mut dyn Listener<Plain>,
    ) -> Result<Density> {
        let density = self.model.evaluate(point, Some(listener))?;
        self.tally.count(DENSITIES, &density);
        Ok(density)
    }

    /// Everything that the model says at a point.
    ///
    /// # Errors
    /// As [`Posterior::density`].
    pub fn collect(&self, point: Point<'_>) -> Result<(Density, Collected)> {
        let mut collector = Collector::default();
        let density = self.model.evaluate(point, Some(&mut collector))?;
        self.tally.count(DENSITIES, &density);
        self.check_names(&collector.collected.names, &density)?;
        Ok((density, collector.collected))
    }

    /// Fails where a run declared other parameters than this posterior has;
    /// one that was rejected may have declared the first ones only.
    fn check_names(&self, found: &[String], density: &Density) -> Result<()> {
        let mut known = self.parameters.iter().map(|p| p.name.as_str());
        let mut found = found.iter().map(String::as_str);
        loop {
            return match (known.next(), found.next()) {
                (None, None) => Ok(()),
                (Some(_), None) if density.rejected.is_some() => Ok(()),
                (Some(name), Some(other)) if name == other => continue,
                (name, other) => Err(Error::input(format!(
                    "the model declared {} where it had {} before; \
                     {SAME_PARAMETERS}",
                    other.unwrap_or("no further parameter"),
                    name.unwrap_or("no further one"),
                ))),
            };
        }
    }

    /// The parameters' values at a place on the real line. No motion is
    /// solved for it.
    ///
    /// # Errors
    /// As [`Posterior::density`].
    pub fn natural(&self, z: &[f64]) -> Result<Vec<f64>> {
        self.places(Point::Line(z), false).map(|(_, found)| found.natural)
    }

    fn places(
        &self,
        point: Point<'_>,
        hears_names: bool,
    ) -> Result<(Density, Places)> {
        let count = self.dimension();
        let mut places = Places { count, hears_names, ..Places::default() };
        let density = self.model.evaluate(point, Some(&mut places))?;
        Ok((density, places))
    }

    /// The place on the real line of given values.
    ///
    /// # Errors
    /// Values outside the priors' supports, by name.
    pub fn line(&self, x: &[f64]) -> Result<Vec<f64>> {
        if x.len() != self.dimension() {
            return Err(Error::input(format!(
                "{} values for {} parameters",
                x.len(),
                self.dimension()
            )));
        }
        let (_, found) = self.places(Point::Natural(x), false)?;
        let outside = (0..x.len())
            .find(|&i| !found.line.get(i).is_some_and(|z| z.is_finite()));
        match outside {
            Some(i) => Err(Error::input(format!(
                "{} = {} lies outside its prior's support",
                self.parameters[i].name, x[i]
            ))),
            None => Ok(found.line),
        }
    }

    /// A draw from the prior, as a place on the real line.
    ///
    /// # Errors
    /// As [`Posterior::density`].
    pub fn draw_prior(&self, rng: &mut Rng) -> Result<(Density, Collected)> {
        self.collect(Point::Prior(rng))
    }

    /// The place of a draw from the prior on the real line; `None` where the
    /// model rejects it before all its parameters are known, as one of several
    /// events may. No motion is solved for it.
    ///
    /// # Errors
    /// As [`Posterior::density`].
    pub(crate) fn draw_place(
        &self,
        rng: &mut Rng,
    ) -> Result<Option<Vec<f64>>> {
        self.placed(Point::Prior(rng))
    }

    /// The same given some values as named; those that are NaN are drawn.
    ///
    /// # Errors
    /// As [`Posterior::density`].
    pub(crate) fn draw_place_given(
        &self,
        known: &[f64],
        rng: &mut Rng,
    ) -> Result<Option<Vec<f64>>> {
        self.placed(Point::PriorGiven(known, rng))
    }

    fn placed(&self, point: Point<'_>) -> Result<Option<Vec<f64>>> {
        let (density, found) = self.places(point, true)?;
        self.check_names(&found.names, &density)?;
        let line = found.line;
        let is_whole = line.len() == self.dimension()
            && line.iter().all(|z| z.is_finite());
        Ok(is_whole.then_some(line))
    }

    /// The model itself, for listeners of one's own.
    pub fn model(&self) -> &'m dyn Model {
        self.model
    }

    /// What has been spent so far, without the time.
    pub fn cost(&self) -> Cost {
        Cost {
            densities: self.tally.sum(DENSITIES),
            gradients: self.tally.sum(GRADIENTS),
            simulations: self.tally.sum(SIMULATIONS),
            rejections: self.tally.sum(REJECTIONS),
            seconds: 0.0,
        }
    }
}

const DENSITIES: usize = 0;
const GRADIENTS: usize = 1;
const SIMULATIONS: usize = 2;
const REJECTIONS: usize = 3;

/// Counts of evaluations. Each thread counts on a stripe of its own, two
/// cache lines apart from the next, so that threads do not wait for a line
/// that another one writes.
#[derive(Default)]
struct Tally {
    stripes: [Stripe; 16],
}

#[derive(Default)]
#[repr(align(128))]
struct Stripe([AtomicU64; 4]);

impl Tally {
    #[inline]
    fn count(&self, calls: usize, density: &Density) {
        let thread = rayon::current_thread_index().unwrap_or(0);
        let Stripe(counts) = &self.stripes[thread % self.stripes.len()];
        counts[calls].fetch_add(1, Relaxed);
        counts[SIMULATIONS].fetch_add(density.slides, Relaxed);
        if density.rejected.is_some() {
            counts[REJECTIONS].fetch_add(1, Relaxed);
        }
    }

    fn sum(&self, which: usize) -> u64 {
        self.stripes.iter().map(|s| s.0[which].load(Relaxed)).sum()
    }
}
