//! A fitted model's figures: how it predicts what was recorded.

use super::fit::Fit;
use crate::change::Mechanism;
use crate::draws::{self, Draws};
use crate::elpd::leave_one_out;
use crate::error::{Error, Result};
use crate::infer::{Backend, Peaks, Quiet, climb};
use crate::model::{Point, Posterior, Program, With};
use crate::observe::{Event, Quantity};
use crate::predict::{Bands, posterior_predictive};
use crate::seed::Seed;

/// A model to be shown: what is added, how it was fitted, and a seed.
pub(super) struct Shown<'a> {
    pub(super) mechanisms: Vec<&'a dyn Mechanism>,
    pub(super) fit: &'a Fit,
    pub(super) first: Seed,
    /// Whether one climb has to do for the held-out stretch: the force of
    /// free form has too many unknowns for more.
    pub(super) rough: bool,
}

impl Shown<'_> {
    pub(super) fn names(&self) -> Vec<String> {
        self.mechanisms.iter().map(|m| m.name().to_owned()).collect()
    }
}

/// The figures of one fitted model.
#[derive(Debug, Clone, Default)]
pub(super) struct Figures {
    pub(super) rmse: f64,
    pub(super) elpd: f64,
    pub(super) heldout_rmse: f64,
    pub(super) coverage90: f64,
    pub(super) ljung_box_p: f64,
    pub(super) innovations: Vec<f64>,
    pub(super) bands: Bands,
    /// Where the mass is at the recorded times, on the shared axis [m].
    pub(super) places: Vec<f64>,
}

/// The share of the values that the held-out stretch is predicted from.
const KNOWN: f64 = 0.7;

/// The figures of a model on its event's first recording.
pub(super) fn show<P: Program>(
    program: &P,
    event: &Event,
    shown: &Shown<'_>,
) -> Result<Figures> {
    let series = event
        .recordings()
        .next()
        .ok_or_else(|| Error::input("the event has no recording"))?;
    let with = With::new(program, &shown.mechanisms);
    let posterior = Posterior::new(&with)?;
    let draws = &shown.fit.draws;
    let seed = shown.first;
    let bands = posterior_predictive(&posterior, draws, series.times(), seed)?;
    let (_, found) = posterior.collect(Point::Line(&shown.fit.best))?;
    let innovations = found.innovations.into_iter().next().unwrap_or_default();
    let lags = (innovations.len() / 5).clamp(1, 10);
    let predicted = mean_prediction(&posterior, draws)?;
    Ok(Figures {
        rmse: rmse(series.values(), &predicted),
        elpd: leave_one_out(&posterior, draws).map_or(f64::NAN, |l| l.elpd),
        heldout_rmse: held_out(program, shown, series.values())?,
        coverage90: bands.coverage(series.values()),
        ljung_box_p: draws::ljung_box(&innovations, lags, 0)
            .map_or(f64::NAN, |test| test.p),
        places: places(event, series.quantity(), series.times(), &predicted),
        innovations,
        bands,
    })
}

/// Draws of all chains, thinned to a few hundred.
pub(super) fn rows_of(draws: &Draws) -> Vec<&[f64]> {
    draws.thinned(400)
}

/// The posterior mean of what is predicted for each value.
fn mean_prediction(
    posterior: &Posterior<'_>,
    draws: &Draws,
) -> Result<Vec<f64>> {
    let mut sum: Vec<f64> = Vec::new();
    let mut count = 0.0;
    for row in rows_of(draws) {
        let (density, found) = posterior.collect(Point::Natural(row))?;
        let Some(predicted) = found.predictions.into_iter().next() else {
            continue;
        };
        if density.rejected.is_some() {
            continue;
        }
        sum.resize(predicted.len(), 0.0);
        sum.iter_mut().zip(predicted).for_each(|(s, p)| *s += p);
        count += 1.0;
    }
    Ok(sum.into_iter().map(|s| s / count).collect())
}

fn rmse(values: &[f64], predicted: &[f64]) -> f64 {
    let squares: f64 =
        values.iter().zip(predicted).map(|(v, p)| (v - p).powi(2)).sum();
    (squares / values.len().max(1) as f64).sqrt()
}

/// The RMSE over the last values, of the model fitted to those before.
fn held_out<P: Program>(
    program: &P,
    shown: &Shown<'_>,
    values: &[f64],
) -> Result<f64> {
    let known = ((KNOWN * values.len() as f64) as usize).max(1);
    if known >= values.len() {
        return Ok(f64::NAN);
    }
    let with = With::new(program, &shown.mechanisms).knowing(known);
    let posterior = Posterior::new(&with)?;
    let plain = With::new(program, &shown.mechanisms);
    let whole = Posterior::new(&plain)?;
    if shown.rough {
        let Some(peak) = climb(&posterior, &shown.fit.best)? else {
            return Ok(f64::NAN);
        };
        let (_, found) = whole.collect(Point::Line(peak.line.as_slice()))?;
        let predicted = found.predictions.into_iter().next();
        return Ok(predicted.map_or(f64::NAN, |predicted| {
            rmse(&values[known..], &predicted[known.min(predicted.len())..])
        }));
    }
    let search = Peaks {
        starts: 6,
        from: vec![shown.fit.best.clone()],
        draws: 1000,
        ..Peaks::default()
    };
    let found = search.explore(&posterior, shown.first.child(1), &Quiet)?;
    let Some(draws) = found.draws else { return Ok(f64::NAN) };
    let predicted = mean_prediction(&whole, &draws)?;
    Ok(rmse(&values[known..], &predicted[known.min(predicted.len())..]))
}

/// Where the mass is at the recorded times: the predicted speeds summed by
/// the trapezoidal rule, or the predicted positions.
fn places(
    event: &Event,
    quantity: Quantity,
    times: &[f64],
    predicted: &[f64],
) -> Vec<f64> {
    let start = event.track().origin() + event.start();
    if quantity == Quantity::Position {
        return predicted.iter().map(|s| start + s).collect();
    }
    let (mut time, mut speed) = (0.0, event.release_speed());
    let mut place = start;
    times
        .iter()
        .zip(predicted)
        .map(|(&t, &p)| {
            let next = match quantity {
                Quantity::Acceleration => speed + p * (t - time),
                _ => p,
            };
            place += 0.5 * (speed + next) * (t - time);
            (time, speed) = (t, next);
            place
        })
        .collect()
}
