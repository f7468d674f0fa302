//! How well a model predicts values that it was not fitted to.
//!
//! Two questions are asked. Leave-one-out ([`leave_one_out`]) leaves out one
//! datum at a time and predicts it from all others. Leave-future-out
//! ([`leave_future_out`]) predicts each value of a series from those before
//! it. Both sum the log predictive density (elpd): more is better, and a
//! difference between models says what the better one gains.
//!
//! With autocorrelated errors the density of a value is the one given the
//! values before it. Leave-one-out then leaves out that factor, but the value
//! itself still stands in the condition of the next one: it asks how well an
//! innovation is predicted by parameters fitted to the others, not how well a
//! missing value is. Leave-future-out has no such flaw.

use crate::draws::{
    self, Draws, Lfo, Loo, k_threshold, loo_of_chains, relative_efficiency,
    sum_and_error,
};
use crate::error::{Error, Result};
use crate::infer::{Backend, Progress, Quiet, infer};
use crate::model::{Assembled, Point, Posterior};
use crate::parallel;
use crate::seed::Seed;

/// The most draws that an estimate is made of: the tail of the weights is
/// smoothed, and more only cost.
const MOST_DRAWS: usize = 4000;

/// Numbers kept at the most, draws x data.
const MOST_NUMBERS: usize = 40_000_000;

/// The log density of each datum given those before it, draws x data; at the
/// most some thousand draws, evenly thinned.
///
/// A draw that the model rejects gives every datum density zero.
///
/// # Errors
/// No draws, or none that the model accepts; a model that fails.
pub fn pointwise(
    posterior: &Posterior<'_>,
    draws: &Draws,
) -> Result<Vec<Vec<f64>>> {
    let log_density = |row: &&[f64]| {
        let (density, found) = posterior.collect(Point::Natural(row))?;
        Ok(density.rejected.is_none().then_some(found.pointwise))
    };
    let one = draws.thinned(1);
    let length = one.first().map(log_density).transpose()?.flatten();
    let most = MOST_NUMBERS / length.map_or(1, |l| l.len()).max(1);
    let rows = draws.thinned(MOST_DRAWS.min(most.max(100)));
    let table = parallel::try_map(&rows, log_density)?;
    let Some(data) = table.iter().flatten().map(Vec::len).next() else {
        return Err(Error::inference("no draw has a flow to predict with"));
    };
    let zero = || vec![f64::NEG_INFINITY; data];
    Ok(table.into_iter().map(|row| row.unwrap_or_else(zero)).collect())
}

/// Leave-one-out prediction from posterior draws, of any model.
///
/// ```
/// use couloir::prelude::*;
/// model! {
///     struct Mean { seen: Vec<f64> }
///     centre ~ Normal(0.0, 1.0);
///     likelihood { seen ~ Normal(centre, 1.0); }
/// }
/// let model = Mean::new(vec![0.3, -0.2, 0.9, 0.1]);
/// let posterior = Posterior::new(&model)?;
/// let found = infer(&Smc::default(), &posterior, Seed::new(1), &Quiet)?;
/// let draws = found.draws.ok_or(Error::inference("no draws"))?;
/// let loo = couloir::elpd::leave_one_out(&posterior, &draws)?;
/// assert!((loo.elpd + 4.5).abs() < 0.2);
/// # Ok::<(), Error>(())
/// ```
///
/// # Errors
/// As [`pointwise`]; a model without data.
pub fn leave_one_out(posterior: &Posterior<'_>, draws: &Draws) -> Result<Loo> {
    let table = pointwise(posterior, draws)?;
    // A draw of fewer is worth more, but not more than an independent one.
    let each = relative_efficiency(draws);
    let thinned = draws.total() as f64 / table.len() as f64;
    let efficiency = (each * thinned).min(each.max(1.0));
    loo_of_chains(&table, efficiency)
        .ok_or_else(|| Error::inference("the model has no data to leave out"))
}

/// From how many values on leave-future-out predicts, where nothing else is
/// asked for: a third of them.
pub fn least_for(values: usize) -> usize {
    values.div_ceil(3)
}

/// Leave-future-out prediction of an event's recording, one value ahead, from
/// the `least` first values on. The model is fitted by `backend` to as many
/// values as are known, again where the Pareto shape of the weights is above
/// [`k_threshold`], at most 0.7.
///
/// # Errors
/// An event with no recording or several, nothing left to predict, a backend
/// without draws.
pub fn leave_future_out(
    model: &Assembled,
    backend: &dyn Backend,
    least: usize,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Lfo> {
    predict_ahead(model, backend, least, None, seed, progress)
}

/// The same with a threshold of one's own.
fn predict_ahead(
    model: &Assembled,
    backend: &dyn Backend,
    least: usize,
    threshold: Option<f64>,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Lfo> {
    let values = model.event().recordings().map(|s| s.len()).sum();
    let whole = Posterior::new(model)?;
    let first = draws_given(model, backend, least, seed)?;
    let used = first.total().min(MOST_DRAWS);
    let threshold = threshold.unwrap_or_else(|| k_threshold(used));
    let mut first = Some(first);
    draws::leave_future_out(values, least, threshold, |known| {
        progress.begin(&format!("predicting from {known} values"), None);
        let draws = match first.take() {
            Some(draws) => draws,
            None => draws_given(model, backend, known, seed)?,
        };
        pointwise(&whole, &draws)
    })
}

/// Posterior draws given the first `known` values.
fn draws_given(
    model: &Assembled,
    backend: &dyn Backend,
    known: usize,
    seed: Seed,
) -> Result<Draws> {
    let part = model.first(known)?;
    let posterior = Posterior::new(&part)?;
    let found = infer(backend, &posterior, seed.child(known as u64), &Quiet)?;
    found.draws.ok_or_else(|| {
        Error::input(format!(
            "backend {} yields no draws, which predictions are made of",
            backend.name()
        ))
    })
}

/// The elpd of one model less that of another, and its standard error, from
/// their parts for the same data; nothing for different numbers of data.
///
/// ```
/// use couloir::elpd::difference;
/// assert_eq!(difference(&[-1.0, -2.0], &[-1.5, -2.5]), Some((1.0, 0.0)));
/// assert_eq!(difference(&[-1.0], &[]), None);
/// ```
pub fn difference(model: &[f64], other: &[f64]) -> Option<(f64, f64)> {
    if model.len() != other.len() {
        return None;
    }
    let pairs = model.iter().zip(other).map(|(a, b)| a - b);
    Some(sum_and_error(&pairs.collect::<Vec<_>>()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::{MetropolisHastings, Smc};
    use crate::noise;
    use crate::observe::{Event, Series};
    use crate::physics::Track;
    use crate::physics::friction::Laws;
    use crate::predict::simulate;
    use std::collections::BTreeMap;

    /// A synthetic slide at these times \[s\], Coulomb's law with a noise.
    fn slide(times: &[f64], noise: &str, truth: &[f64]) -> Assembled {
        let values = vec![0.0; times.len()];
        let series = Series::velocity(times.to_vec(), values).unwrap();
        let plan = Event::on(Track::incline(35.0, 3000.0).unwrap())
            .velocity(series)
            .build()
            .unwrap();
        let friction = || Laws::default().parse("coulomb").unwrap();
        let noise = || noise::parse(noise).unwrap();
        let none = BTreeMap::new();
        let make = |e| Assembled::new(e, friction(), noise(), &none).unwrap();
        let plan = make(plan);
        let seen = simulate(&plan, truth, Seed::new(5)).unwrap();
        make(plan.event().with_recording(seen[0].clone()).unwrap())
    }

    fn regular() -> Vec<f64> {
        (1..=15).map(f64::from).collect()
    }

    #[test]
    fn the_first_values_have_the_first_parts_of_the_likelihood() {
        let gaps = [1.0, 2.0, 4.0, 5.0, 6.0, 9.0, 10.0, 11.0];
        let uneven = [0.9, 2.3, 3.1, 4.85, 5.1, 7.0, 9.4, 10.2];
        let cases: [(&[f64], &str, &[f64]); 4] = [
            (&regular(), "iid", &[0.3, 1.0]),
            (&regular(), "ar(2)", &[0.3, 0.5, 0.2, 1.0]),
            (&gaps, "ar(2)", &[0.3, 0.5, 0.2, 1.0]),
            (&uneven, "ar(1)", &[0.3, 0.5, 1.0]),
        ];
        for (times, noise, truth) in cases {
            let model = slide(times, noise, truth);
            let posterior = Posterior::new(&model).unwrap();
            let (_, all) = posterior.collect(Point::Natural(truth)).unwrap();
            for n in 1..=times.len() {
                let part = model.first(n).unwrap();
                let posterior = Posterior::new(&part).unwrap();
                let density = posterior.density(Point::Natural(truth));
                let found = density.unwrap().log_likelihood;
                let sum: f64 = all.pointwise[..n].iter().sum();
                assert!((found - sum).abs() < 1e-9, "{noise} {n}");
            }
            assert!(model.first(0).is_err());
            assert!(model.first(times.len() + 1).is_err());
        }
    }

    #[test]
    fn reweighted_fits_agree_with_a_fit_at_every_value() {
        for (noise, truth) in
            [("iid", &[0.3, 1.0][..]), ("ar(1)", &[0.3, 0.7, 1.0])]
        {
            let model = slide(&regular(), noise, truth);
            let backend = Smc { particles: 3000, ..Smc::default() };
            let run = |threshold| {
                let seed = Seed::new(2);
                predict_ahead(&model, &backend, 9, threshold, seed, &Quiet)
                    .unwrap()
            };
            let (quick, exact) = (run(None), run(Some(f64::NEG_INFINITY)));
            assert_eq!(exact.fits, (9..15).collect::<Vec<_>>());
            assert!(quick.fits.len() < 4, "{:?}", quick.fits);
            // Each part has a relative error of a few per cent, from weights
            // of finite variance over 3000 draws.
            for (q, e) in quick.pointwise.iter().zip(&exact.pointwise) {
                assert!((q - e).abs() < 0.12, "{noise} {q} {e}");
            }
            let off = quick.elpd - exact.elpd;
            assert!(off.abs() < 0.3, "{noise} {off}");
        }
    }

    #[test]
    fn parts_ahead_add_up_to_the_evidence() {
        // ln p(y) = ln p(y_1) + sum of ln p(y_i | y_1 .. y_(i-1)).
        let model = slide(&regular(), "iid", &[0.3, 1.0]);
        let backend = Smc { particles: 3000, ..Smc::default() };
        let run = |model: &Assembled| {
            let posterior = Posterior::new(model).unwrap();
            let seed = Seed::new(3);
            let found = infer(&backend, &posterior, seed, &Quiet).unwrap();
            found.evidence.unwrap().log
        };
        let seed = Seed::new(4);
        let ahead = leave_future_out(&model, &backend, 1, seed, &Quiet);
        let sum = run(&model.first(1).unwrap()) + ahead.unwrap().elpd;
        let whole = run(&model);
        assert!((sum - whole).abs() < 0.3, "{sum} {whole}");
    }

    #[test]
    fn leave_one_out_agrees_with_fits_without_the_value() {
        let truth = [0.3, 1.0];
        let model = slide(&regular(), "iid", &truth);
        let backend = MetropolisHastings::default();
        let posterior = Posterior::new(&model).unwrap();
        let seed = Seed::new(1);
        let found = infer(&backend, &posterior, seed, &Quiet).unwrap();
        let draws = found.draws.unwrap();
        let loo = leave_one_out(&posterior, &draws).unwrap();
        // The last value, left out of the fit: the same as one ahead.
        let ahead = leave_future_out(&model, &backend, 14, seed, &Quiet);
        let off = loo.pointwise[14] - ahead.unwrap().pointwise[0];
        assert!(off.abs() < 0.1, "{off}");
        assert_eq!(pointwise(&posterior, &draws).unwrap().len(), MOST_DRAWS);
    }

    #[test]
    fn nothing_to_predict_is_an_input_error() {
        let model = slide(&regular(), "iid", &[0.3, 1.0]);
        let backend = Smc { particles: 100, ..Smc::default() };
        for least in [0, 15, 99] {
            let seed = Seed::new(1);
            let found =
                leave_future_out(&model, &backend, least, seed, &Quiet);
            assert!(found.unwrap_err().is_input(), "{least}");
        }
    }
}
