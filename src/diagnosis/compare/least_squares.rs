//! The least error that a model's motion can have, whatever its priors say.
//!
//! A posterior weighs the recording against priors and a noise that may take
//! a smooth mismatch for itself; the plain least-squares figure beside it
//! tells how far the motion alone can follow the recording.

use argmin::core::CostFunction;
use nalgebra::DVector;

use crate::diagnosis::evidence::fit::Fit;
use crate::error::Result;
use crate::infer::simplex::{WALL, descend};
use crate::model::{Point, Posterior};
use crate::parallel;
use crate::predict::rmse;

/// How many searches start, each from a simplex of posterior draws.
const SEARCHES: usize = 4;
/// Iterations of a search, for each parameter.
const PATIENCE: u64 = 120;
/// How often a search starts again about its best place, with a simplex as
/// large as the last one's first.
const ROUNDS: usize = 3;

/// The root mean square error at a place on the real line \[recorded unit\].
#[derive(Clone, Copy)]
struct Misfit<'a, 'm> {
    posterior: &'a Posterior<'m>,
    values: &'a [f64],
}

impl CostFunction for Misfit<'_, '_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, z: &DVector<f64>) -> Result<f64, argmin::core::Error> {
        let point = Point::Line(z.as_slice());
        let (density, found) = self.posterior.collect(point)?;
        let error = rmse(self.values, &found.predictions.concat());
        let flows = density.rejected.is_none() && error.is_finite();
        Ok(if flows { error } else { WALL })
    }
}

/// The least root mean square error of a fitted model's motion over all
/// values, searched from its posterior draws; NaN where no draw has a flow.
///
/// # Errors
/// A model that fails.
pub(crate) fn least_squares(
    posterior: &Posterior<'_>,
    fit: &Fit,
    values: &[Vec<f64>],
) -> Result<f64> {
    let values = values.concat();
    let misfit = Misfit { posterior, values: &values };
    let corners = posterior.dimension() + 1;
    let rows = fit.draws.thinned(SEARCHES * corners);
    let lines = rows
        .into_iter()
        .map(|row| Ok(DVector::from_vec(posterior.line(row)?)))
        .collect::<Result<Vec<_>>>()?;
    let simplices = lines.chunks_exact(corners);
    let found =
        parallel::try_map(simplices, |simplex| search(misfit, simplex))?;
    let flows = found.into_iter().flatten().filter(|e| *e < WALL);
    Ok(flows.fold(f64::NAN, f64::min))
}

/// The least error that searches from a simplex come to.
fn search(
    misfit: Misfit<'_, '_>,
    first: &[DVector<f64>],
) -> Result<Option<f64>> {
    let mut best: Option<(f64, DVector<f64>)> = None;
    for _ in 0..ROUNDS {
        let simplex = match &best {
            None => first.to_vec(),
            Some((_, place)) => about(place, first),
        };
        let iterations = PATIENCE * first.len() as u64;
        let found = descend(misfit, simplex, 1e-9, iterations)?;
        let Some((error, place)) = found else { return Ok(None) };
        if best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, place));
        }
    }
    Ok(best.map(|(error, _)| error))
}

/// A simplex of the same shape, its first corner at a place.
fn about(place: &DVector<f64>, shape: &[DVector<f64>]) -> Vec<DVector<f64>> {
    shape.iter().map(|corner| place + corner - &shape[0]).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::diagnosis::evidence::fit::fit;
    use crate::infer::LaplaceMixture;
    use crate::model::Assembled;
    use crate::noise;
    use crate::observe::{Event, Series};
    use crate::physics::Track;
    use crate::physics::friction::Laws;
    use crate::prior::AnyPrior;
    use crate::seed::Seed;

    /// On a constant slope under Coulomb friction u = a t, so the least
    /// error is that of a line through the origin.
    #[test]
    fn a_line_through_the_origin() {
        let times: Vec<f64> = (1..=40).map(|i| 0.1 * f64::from(i)).collect();
        let wave = |t: &f64| 2.0 * t + 0.3 * (3.0 * t).sin();
        let values: Vec<f64> = times.iter().map(wave).collect();
        let cross: f64 = times.iter().zip(&values).map(|(t, v)| t * v).sum();
        let a = cross / times.iter().map(|t| t * t).sum::<f64>();
        let line: Vec<f64> = times.iter().map(|t| a * t).collect();
        let expected = rmse(&values, &line);
        let track = Track::incline(28.0, 900.0).unwrap();
        let series = Series::velocity(times, values.clone()).unwrap();
        let event = Event::on(track).velocity(series).build().unwrap();
        let laws = Laws::default().parse("coulomb").unwrap();
        let noise = noise::parse("iid").unwrap();
        let prior = |text| AnyPrior::parse(text).unwrap();
        // A prior that holds mu off its best place (0.30), which the least
        // squares are not to know.
        let priors = BTreeMap::from([
            ("mu".to_owned(), prior("Normal(0.5, 0.02)")),
            ("sigma2".to_owned(), prior("InverseGamma(3, 0.3)")),
        ]);
        let program = Assembled::new(event, laws, noise, &priors).unwrap();
        let seed = Seed::new(4);
        let fit =
            fit(&program, &[], &LaplaceMixture::default(), seed).unwrap();
        let posterior = Posterior::new(&program).unwrap();
        let found = least_squares(&posterior, &fit, &[values]).unwrap();
        // The search ends where its corners differ by less than 1e-9.
        assert!((found - expected).abs() < 1e-7, "{found}");
    }
}
