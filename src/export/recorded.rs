//! What a model compares with the data: its series, and the values that it
//! scores one by one.

use super::data::{Values, Variable};
use crate::error::{Outcome, Result};
use crate::model::Listener;
use crate::noise::Noise;
use crate::observe::Series;
use crate::prior::Distribution;
use crate::scalar::{Plain, Real};

/// One series, or all values that are scored by themselves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Recorded {
    /// What its variables are called.
    pub(super) name: String,
    pub(super) unit: String,
    /// What its values are, in words.
    about: String,
    /// The name of its dimension.
    pub(super) dimension: String,
    /// Times \[s\] for a series; none for values by themselves.
    times: Vec<f64>,
    pub(super) values: Vec<f64>,
    standard_errors: Vec<f64>,
}

/// Hears which data there are.
#[derive(Debug, Default)]
pub(super) struct Data {
    series: Vec<Recorded>,
    elements: Vec<f64>,
}

impl Listener<Plain> for Data {
    fn series(
        &mut self,
        series: &Series,
        _: &[Real<Plain>],
        _: &dyn Noise<Plain>,
    ) -> Outcome {
        let quantity = series.quantity();
        let alike = |one: &&Recorded| one.about.starts_with(quantity.name());
        let name = match self.series.iter().filter(alike).count() {
            0 => quantity.name().to_owned(),
            before => format!("{}_{}", quantity.name(), before + 1),
        };
        let errors = series.grid().standard_errors();
        self.series.push(Recorded {
            dimension: format!("{name}_time"),
            name,
            unit: quantity.unit().to_owned(),
            about: about(series),
            times: series.times().to_vec(),
            values: series.values().to_vec(),
            standard_errors: errors.map_or_else(Vec::new, <[f64]>::to_vec),
        });
        Ok(())
    }

    fn element(
        &mut self,
        value: f64,
        _: Real<Plain>,
        _: &dyn Distribution<Plain>,
    ) {
        self.elements.push(value);
    }
}

/// What the values of a series are.
fn about(series: &Series) -> String {
    let name = series.quantity().name();
    match series.window() {
        0.0 => format!("{name} at the time"),
        window => format!("{name}, mean over the last {window} s"),
    }
}

impl Data {
    /// All of them, the series first. A single series has the dimension
    /// `time`, several have one each.
    pub(super) fn all(mut self) -> Vec<Recorded> {
        if let [one] = self.series.as_mut_slice() {
            one.dimension = "time".to_owned();
        }
        if !self.elements.is_empty() {
            self.series.push(Recorded {
                name: "value".to_owned(),
                unit: "1".to_owned(),
                about: "values scored one by one".to_owned(),
                dimension: "value_dim_0".to_owned(),
                times: Vec::new(),
                values: self.elements,
                standard_errors: Vec::new(),
            });
        }
        self.series
    }
}

impl Recorded {
    /// How many values there are.
    pub(super) fn len(&self) -> usize {
        self.values.len()
    }

    /// What the places along its dimension are.
    pub(super) fn coordinate(&self) -> Result<Variable> {
        let (name, length) = (self.dimension.as_str(), self.len());
        if self.times.is_empty() {
            return Variable::counted(name, length);
        }
        let times = Values::Real(self.times.clone());
        let made = Variable::new(name, "s", &[(name, length)], times)?;
        Ok(made.about("time since the release"))
    }

    /// Its values as they were observed.
    pub(super) fn observed(&self) -> Result<Variable> {
        let shape = [(self.dimension.as_str(), self.len())];
        let values = Values::Real(self.values.clone());
        let made = Variable::new(&self.name, &self.unit, &shape, values)?;
        Ok(made.about(&self.about))
    }

    /// The standard errors of the values, where they are known.
    pub(super) fn errors(&self) -> Result<Option<Variable>> {
        if self.standard_errors.is_empty() {
            return Ok(None);
        }
        let shape = [(self.dimension.as_str(), self.len())];
        let values = Values::Real(self.standard_errors.clone());
        let name = format!("{}_sigma", self.name);
        let made = Variable::new(name, &self.unit, &shape, values)?;
        Ok(Some(made.about("standard error of the recorded value")))
    }
}
