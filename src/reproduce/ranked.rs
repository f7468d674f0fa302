//! Whether the walk is right about what it does not know: simulation-based
//! calibration of both models.

use super::experiment::{WIDE, Which, model, on};
use crate::error::{Error, Result};
use crate::infer::{Effort, MetropolisHastings, Progress};
use crate::model::Model;
use crate::observe::Series;
use crate::physics::Track;
use crate::sbc::{Ranks, ranks};
use crate::seed::Seed;

/// Enough that 99 draws kept are next to independent: an effective draw of
/// the walk on these models takes some 20 steps.
const WALK: Effort = Effort { chains: 1, draws: 6000, warmup: 1500 };

/// A slope in three parts, long enough for any draw from the priors: on the
/// study's own track a fast mass of the prior's passes the end, and what it
/// recorded there cannot be calibrated.
fn slope() -> Result<Track> {
    let x = [0.0, 150.0, 350.0, 5000.0];
    Track::from_points(&x, &[0.0, -115.0, -230.0, -1800.0])
}

/// The ranks under M0 and M1 over so many replications.
pub(super) fn ranked(
    replications: usize,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<[Ranks; 2]> {
    let [m0, m1] =
        Which::BOTH.map(|which| of(which, replications, seed, progress));
    Ok([m0?, m1?])
}

fn of(
    which: Which,
    replications: usize,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Ranks> {
    let plan = on(slope()?, 1.0, 0.0)?;
    let remade = |seen: &[Series]| -> Result<Box<dyn Model>> {
        let series = seen.first().cloned();
        let series =
            series.ok_or_else(|| Error::inference("nothing was simulated"))?;
        let event = plan.with_recording(series)?;
        Ok(Box::new(model(event, which, &WIDE)?))
    };
    let prior = model(plan.clone(), which, &WIDE)?;
    let walk = MetropolisHastings::adaptive(&WALK);
    let seed = seed.child(which as u64);
    let both: [crate::sbc::Making<'_>; 2] = [&remade, &remade];
    ranks(&prior, both, &walk, replications, seed, progress)
}
