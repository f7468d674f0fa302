//! The evidence from fresh draws of a frozen proposal.
//!
//! Nothing that made the proposal is counted again: draws that chose it would
//! lean towards the places that they happened to meet, and towards too small
//! an error.

use rayon::prelude::*;

use super::adapt::Frozen;
use super::proposal::{Base, Particle, population};
use super::schedule::Schedule;
use super::weights::{quality, summed};
use super::{Evidence, Inference, draws_of};
use crate::error::Result;
use crate::model::Posterior;
use crate::seed::Seed;

/// How sharp an estimate has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    /// As the schedule asks.
    Sharp,
    /// A few draws, of what is so far below the best that no answer depends
    /// on it.
    Rough,
}

/// Draws of a rough estimate.
const ROUGH: usize = 300;

/// How many draws make an estimate as sharp as asked: the relative variance of
/// a mean of n weights is their own over n.
fn count(frozen: &Frozen, schedule: &Schedule, precision: Precision) -> usize {
    let (fewest, most) = schedule.final_draws;
    match precision {
        Precision::Rough => ROUGH,
        Precision::Sharp => {
            let needed = frozen.excess / schedule.error.powi(2);
            (needed as usize).clamp(fewest, most)
        }
    }
}

/// Evidence and draws from fresh draws of a frozen proposal.
///
/// # Errors
/// No draw with a positive density, or a model that fails.
pub(super) fn estimated(
    posterior: &Posterior<'_>,
    frozen: &Frozen,
    schedule: &Schedule,
    precision: Precision,
    seed: Seed,
) -> Result<Estimate> {
    let count = count(frozen, schedule, precision);
    let base = Base::Mixture(frozen.mixture.clone());
    let found = population(posterior, &base, count, seed.child(0))?;
    let does = schedule.does(quality(&found));
    let mut made = concluded(posterior, &found, seed.child(1))?;
    if let Some(evidence) = &mut made.evidence
        && frozen.excess.is_finite()
    {
        // Draws that were moved on may know of weights that these do not.
        let seen = (frozen.excess / count as f64).sqrt();
        evidence.se = evidence.se.max(seen.min(1.0));
    }
    Ok(Estimate { made, found, does })
}

/// What fresh draws say.
pub(super) struct Estimate {
    pub(super) made: Inference,
    pub(super) found: Vec<Particle>,
    /// Whether their weights are as good as the proposal was judged to be.
    pub(super) does: bool,
}

/// Evidence and draws from weighted particles.
///
/// # Errors
/// As [`estimated`].
pub(super) fn concluded(
    posterior: &Posterior<'_>,
    found: &[Particle],
    seed: Seed,
) -> Result<Inference> {
    let sum = summed(found)?;
    let rows = sum
        .chosen(seed)
        .par_iter()
        .map(|&i| posterior.natural(&found[i].z))
        .collect::<Result<Vec<_>>>()?
        .concat();
    let mut draws = draws_of(posterior)?;
    draws.push_chain(rows, None)?;
    Ok(Inference {
        draws: Some(draws),
        evidence: Some(Evidence {
            log: sum.log,
            se: sum.se,
            method: "importance sampling by a Student-t mixture".into(),
        }),
        warnings: sum.warnings,
        ..Inference::default()
    })
}
