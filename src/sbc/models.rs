//! Simulation-based calibration of model choice: a model drawn by its prior
//! odds, its parameters from their priors, a recording from those; and the
//! probability of every model given that recording.

use rand::RngExt;

use super::REDRAWS;
use super::choices::{Choice, Choices};
use crate::diagnosis::{Odds, attribute, judge, prior_probabilities};
use crate::error::{Error, Result};
use crate::infer::{Progress, Quiet};
use crate::mechanism::Mechanism;
use crate::model::{AnyProgram, Posterior, Program, With};
use crate::observe::Series;
use crate::parallel;
use crate::predict::simulate;
use crate::seed::{Rng, Seed};

/// Makes a program of a recording.
pub type Remaking<'a, P> = &'a (dyn Fn(&[Series]) -> Result<P> + Sync);

/// Draws recordings from a program as it is and from the same with one
/// mechanism of a catalogue, and weighs them all as a diagnosis does: by
/// even odds, variants of one name averaged.
///
/// The catalogue stays the same for all recordings: a prior scaled to the
/// recording at hand is another than the one it was drawn from. A draw
/// without a flow is drawn again with its model, which is consistent: an
/// evidence counts such parameters as likelihood zero, so that both speak of
/// models and parameters given a flow.
///
/// # Errors
/// An improper prior, or a model that fails.
pub fn choices<P: Program>(
    program: &dyn AnyProgram,
    remade: Remaking<'_, P>,
    catalogue: &[Box<dyn Mechanism>],
    replications: usize,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Choices> {
    let beforehand = prior_probabilities(catalogue, &Odds::new());
    let (names, prior): (Vec<String>, Vec<f64>) =
        beforehand.into_iter().unzip();
    let models = Models { program, catalogue, names: &names, prior: &prior };
    progress.begin("drawing models", Some(replications as u64));
    let cases = parallel::try_map(0..replications as u64, |i| {
        let case = models.case(remade, seed.child(i));
        progress.advance(1);
        case
    })?;
    Ok(Choices { names, prior, cases })
}

/// The models that are chosen from.
struct Models<'a> {
    program: &'a dyn AnyProgram,
    catalogue: &'a [Box<dyn Mechanism>],
    /// The model as it is, then each name of the catalogue.
    names: &'a [String],
    prior: &'a [f64],
}

/// A recording whose model is known.
struct Drawn {
    truth: usize,
    series: Vec<Series>,
    redrawn: usize,
}

impl Models<'_> {
    fn case<P: Program>(
        &self,
        remade: Remaking<'_, P>,
        seed: Seed,
    ) -> Result<Choice> {
        let Drawn { truth, series, redrawn } = self.drawn(seed.child(0))?;
        let program = remade(&series)?;
        let found =
            attribute(&program, None, self.catalogue, seed.child(1), &Quiet)?;
        let judged = judge(&found, self.catalogue, &Odds::new());
        let of = |name: &String| judged.iter().find(|m| m.name == *name);
        let judged: Vec<_> = self.names.iter().filter_map(of).collect();
        let probability = judged.iter().map(|m| m.probability).collect();
        Ok(Choice { truth, probability, redrawn })
    }

    fn drawn(&self, seed: Seed) -> Result<Drawn> {
        let mut rng = seed.child(0).rng();
        for redrawn in 0..REDRAWS {
            let (truth, mechanism) = self.model(&mut rng);
            let with = With::new(self.program, mechanism.as_slice());
            let posterior = Posterior::new(&with)?;
            posterior.require_proper("simulation-based calibration")?;
            let (density, found) = posterior.draw_prior(&mut rng)?;
            if density.rejected.is_none() {
                let made = simulate(&with, &found.natural, seed.child(1))?;
                return Ok(Drawn { truth, series: made.series, redrawn });
            }
        }
        Err(Error::inference("no draw from the prior has a flow"))
    }

    /// A name by its prior probability, and one of its variants, all alike.
    fn model(&self, rng: &mut Rng) -> (usize, Option<&dyn Mechanism>) {
        let mut left: f64 = rng.random();
        let below = |p: &f64| {
            left -= p;
            left < 0.0
        };
        let last = self.names.len() - 1;
        let truth = self.prior.iter().position(below).unwrap_or(last);
        let name = &self.names[truth];
        let variants: Vec<&dyn Mechanism> = self
            .catalogue
            .iter()
            .map(AsRef::as_ref)
            .filter(|m| m.name() == name)
            .collect();
        match variants.len() {
            0 => (truth, None),
            n => (truth, Some(variants[rng.random_range(0..n)])),
        }
    }
}
