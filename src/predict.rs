//! What a model predicts: bands of the flow alone and with its errors, and
//! recordings that it might have led to.

use rayon::prelude::*;

use crate::draws::{Draws, quantile};
use crate::error::{Error, Outcome, Result};
use crate::model::{Listener, Model, Point, Posterior, Replicates};
use crate::noise::Noise;
use crate::observe::Series;
use crate::prior::Prior;
use crate::scalar::{Plain, Real};
use crate::seed::{Rng, Seed};

/// A prediction over time: the median flow and 90 % bands about it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bands {
    /// Times, increasing \[s\].
    pub times: Vec<f64>,
    /// Median of the flow.
    pub median: Vec<f64>,
    /// 5 % quantile of the flow alone.
    pub flow_low: Vec<f64>,
    /// 95 % quantile of the flow alone.
    pub flow_high: Vec<f64>,
    /// 5 % quantile of the flow with errors.
    pub full_low: Vec<f64>,
    /// 95 % quantile of the flow with errors.
    pub full_high: Vec<f64>,
}

/// A flow's predictions and one replicate of the recording.
type Pair = (Vec<f64>, Vec<f64>);

/// Numbers kept at the most: what the bands are quantiles of.
const MOST_NUMBERS: usize = 20_000_000;

/// How many draws a band over `length` values is made of.
fn draws_for(length: usize) -> usize {
    (MOST_NUMBERS / length.max(1)).clamp(50, 2000)
}

/// The posterior predictive bands of the model's first series, whose times
/// \[s\] are given.
///
/// # Errors
/// A model that fails, or draws without a single flow.
pub fn posterior_predictive(
    posterior: &Posterior<'_>,
    draws: &Draws,
    times: &[f64],
    seed: Seed,
) -> Result<Bands> {
    let all = predictive_of_all(posterior, draws, &[times], seed)?;
    all.into_iter()
        .next()
        .ok_or_else(|| Error::inference("the model predicts no series"))
}

/// The same of each of the model's series, whose times \[s\] are given.
///
/// # Errors
/// As [`posterior_predictive`].
pub fn predictive_of_all(
    posterior: &Posterior<'_>,
    draws: &Draws,
    times: &[&[f64]],
    seed: Seed,
) -> Result<Vec<Bands>> {
    let length = times.iter().map(|t| t.len()).sum();
    let rows = draws.thinned(draws_for(length));
    let sets = rows
        .par_iter()
        .enumerate()
        .map(|(i, row)| {
            replicate(posterior, Point::Natural(row), seed.child(i as u64))
        })
        .collect::<Result<Vec<_>>>()?;
    let of = |k: usize| -> Vec<&Pair> {
        sets.iter().flatten().filter_map(|s| s.get(k)).collect()
    };
    let series = times.iter().enumerate();
    series.map(|(k, times)| bands(&of(k), times)).collect()
}

/// The same before any recording is seen: `count` draws from the prior.
///
/// # Errors
/// An improper prior, or a model that fails.
pub fn prior_predictive(
    posterior: &Posterior<'_>,
    count: usize,
    times: &[f64],
    seed: Seed,
) -> Result<Bands> {
    posterior.require_proper("a prior predictive band")?;
    let count = count.min(draws_for(times.len()));
    let pairs = (0..count as u64)
        .into_par_iter()
        .map(|i| {
            let mut rng = seed.child(i).rng();
            let all =
                replicate(posterior, Point::Prior(&mut rng), seed.child(i))?;
            Ok(all.and_then(|all| all.into_iter().next()))
        })
        .collect::<Result<Vec<_>>>()?;
    bands(&pairs.iter().flatten().collect::<Vec<_>>(), times)
}

/// The flow at a point and one replicate of each recording; `None` where the
/// model rejects the point.
fn replicate(
    posterior: &Posterior<'_>,
    point: Point<'_>,
    seed: Seed,
) -> Result<Option<Vec<Pair>>> {
    let model: &dyn Model = posterior.model();
    let mut rng = seed.child(1).rng();
    let mut heard =
        Predicted { flows: Vec::new(), replicates: Replicates::new(&mut rng) };
    let density = model.evaluate(point, Some(&mut heard))?;
    let Predicted { flows, replicates } = heard;
    let pairs = || flows.into_iter().zip(replicates.series).collect();
    Ok(density.rejected.is_none().then(pairs))
}

/// Hears what a model predicts for each series, and draws a replicate of it.
struct Predicted<'a> {
    flows: Vec<Vec<f64>>,
    replicates: Replicates<'a>,
}

impl Listener<Plain> for Predicted<'_> {
    fn series(
        &mut self,
        series: &Series,
        residuals: &[Real<Plain>],
        noise: &dyn Noise<Plain>,
    ) -> Outcome {
        let values = series.values().iter();
        let flow = values.zip(residuals).map(|(v, r)| v - r.value());
        self.flows.push(flow.collect());
        self.replicates.series(series, residuals, noise)
    }

    fn element(
        &mut self,
        value: f64,
        log_density: Real<Plain>,
        distribution: &dyn Prior<Plain>,
    ) {
        self.replicates.element(value, log_density, distribution);
    }
}

fn bands(pairs: &[&Pair], times: &[f64]) -> Result<Bands> {
    if pairs.is_empty() {
        return Err(Error::inference("no draw has a flow to predict with"));
    }
    let mut result = Bands { times: times.to_vec(), ..Bands::default() };
    let mut flow = vec![0.0; pairs.len()];
    let mut full = flow.clone();
    for i in 0..times.len() {
        for (k, (f, r)) in pairs.iter().enumerate() {
            (flow[k], full[k]) = (f[i], r[i]);
        }
        flow.sort_by(f64::total_cmp);
        full.sort_by(f64::total_cmp);
        result.median.push(quantile(&flow, 0.5));
        result.flow_low.push(quantile(&flow, 0.05));
        result.flow_high.push(quantile(&flow, 0.95));
        result.full_low.push(quantile(&full, 0.05));
        result.full_high.push(quantile(&full, 0.95));
    }
    Ok(result)
}

impl Bands {
    /// The share of the values inside the band with errors.
    pub fn coverage(&self, values: &[f64]) -> f64 {
        let band = self.full_low.iter().zip(&self.full_high);
        let inside = values
            .iter()
            .zip(band)
            .filter(|(v, (low, high))| (*low..=*high).contains(v))
            .count();
        inside as f64 / values.len() as f64
    }

    /// The root mean square of values minus median flow.
    pub fn rmse(&self, values: &[f64]) -> f64 {
        rmse(values, &self.median)
    }
}

/// The root mean square of values minus predictions.
pub(crate) fn rmse(values: &[f64], predicted: &[f64]) -> f64 {
    let squares = values.iter().zip(predicted).map(|(v, p)| (v - p).powi(2));
    (squares.sum::<f64>() / values.len() as f64).sqrt()
}

/// Synthetic recordings: what each series of the model might have shown if
/// its parameters had the values `truth`. The series say when; the values
/// that they hold are not looked at.
///
/// ```
/// use couloir::prelude::*;
/// model! {
///     struct Dry { event: Event }
///     friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
///     errors ~ Iid { sigma2: InverseGamma(3.0, 1.0) };
///     likelihood {
///         let flow = event.slide(&friction)?;
///         event.velocity ~ flow.velocity() + errors;
///     }
/// }
/// let plan = Event::on(Track::incline(35.0, 500.0)?)
///     .velocity(Series::velocity(vec![1.0, 2.0, 3.0], vec![0.0; 3])?)
///     .build()?;
/// let seen = simulate(&Dry::new(plan.clone()), &[0.3, 0.01], Seed::new(1))?;
/// let event = plan.with_recording(seen[0].clone())?;
/// assert!((event.velocity.values()[2] - 9.65).abs() < 0.5);
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// Values with which there is no flow or noise.
pub fn simulate(
    model: &dyn Model,
    truth: &[f64],
    seed: Seed,
) -> Result<Vec<Series>> {
    let mut rng = seed.rng();
    let mut made = Made { rng: &mut rng, series: Vec::new() };
    let density = model.evaluate(Point::Natural(truth), Some(&mut made))?;
    match density.rejected {
        None => Ok(made.series),
        Some(reason) => Err(Error::input(format!(
            "nothing can be simulated with the values {truth:?}: {reason}"
        ))),
    }
}

/// Collects synthetic series.
struct Made<'a> {
    rng: &'a mut Rng,
    series: Vec<Series>,
}

impl Listener<Plain> for Made<'_> {
    fn series(
        &mut self,
        series: &Series,
        residuals: &[Real<Plain>],
        noise: &dyn Noise<Plain>,
    ) -> Outcome {
        let mut one = Replicates::new(self.rng);
        one.series(series, residuals, noise)?;
        let values = one.series.into_iter().flatten().collect();
        self.series.push(series.with_values(values)?);
        Ok(())
    }
}
