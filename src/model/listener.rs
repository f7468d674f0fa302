//! Who listens to a run: names, pointwise likelihood, replicates.

use super::label::Label;
use crate::error::{Outcome, Stop};
use crate::noise::{Noise, Stationary};
use crate::observe::Series;
use crate::prior::{Distribution, Prior};
use crate::scalar::{Kind, Plain, Real};
use crate::seed::Rng;

/// A parameter as the body declares it.
#[derive(Clone, Copy)]
pub struct Declaration<'a, K: Kind> {
    /// Its name and unit.
    pub label: &'a Label<'a>,
    /// Its value in this run.
    pub value: f64,
    /// Its prior, given the parameters above it.
    pub prior: &'a dyn Prior<K>,
}

impl<K: Kind> std::fmt::Debug for Declaration<'_, K> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} = {}", self.label.name(), self.value)
    }
}

/// Hears what happens in a run; every method may be left out.
pub trait Listener<K: Kind> {
    /// A parameter was declared.
    fn parameter(&mut self, _declaration: &Declaration<'_, K>) {}

    /// A block, a noise or a mechanism of this name was declared.
    fn block(&mut self, _name: &str) {}

    /// Whether all was heard that was wanted: the run then ends after the
    /// parameter just declared, as one that is rejected.
    fn has_heard_enough(&self) -> bool {
        false
    }

    /// A series was compared: residuals are recorded minus predicted.
    ///
    /// # Errors
    /// Whatever should stop the run.
    fn series(
        &mut self,
        _series: &Series,
        _residuals: &[Real<K>],
        _noise: &dyn Noise<K>,
    ) -> Outcome {
        Ok(())
    }

    /// The log likelihood of the series just heard, where that was found on
    /// the way: it is then not computed again.
    fn log_likelihood(&mut self) -> Option<Real<K>> {
        None
    }

    /// Whether data are scored: what replaces them asks for no density of
    /// what stands there.
    fn scores(&self) -> bool {
        true
    }

    /// What stands in the place of the value just met, where the listener
    /// replaces data.
    fn made(&self) -> Option<f64> {
        None
    }

    /// One value was scored by itself.
    fn element(
        &mut self,
        _value: f64,
        _log_density: Real<K>,
        _distribution: &dyn Distribution<K>,
    ) {
    }

    /// A datum was scored of which the model knows no distribution.
    fn increment(&mut self, _log_density: Real<K>) {}

    /// A quantity was worked out or drawn that is to be kept.
    fn kept(&mut self, _label: &Label<'_>, _value: f64) {}

    /// Where draws that are to be kept come from; without it, none are made.
    fn chance(&mut self) -> Option<&mut Rng> {
        None
    }
}

impl<K: Kind> std::fmt::Debug for dyn Listener<K> + '_ {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Listener")
    }
}

/// What one run said of the model at one point.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Collected {
    /// The parameters' names.
    pub names: Vec<String>,
    /// Their units.
    pub units: Vec<String>,
    /// Their values as named.
    pub natural: Vec<f64>,
    /// Their places on the real line.
    pub line: Vec<f64>,
    /// Whether each prior is proper.
    pub proper: Vec<bool>,
    /// Where each prior is positive: lower and upper bound.
    pub bounds: Vec<(f64, f64)>,
    /// ln p of each datum given those before it.
    pub pointwise: Vec<f64>,
    /// What the model predicts for each value of each series.
    pub predictions: Vec<Vec<f64>>,
    /// Standardised innovations, series by series.
    pub innovations: Vec<Vec<f64>>,
    /// How large the errors of each series are, where they depend on those
    /// before them.
    pub stationary: Vec<Option<Stationary>>,
}

/// Collects everything at once.
#[derive(Debug, Default)]
pub struct Collector {
    /// What was collected.
    pub collected: Collected,
}

impl Listener<Plain> for Collector {
    fn parameter(&mut self, declaration: &Declaration<'_, Plain>) {
        let c = &mut self.collected;
        let support = declaration.prior.support();
        c.names.push(declaration.label.name());
        c.units.push(declaration.label.unit().to_owned());
        c.natural.push(declaration.value);
        c.line.push(support.to_line(declaration.value));
        c.proper.push(declaration.prior.is_proper());
        c.bounds.push(support.ends());
    }

    fn series(
        &mut self,
        series: &Series,
        residuals: &[Real<Plain>],
        noise: &dyn Noise<Plain>,
    ) -> Outcome {
        let c = &mut self.collected;
        let values = series.values().iter();
        let predicted = values.zip(residuals).map(|(v, r)| v - r.value());
        c.predictions.push(predicted.collect());
        let mut innovations = Vec::with_capacity(residuals.len());
        noise.walk(series.grid(), residuals, &mut |value| {
            c.pointwise.push(value.log_density.value());
            innovations.push(noise.standardise(value.deviate.value()));
        })?;
        c.innovations.push(innovations);
        c.stationary.push(noise.stationary());
        Ok(())
    }

    fn element(
        &mut self,
        _: f64,
        log_density: Real<Plain>,
        _: &dyn Distribution<Plain>,
    ) {
        self.collected.pointwise.push(log_density.value());
    }

    fn increment(&mut self, log_density: Real<Plain>) {
        self.collected.pointwise.push(log_density.value());
    }
}

/// The parameters' values and places, without a look at the data.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// How many parameters there are.
    pub(super) count: usize,
    /// Whether their names are heard too.
    pub(super) hears_names: bool,
    /// Their names.
    pub(super) names: Vec<String>,
    /// Their values as named.
    pub(super) natural: Vec<f64>,
    /// Their places on the real line.
    pub(super) line: Vec<f64>,
}

impl Listener<Plain> for Places {
    fn parameter(&mut self, declaration: &Declaration<'_, Plain>) {
        let support = declaration.prior.support();
        if self.hears_names {
            self.names.push(declaration.label.name());
        }
        self.natural.push(declaration.value);
        self.line.push(support.to_line(declaration.value));
    }

    fn has_heard_enough(&self) -> bool {
        self.natural.len() >= self.count
    }
}

/// Draws what might have been recorded instead: prediction plus noise.
#[derive(Debug)]
pub struct Replicates<'a> {
    rng: &'a mut Rng,
    /// One list of values for each series.
    pub series: Vec<Vec<f64>>,
    /// One value for each datum scored by itself.
    pub elements: Vec<f64>,
}

impl<'a> Replicates<'a> {
    /// With the generator that the errors are drawn from.
    pub fn new(rng: &'a mut Rng) -> Self {
        Self { rng, series: Vec::new(), elements: Vec::new() }
    }
}

impl Listener<Plain> for Replicates<'_> {
    fn series(
        &mut self,
        series: &Series,
        residuals: &[Real<Plain>],
        noise: &dyn Noise<Plain>,
    ) -> Result<(), Stop> {
        let errors = noise.draw(series.grid(), self.rng)?;
        let values = series.values().iter().zip(residuals).zip(errors);
        self.series
            .push(values.map(|((v, r), e)| v - r.value() + e).collect());
        Ok(())
    }

    fn element(
        &mut self,
        _: f64,
        _: Real<Plain>,
        distribution: &dyn Distribution<Plain>,
    ) {
        let draw = distribution.draw(self.rng).unwrap_or(f64::NAN);
        self.elements.push(draw);
    }
}
