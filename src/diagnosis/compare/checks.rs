//! Checks of a fitted model: how it predicts what was recorded.

use std::f64::consts::LN_10;

use crate::diagnosis::compare::least_squares::least_squares;
use crate::diagnosis::evidence::apart::estimate;
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::findings::{BeforeAfter, Improvement, Pictured};
use crate::draws::{Draws, median, uncorrelated_p};
use crate::elpd::leave_one_out;
use crate::error::Result;
use crate::infer::{LaplaceMixture, Precision, SearchSpace, climb};
use crate::mechanism::Mechanism;
use crate::model::{AnyProgram, ByEvent, Point, Posterior, With};
use crate::noise::Stationary;
use crate::observe::{Event, Quantity, Series};
use crate::predict::{Bands, predictive_of_all, rmse};
use crate::seed::Seed;

/// A fitted model to be checked: what is added to the program, and a seed.
pub(crate) struct FittedModel<'a> {
    pub(crate) mechanisms: Vec<&'a dyn Mechanism>,
    pub(crate) fit: &'a Fit,
    pub(crate) first: Seed,
    /// Whether one climb has to do for the held-out stretch: the force of
    /// free form has too many unknowns for more.
    pub(crate) rough: bool,
}

impl FittedModel<'_> {
    pub(crate) fn names(&self) -> Vec<String> {
        self.mechanisms.iter().map(|m| m.name().to_owned()).collect()
    }
}

/// The checks of one fitted model, over all recordings.
#[derive(Debug, Clone, Default)]
pub(crate) struct Checks {
    pub(crate) rmse: f64,
    pub(crate) elpd: f64,
    pub(crate) heldout_rmse: f64,
    pub(crate) coverage90: f64,
    pub(crate) ljung_box_p: f64,
    pub(crate) least_squares: f64,
    /// The errors of the first recording, where each depends on those before.
    pub(crate) stationary: Option<Stationary>,
    pub(crate) innovations: Vec<Vec<f64>>,
    /// Of each recording.
    pub(crate) bands: Vec<Bands>,
    /// Where the mass is at the recorded times, on the shared axis [m], of
    /// each recording.
    pub(crate) places: Vec<Vec<f64>>,
}

/// The share of the values that the held-out stretch is predicted from.
const KNOWN: f64 = 0.7;

/// Checks a model on the recordings of its events. The least squares of its
/// motion, where these are known, are not sought again; of a rough fit they are
/// not a number.
pub(crate) fn checks(
    program: &dyn AnyProgram,
    events: &[&Event],
    fitted: &FittedModel<'_>,
    known: Option<f64>,
) -> Result<Checks> {
    let recorded = recordings(events);
    let with = With::new(program, &fitted.mechanisms);
    let posterior = Posterior::new(&with)?;
    let draws = &fitted.fit.draws;
    let times: Vec<&[f64]> =
        recorded.iter().map(|(_, series)| series.times()).collect();
    let bands = predictive_of_all(&posterior, draws, &times, fitted.first)?;
    let (_, found) = posterior.collect(Point::Line(&fitted.fit.best))?;
    let replayed = replay(&posterior, draws)?;
    let predicted = &replayed.means;
    let values = |(_, series): &(&Event, &Series)| series.values().to_vec();
    let values: Vec<Vec<f64>> = recorded.iter().map(values).collect();
    let places = recorded.iter().zip(predicted);
    Ok(Checks {
        rmse: rmse(&values.concat(), &predicted.concat()),
        elpd: elpd(&posterior, draws)?,
        heldout_rmse: held_out(program, fitted, &values)?,
        coverage90: coverage(&bands, &values),
        ljung_box_p: uncorrelated(&found.innovations),
        least_squares: match known {
            Some(known) => known,
            None if fitted.rough => f64::NAN,
            None => least_squares(&posterior, fitted.fit, &values)?,
        },
        stationary: replayed.stationary,
        places: places
            .map(|((event, series), p)| places_of(event, series, p))
            .collect(),
        innovations: found.innovations,
        bands,
    })
}

/// By leave-one-out; NaN where no draw has a flow.
fn elpd(posterior: &Posterior<'_>, draws: &Draws) -> Result<f64> {
    match leave_one_out(posterior, draws) {
        Ok(found) => Ok(found.elpd),
        Err(error) if error.is_inference() => Ok(f64::NAN),
        Err(error) => Err(error),
    }
}

/// The root mean square error of the posterior mean prediction.
pub(crate) fn posterior_rmse(
    program: &dyn AnyProgram,
    events: &[&Event],
    mechanisms: &[&dyn Mechanism],
    fit: &Fit,
) -> Result<f64> {
    let with = With::new(program, mechanisms);
    let posterior = Posterior::new(&with)?;
    let replayed = replay(&posterior, &fit.draws)?;
    let series = recordings(events).into_iter();
    let values: Vec<Vec<f64>> =
        series.map(|(_, series)| series.values().to_vec()).collect();
    Ok(rmse(&values.concat(), &replayed.means.concat()))
}

/// All series with their events, in the order in which models score them.
pub(crate) fn recordings<'e>(
    events: &[&'e Event],
) -> Vec<(&'e Event, &'e Series)> {
    events
        .iter()
        .flat_map(|&event| event.recordings().map(move |s| (event, s)))
        .collect()
}

/// The share of all values inside their bands.
fn coverage(bands: &[Bands], values: &[Vec<f64>]) -> f64 {
    let inside: f64 = bands
        .iter()
        .zip(values)
        .map(|(band, values)| band.coverage(values) * values.len() as f64)
        .sum();
    inside / values.iter().map(Vec::len).sum::<usize>().max(1) as f64
}

/// The least p of no autocorrelation, for the number of series (Bonferroni).
fn uncorrelated(innovations: &[Vec<f64>]) -> f64 {
    let count = innovations.len() as f64;
    innovations
        .iter()
        .map(|series| uncorrelated_p(series))
        .filter(|p| p.is_finite())
        .map(|p| (p * count).min(1.0))
        .fold(f64::NAN, f64::min)
}

/// Draws of all chains, thinned to a few hundred.
pub(crate) fn rows_of(draws: &Draws) -> Vec<&[f64]> {
    draws.thinned(400)
}

/// What the draws of a posterior say of the recordings.
#[derive(Default)]
struct Replayed {
    /// The posterior mean of what is predicted for each value of each series.
    means: Vec<Vec<f64>>,
    /// The errors of the first series, in the median.
    stationary: Option<Stationary>,
}

/// Runs a model again at its draws.
fn replay(posterior: &Posterior<'_>, draws: &Draws) -> Result<Replayed> {
    let mut means: Vec<Vec<f64>> = Vec::new();
    let (mut errors, mut innovations) = (Vec::new(), Vec::new());
    let mut count = 0.0;
    for row in rows_of(draws) {
        let (density, found) = posterior.collect(Point::Natural(row))?;
        if density.rejected.is_some() {
            continue;
        }
        if let Some(Some(one)) = found.stationary.first() {
            errors.push(one.error_sd);
            innovations.push(one.innovation_sd);
        }
        means.resize(found.predictions.len(), Vec::new());
        for (sum, one) in means.iter_mut().zip(found.predictions) {
            sum.resize(one.len(), 0.0);
            sum.iter_mut().zip(one).for_each(|(s, p)| *s += p);
        }
        count += 1.0;
    }
    means.iter_mut().flatten().for_each(|sum| *sum /= count);
    let stationary = (!errors.is_empty()).then(|| Stationary {
        error_sd: median(&errors),
        innovation_sd: median(&innovations),
    });
    Ok(Replayed { means, stationary })
}

/// The RMSE over the last values, of the model fitted to those before.
fn held_out(
    program: &dyn AnyProgram,
    fitted: &FittedModel<'_>,
    values: &[Vec<f64>],
) -> Result<f64> {
    let known = With::new(program, &[]).knowing(KNOWN);
    let with = ByEvent::new(&known, &fitted.mechanisms)?;
    let posterior = Posterior::new(&with)?;
    let plain = With::new(program, &fitted.mechanisms);
    let whole = Posterior::new(&plain)?;
    let predicted = if fitted.rough {
        let Some(peak) = climb(&posterior, &fitted.fit.best)? else {
            return Ok(f64::NAN);
        };
        whole.collect(Point::Line(peak.line.as_slice()))?.1.predictions
    } else {
        let search = LaplaceMixture::within(SearchSpace {
            prior_starts: 6,
            starts: vec![fitted.fit.best.clone()],
            grids: Vec::new(),
        });
        let seed = fitted.first.child(1);
        let rough = Precision::Rough;
        let found = estimate(&with, &posterior, &search, rough, seed)?;
        let Some(draws) = found.draws else { return Ok(f64::NAN) };
        replay(&whole, &draws)?.means
    };
    Ok(rmse(&last(values), &last(&predicted)))
}

/// The values of all series that are held out.
fn last(series: &[Vec<f64>]) -> Vec<f64> {
    let of = |values: &Vec<f64>| {
        let known = (KNOWN * values.len() as f64) as usize;
        values[known.clamp(1, values.len())..].to_vec()
    };
    series.iter().flat_map(of).collect()
}

/// The recorded times on the shared clock.
fn shared_times(event: &Event, series: &Series) -> Vec<f64> {
    series.times().iter().map(|t| event.clock() + t).collect()
}

/// Where the mass is at the recorded times: the predicted speeds summed by
/// the trapezoidal rule, or the predicted positions.
fn places_of(event: &Event, series: &Series, predicted: &[f64]) -> Vec<f64> {
    let start = event.track().origin() + event.start();
    if series.quantity() == Quantity::Position {
        return predicted.iter().map(|s| start + s).collect();
    }
    let (mut time, mut speed) = (0.0, event.release_speed());
    let mut place = start;
    series
        .times()
        .iter()
        .zip(predicted)
        .map(|(&t, &p)| {
            let next = match series.quantity() {
                Quantity::Acceleration => speed + p * (t - time),
                _ => p,
            };
            place += 0.5 * (speed + next) * (t - time);
            (time, speed) = (t, next);
            place
        })
        .collect()
}

/// What going from one model to the other brings.
pub(crate) fn improvement(
    none: &Fit,
    fit: &Fit,
    old: &Checks,
    new: &Checks,
) -> Improvement {
    let pair = |of: fn(&Checks) -> f64| BeforeAfter {
        before: of(old),
        after: of(new),
    };
    let gain = fit.log_evidence - none.log_evidence;
    Improvement {
        log10_bayes_factor: gain / LN_10,
        rmse: pair(|f| f.rmse),
        elpd: pair(|f| f.elpd),
        heldout_rmse: pair(|f| f.heldout_rmse),
        coverage90: pair(|f| f.coverage90),
        ljung_box_p: pair(|f| f.ljung_box_p),
        least_squares: pair(|f| f.least_squares),
        stationary_sd: pair(|f| {
            f.stationary.map_or(f64::NAN, |errors| errors.error_sd)
        }),
    }
}

/// Each recording with what both models predict of it.
pub(crate) fn pictured(
    events: &[&Event],
    before: &Checks,
    after: &Checks,
    corrected: bool,
) -> Vec<Pictured> {
    recordings(events)
        .into_iter()
        .enumerate()
        .map(|(i, (event, series))| {
            let (x, z) = event.track().points();
            Pictured {
                event: event.name().to_owned(),
                quantity: series.quantity().name().to_owned(),
                unit: series.quantity().unit().to_owned(),
                times: shared_times(event, series),
                values: series.values().to_vec(),
                places: after.places[i].clone(),
                before: before.bands[i].clone(),
                after: if corrected {
                    after.bands[i].clone()
                } else {
                    Bands::default()
                },
                track: (x.to_vec(), z.to_vec()),
                ..Pictured::default()
            }
        })
        .collect()
}
