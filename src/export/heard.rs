//! What a model says at one draw: how likely it makes each datum, and what
//! might have been recorded instead.

use crate::error::{Outcome, Result};
use crate::model::{Declaration, Listener, Point, Posterior, Replicates};
use crate::noise::Noise;
use crate::observe::Series;
use crate::prior::Distribution;
use crate::scalar::{Plain, Real};
use crate::seed::Seed;

/// The data's places are those of the series, one after another, and of the
/// values scored by themselves after them.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Heard {
    /// The values of the parameters as named.
    pub(super) parameters: Vec<f64>,
    /// ln(prior x likelihood), in the parameters as named.
    pub(super) log_posterior: f64,
    /// ln p of each datum given those before it.
    pub(super) log_likelihood: Vec<f64>,
    /// A replicate of each datum.
    pub(super) replicate: Vec<f64>,
}

/// Listens to one run of the model.
struct Ear<'a> {
    parameters: Vec<f64>,
    series: Vec<f64>,
    elements: Vec<f64>,
    replicates: Replicates<'a>,
}

impl Listener<Plain> for Ear<'_> {
    fn parameter(&mut self, declaration: &Declaration<'_, Plain>) {
        self.parameters.push(declaration.value);
    }

    fn series(
        &mut self,
        series: &Series,
        residuals: &[Real<Plain>],
        noise: &dyn Noise<Plain>,
    ) -> Outcome {
        noise.walk(series.grid(), residuals, &mut |value| {
            self.series.push(value.log_density.value());
        })?;
        self.replicates.series(series, residuals, noise)
    }

    fn element(
        &mut self,
        value: f64,
        log_density: Real<Plain>,
        distribution: &dyn Distribution<Plain>,
    ) {
        self.elements.push(log_density.value());
        self.replicates.element(value, log_density, distribution);
    }
}

/// Where a draw comes from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Origin<'a> {
    /// A posterior draw: the parameters as named.
    Row(&'a [f64]),
    /// The prior.
    Prior,
}

/// What the model says at a draw; `None` where it rejects it.
pub(super) fn hear(
    posterior: &Posterior<'_>,
    from: Origin<'_>,
    seed: Seed,
) -> Result<Option<Heard>> {
    let mut prior = seed.child(0).rng();
    let mut errors = seed.child(1).rng();
    let mut ear = Ear {
        parameters: Vec::with_capacity(posterior.dimension()),
        series: Vec::new(),
        elements: Vec::new(),
        replicates: Replicates::new(&mut errors),
    };
    let point = match from {
        Origin::Row(row) => Point::Natural(row),
        Origin::Prior => Point::Prior(&mut prior),
    };
    let density = posterior.hear(point, &mut ear)?;
    if density.rejected.is_some() {
        return Ok(None);
    }
    let Ear { parameters, series, elements, replicates } = ear;
    let replicate = [replicates.series.concat(), replicates.elements].concat();
    Ok(Some(Heard {
        parameters,
        log_posterior: density.natural(),
        log_likelihood: [series, elements].concat(),
        replicate,
    }))
}
