//! Teaching a proposal where the posterior lies: rounds of importance draws
//! that first reweight its components. Then draws are moved on by a Markov
//! kernel that leaves the posterior invariant. Where they come to shows what
//! the proposal misses, and components fitted there mend it, until its weights
//! are good and nothing is missed.

use super::check::Moved;
use super::proposal::{Base, Mixture, Particle, population};
use super::schedule::Schedule;
use super::weights::{cut, log_mean_weight, quality};
use crate::error::Result;
use crate::model::Posterior;
use crate::seed::Seed;

/// The most components that a round adds.
const FITTED: usize = 6;

/// How often all are weighed anew then.
const REWEIGHTED: usize = 2;

/// A proposal, and how good it is.
#[derive(Debug, Clone)]
pub(crate) struct Frozen {
    pub(crate) mixture: Mixture,
    /// About ln of the evidence, by the last draws.
    pub(crate) log: f64,
    /// By how much its draws say that the weights' second moment exceeds the
    /// square of their mean, or those that were moved on.
    pub(crate) excess: f64,
    /// Whether the weights are good and nothing was missed.
    pub(crate) good: bool,
    /// How many rounds it has learned from.
    pub(crate) round: u64,
}

impl Frozen {
    /// A proposal that has learned nothing yet.
    pub(super) fn new(mixture: Mixture) -> Self {
        let (log, excess) = (f64::NEG_INFINITY, f64::INFINITY);
        Self { mixture, log, excess, good: false, round: 0 }
    }

    /// The components of both, as if they had learned nothing yet.
    pub(crate) fn beside(self, other: &Self) -> Self {
        Self::new(self.mixture.beside(other.mixture.clone()))
    }

    /// Goes on learning, for so many rounds in all, unless it is good before.
    ///
    /// # Errors
    /// What no other parameter values would mend.
    pub(crate) fn learned(
        mut self,
        posterior: &Posterior<'_>,
        schedule: &Schedule,
        rounds: u64,
        seed: Seed,
    ) -> Result<Self> {
        while self.round < rounds && !self.good {
            let seed = seed.child(self.round);
            let base = Base::Mixture(self.mixture.clone());
            let count = schedule.draws(self.round);
            let found = population(posterior, &base, count, seed.child(0))?;
            let quality = quality(&found);
            self.log = log_mean_weight(&found);
            self.excess = 1.0 / quality.0 - 1.0;
            let early = self.round < schedule.reweighting_rounds;
            self.round += 1;
            if !early {
                self =
                    self.moved_on(posterior, &found, schedule, seed.child(1))?;
                continue;
            }
            self.mixture = reweighted(&self.mixture, &found);
            if schedule.is_good(quality) {
                self.round = schedule.reweighting_rounds;
            }
        }
        Ok(self)
    }

    /// With components fitted to weighted draws, and where these say that it is
    /// far too low.
    pub(super) fn mended(mut self, found: &[Particle], seed: Seed) -> Self {
        let wider = reweighted(&fitted(&self.mixture, found, seed), found);
        self.mixture = mended(&wider, found).unwrap_or(wider);
        self
    }

    /// Judged by draws and by where these are moved on to; unless it is good,
    /// with components fitted to the latter.
    pub(super) fn moved_on(
        mut self,
        posterior: &Posterior<'_>,
        found: &[Particle],
        schedule: &Schedule,
        seed: Seed,
    ) -> Result<Self> {
        let mixture = &self.mixture;
        let moved =
            Moved::on(posterior, mixture, found, schedule, seed.child(0))?;
        self.excess = self.excess.max(moved.excess);
        let quality = quality(found);
        self.good =
            schedule.is_good(quality) && !moved.met_more(quality.0, schedule);
        if !self.good {
            let wider = widened(mixture, &moved, seed.child(1));
            self.mixture = mended(&wider, found).unwrap_or(wider);
        } else if self.round < schedule.mended_until
            && let Some(mended) = mended(mixture, found)
        {
            self.mixture = mended;
            self.good = false;
        }
        Ok(self)
    }
}

/// A mixture with components that weigh what weighted draws say they hold.
pub(super) fn reweighted(mixture: &Mixture, found: &[Particle]) -> Mixture {
    let places = found.iter().map(|particle| &particle.z[..]);
    mixture.reweighted(places.zip(cut(found)))
}

/// A mixture with components where weighted draws say that it is far too low:
/// in a neck that draws hardly enter when they are moved. `None` where it is
/// nowhere so low.
fn mended(mixture: &Mixture, found: &[Particle]) -> Option<Mixture> {
    let log = log_mean_weight(found);
    let rows: Vec<Vec<f64>> = found.iter().map(|p| p.z.clone()).collect();
    let targets: Vec<f64> =
        found.iter().map(|p| p.log_target() - log).collect();
    mixture.mended(&rows, &cut(found), &targets)
}

/// A mixture beside one that is fitted to draws that were moved on.
fn widened(mixture: &Mixture, moved: &Moved, seed: Seed) -> Mixture {
    let rows = &moved.places;
    let even = vec![1.0 / rows.len() as f64; rows.len()];
    let Some(mut both) = beside(mixture, rows, &even, seed) else {
        return mixture.clone();
    };
    for _ in 0..REWEIGHTED {
        let places = rows.iter().map(Vec::as_slice);
        both = both.reweighted(places.zip(even.iter().copied()));
    }
    both
}

/// A mixture beside one that is fitted to weighted draws.
pub(super) fn fitted(
    mixture: &Mixture,
    found: &[Particle],
    seed: Seed,
) -> Mixture {
    let rows: Vec<Vec<f64>> = found.iter().map(|p| p.z.clone()).collect();
    let both = beside(mixture, &rows, &cut(found), seed);
    both.unwrap_or_else(|| mixture.clone())
}

/// A mixture beside one that is fitted to weighted places; `None` where these
/// are too few, or all the same.
pub(super) fn beside(
    mixture: &Mixture,
    rows: &[Vec<f64>],
    weights: &[f64],
    seed: Seed,
) -> Option<Mixture> {
    let fitted = Mixture::fit(rows, weights, FITTED, &mut seed.rng())?;
    Some(fitted.beside(mixture.clone()))
}
