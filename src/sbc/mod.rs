//! Simulation-based calibration: is the inference right about what it does
//! not know?
//!
//! Parameters drawn from the prior, a recording simulated with them, the
//! posterior of that recording: the true value's rank among the posterior
//! draws is uniform if model and backend are right (Talts, Betancourt,
//! Simpson, Vehtari, Gelman 2018). Whatever is wrong with either shows as
//! ranks that are not. The same is asked of the choice between models:
//! [`choices`] holds posterior probabilities against the models that were
//! true.

mod choices;
mod models;

pub use choices::{Choice, Choices, Held};
pub use models::{Remaking, choices};

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::error::{Error, Result};
use crate::infer::{Backend, Progress, Quiet, part};
use crate::model::{Model, Point, Posterior};
use crate::observe::Series;
use crate::parallel;
use crate::predict::simulate;
use crate::seed::Seed;

/// How many posterior draws a value is ranked among: ranks 0 to 99.
const AMONG: usize = 99;
/// How many bins the ranks are counted in.
const BINS: usize = 10;

/// The ranks of true values among posterior draws.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Ranks {
    /// The parameters' names, then "log likelihood".
    pub names: Vec<String>,
    /// Of each parameter the ranks, 0 to 99, one for each replication.
    pub ranks: Vec<Vec<usize>>,
}

impl Ranks {
    /// How many ranks of a parameter fall into each tenth.
    pub fn histogram(&self, parameter: usize) -> [usize; BINS] {
        let mut counts = [0; BINS];
        for rank in &self.ranks[parameter] {
            counts[(rank * BINS / (AMONG + 1)).min(BINS - 1)] += 1;
        }
        counts
    }

    /// The p-value, by chi-squared, of ranks so uneven if all were right.
    pub fn p(&self, parameter: usize) -> f64 {
        let counts = self.histogram(parameter);
        let expected = self.ranks[parameter].len() as f64 / BINS as f64;
        let statistic: f64 = counts
            .iter()
            .map(|n| (*n as f64 - expected).powi(2) / expected)
            .sum();
        let law = ChiSquared::new((BINS - 1) as f64);
        law.map_or(f64::NAN, |law| law.sf(statistic))
    }
}

/// Makes a model of a recording.
pub type Making<'a> = &'a (dyn Fn(&[Series]) -> Result<Box<dyn Model>> + Sync);

/// Ranks true values over a number of replications: `model` says where
/// parameters and recordings come from, `remade` is the same model of a
/// simulated recording and `fitted` the one that is calibrated: the same,
/// unless a wrong one is to be caught.
///
/// Beside the parameters the log likelihood is ranked: parameters alone
/// cannot tell a posterior that passes over a part of the recording
/// (Modrak et al. 2023).
///
/// # Errors
/// An improper prior, a backend without draws, or a model that fails.
pub fn ranks(
    model: &dyn Model,
    [remade, fitted]: [Making<'_>; 2],
    backend: &dyn Backend,
    replications: usize,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Ranks> {
    let prior = Posterior::new(model)?;
    prior.require_proper("simulation-based calibration")?;
    let mut names: Vec<String> =
        prior.parameters().iter().map(|p| p.name.clone()).collect();
    names.push("log likelihood".to_owned());
    let rows = parallel::try_map(0..replications as u64, |i| {
        let seed = seed.child(i);
        let row = part(progress, &format!("ranks of {seed:?}"), || {
            replication(&prior, [remade, fitted], backend, seed)
        });
        progress.advance(1);
        row
    })?;
    let ranks = (0..names.len())
        .map(|i| rows.iter().map(|row| row[i]).collect())
        .collect();
    Ok(Ranks { names, ranks })
}

/// The rank of each parameter's true value in one replication.
fn replication(
    prior: &Posterior<'_>,
    [remade, fitted]: [Making<'_>; 2],
    backend: &dyn Backend,
    seed: Seed,
) -> Result<Vec<usize>> {
    let truth = drawn(prior, seed.child(0))?;
    let seen = simulate(prior.model(), &truth, seed.child(1))?;
    let model = fitted(&seen)?;
    let posterior = Posterior::new(model.as_ref())?;
    // Ranks say what the warnings of thousands of short chains would.
    let found = backend.explore(&posterior, seed.child(2), &Quiet)?;
    let draws = found.draws.ok_or_else(|| {
        Error::input(format!("backend {} yields no draws", backend.name()))
    })?;
    let rows = draws.thinned(AMONG);
    if rows.len() < AMONG {
        return Err(Error::input(format!(
            "backend {} yields {} draws; expected {AMONG} at least, among \
             which the true value has its rank: ask it for more",
            backend.name(),
            rows.len()
        )));
    }
    let below = |i: usize| rows.iter().filter(|row| row[i] < truth[i]).count();
    let mut ranks: Vec<usize> = (0..truth.len()).map(below).collect();
    let right = remade(&seen)?;
    let likelihood = |row: &[f64]| -> Result<f64> {
        let density = right.evaluate(Point::Natural(row), None)?;
        Ok(density.log_likelihood)
    };
    let of_truth = likelihood(&truth)?;
    let mut lower = 0;
    for row in &rows {
        lower += usize::from(likelihood(row)? < of_truth);
    }
    ranks.push(lower);
    Ok(ranks)
}

/// How many draws from the prior may have no flow before it is given up.
const REDRAWS: usize = 10_000;

/// Parameters from the prior for which there is a flow.
fn drawn(prior: &Posterior<'_>, seed: Seed) -> Result<Vec<f64>> {
    let mut rng = seed.rng();
    for _ in 0..REDRAWS {
        let (density, found) = prior.draw_prior(&mut rng)?;
        if density.rejected.is_none() {
            return Ok(found.natural);
        }
    }
    Err(Error::inference("no draw from the prior has a flow"))
}
