//! Teaching a proposal where the posterior lies: rounds of importance draws
//! that reweight its components, then add some, until their weights are good
//! and draws that are moved on reach nothing that it misses.

use super::check::missed;
use super::proposal::{Base, Mixture, Particle, population};
use super::schedule::Schedule;
use super::weights::{cut, log_mean_weight, quality};
use crate::error::Result;
use crate::model::Posterior;
use crate::seed::Seed;

/// The most components that a round adds by a fit.
const ADDED: usize = 4;

/// A proposal that learns no more.
#[derive(Debug, Clone)]
pub(crate) struct Frozen {
    pub(crate) mixture: Mixture,
    /// About ln of the evidence, by these.
    pub(crate) log: f64,
    /// By how much draws that were moved on say that the weights' second
    /// moment exceeds the square of their mean.
    pub(crate) excess: f64,
    /// Whether the weights are good and nothing was missed.
    pub(crate) good: bool,
}

/// Learns from rounds of draws, and freezes.
///
/// # Errors
/// What no other parameter values would mend.
pub(super) fn adapted(
    posterior: &Posterior<'_>,
    mut mixture: Mixture,
    schedule: &Schedule,
    seed: Seed,
) -> Result<Frozen> {
    let mut frozen = None;
    for round in 0..schedule.rounds {
        let seed = seed.child(round);
        let base = Base::Mixture(mixture.clone());
        let count = schedule.learning_draws;
        let found = population(posterior, &base, count, seed.child(0))?;
        let quality = quality(&found);
        let log = log_mean_weight(&found);
        let good = schedule.is_good(quality);
        let mut state = Frozen {
            mixture: mixture.clone(),
            log,
            excess: 1.0 / quality.0 - 1.0,
            good,
        };
        if good {
            let seed = seed.child(3);
            let checked = missed(posterior, &mixture, &found, schedule, seed)?;
            state.excess = state.excess.max(checked.excess);
            match checked.mended {
                None => return Ok(state),
                Some(wider) => mixture = wider,
            }
            state.good = false;
        } else {
            let seed = seed.child(2);
            mixture = taught(&mixture, &found, round, schedule, seed);
        }
        frozen = Some(state);
    }
    // What the last round taught was not looked at: it goes on from there.
    let last =
        frozen.map(|state| Frozen { mixture: mixture.clone(), ..state });
    Ok(last.unwrap_or(Frozen {
        mixture,
        log: f64::NEG_INFINITY,
        excess: f64::INFINITY,
        good: false,
    }))
}

/// The same, judged by more draws than it learned from; it learns from these
/// where they say that it is poor.
///
/// # Errors
/// As [`adapted`].
pub(super) fn judged(
    posterior: &Posterior<'_>,
    mut frozen: Frozen,
    schedule: &Schedule,
    seed: Seed,
) -> Result<Frozen> {
    for time in 0..schedule.judgements {
        let seed = seed.child(time);
        let base = Base::Mixture(frozen.mixture.clone());
        let count = schedule.judging_draws;
        let found = population(posterior, &base, count, seed.child(0))?;
        let quality = quality(&found);
        let wider = if schedule.is_good(quality) {
            let mixture = &frozen.mixture;
            let seed = seed.child(1);
            let checked = missed(posterior, mixture, &found, schedule, seed)?;
            frozen.excess = checked.excess.max(1.0 / quality.0 - 1.0);
            frozen.log = log_mean_weight(&found);
            frozen.good = checked.mended.is_none();
            checked.mended
        } else {
            frozen.good = false;
            let late = schedule.reweighting_rounds + time;
            let mixture = &frozen.mixture;
            Some(taught(mixture, &found, late, schedule, seed.child(2)))
        };
        match wider {
            None => return Ok(frozen),
            Some(mixture) => frozen.mixture = mixture,
        }
    }
    Ok(frozen)
}

/// What a round of draws teaches: in the first ones how much each component
/// holds, then where it is far too low, and which components the heavy draws
/// make.
pub(super) fn taught(
    mixture: &Mixture,
    found: &[Particle],
    round: u64,
    schedule: &Schedule,
    seed: Seed,
) -> Mixture {
    let weights = cut(found);
    let rows: Vec<Vec<f64>> = found.iter().map(|p| p.z.clone()).collect();
    let reweighted = || {
        mixture.reweighted(rows.iter().map(Vec::as_slice).zip(weights.clone()))
    };
    if round < schedule.reweighting_rounds {
        return reweighted();
    }
    if round.is_multiple_of(2) {
        let added = Mixture::fit(&rows, &weights, ADDED, &mut seed.rng());
        return added
            .map_or_else(reweighted, |added| added.beside(mixture.clone()));
    }
    let scale = log_mean_weight(found);
    let targets: Vec<f64> =
        found.iter().map(|p| p.log_target() - scale).collect();
    mixture.mended(&rows, &weights, &targets).unwrap_or_else(reweighted)
}
