//! Tempering from a frozen proposal, where learning alone does not do.

use super::adapt::{Frozen, beside};
use super::backends::Smc;
use super::estimate::{Precision, estimated};
use super::proposal::Base;
use super::schedule::Schedule;
use super::{Inference, Progress};
use crate::error::Result;
use crate::model::Posterior;
use crate::seed::Seed;

/// Moves after each step of tempering: what is drawn from the mixture is in
/// every place already.
const MOVES: f64 = 3.0;

/// How far apart, in ln, the two estimates may lie without a warning.
const ALIKE: f64 = 1.0;

/// Tempers from a frozen proposal, and lets it learn from the particles. Where
/// its weights are good then, fresh draws of it make the estimate; else
/// the sharper of the two is the one.
///
/// # Errors
/// What no other parameter values would mend.
pub(super) fn tempered(
    posterior: &Posterior<'_>,
    frozen: &Frozen,
    schedule: &Schedule,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Inference> {
    let smc = Smc {
        particles: schedule.particles,
        moves: MOVES,
        forget: false,
        ..Smc::default()
    };
    let base = Base::Mixture(frozen.mixture.clone());
    let (led, places) =
        smc.passage_of(posterior, base, seed.child(0), progress)?;
    let even = vec![1.0 / places.len() as f64; places.len()];
    let both = beside(&frozen.mixture, &places, &even, seed.child(1));
    let Some(mixture) = both else { return Ok(led) };
    let rounds = schedule.rounds;
    let again = Frozen::new(mixture).learned(
        posterior,
        schedule,
        rounds,
        seed.child(2),
    )?;
    let precision = Precision::Sharp;
    let sampled =
        estimated(posterior, &again, schedule, precision, seed.child(3));
    Ok(match sampled {
        Ok(sampled) if again.good && sampled.does => sampled.made,
        Ok(sampled) => compared(led, sampled.made),
        // No draw had a density.
        Err(error) if error.is_inference() => led,
        Err(error) => return Err(error),
    })
}

/// The sharper of two estimates, with an error no smaller than half of what
/// the other differs by.
fn compared(led: Inference, sampled: Inference) -> Inference {
    let error = |of: &Inference| of.evidence.as_ref().map(|one| one.se);
    let (mut sharp, other) = match (error(&led), error(&sampled)) {
        (Some(one), Some(other)) if other < one => (sampled, led),
        (Some(_), Some(_)) => (led, sampled),
        _ => return led,
    };
    if let (Some(one), Some(other)) = (&mut sharp.evidence, &other.evidence) {
        let apart = (one.log - other.log).abs();
        one.se = one.se.max(0.5 * apart);
        if apart > ALIKE {
            sharp.warnings.push(format!(
                "tempering and importance sampling find log evidences that \
                 are {apart:.1} apart: the sharper one is stated"
            ));
        }
    }
    sharp
}
