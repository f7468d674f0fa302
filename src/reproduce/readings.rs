//! What else the paper's protocol may have been, and the observation of its
//! equation 13: each calibrated exactly, by quadrature.

use super::coverage::{Reading, reading};
use super::experiment::{TRUTH, WIDE, plan, series};
use crate::error::Result;
use crate::infer::Progress;
use crate::observe::Series;
use crate::seed::Seed;

/// A finer time step of the errors \[s\].
const FINE: f64 = 0.1;

/// Other ways in which the synthetic errors may have been made.
pub(super) fn readings(
    samples: usize,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Vec<Reading>> {
    let plain = plan(1.0, 0.0)?;
    let fine = plan(FINE, 0.0)?;
    let [mu, xi, phi, sigma2] = TRUTH;
    let with = |sigma2: f64| [mu, xi, phi, sigma2];
    let of = |what, place: u64, draw: &(dyn Fn(Seed) -> _ + Sync)| {
        let seed = seed.child(place);
        reading(what, samples, &plain, &WIDE, seed, progress, draw)
    };
    Ok(vec![
        of("errors drawn with sigma = 8.07 for sigma2 = 8.07", 0, &|seed| {
            series(&plain, with(sigma2 * sigma2), seed)
        })?,
        of("errors drawn every 0.1 s, every tenth kept", 1, &|seed| {
            every_tenth(&series(&fine, TRUTH, seed)?, &plain)
        })?,
        of(
            "8.07 the variance of the errors, not of their innovations",
            2,
            &{ |seed| series(&plain, with(sigma2 * (1.0 - phi * phi)), seed) },
        )?,
        of("errors of twice the standard deviation", 3, &|seed| {
            series(&plain, with(4.0 * sigma2), seed)
        })?,
    ])
}

/// The values of a fine series that fall on the plan's times.
fn every_tenth(fine: &Series, plan: &crate::observe::Event) -> Result<Series> {
    let values = fine.values().chunks(10).filter_map(|c| c.last().copied());
    plan.velocity.with_values(values.collect())
}

/// Series of mean speeds over the last second (equation 13), calibrated as
/// what they are and as if they were speeds of one instant.
pub(super) fn windows(
    samples: usize,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<[Reading; 2]> {
    let mean = plan(1.0, 1.0)?;
    let instant = plan(1.0, 0.0)?;
    let right = reading(
        "calibrated as mean speeds",
        samples,
        &mean,
        &WIDE,
        seed,
        progress,
        &|seed| series(&mean, TRUTH, seed),
    )?;
    let wrong = reading(
        "calibrated as speeds of one instant",
        samples,
        &instant,
        &WIDE,
        seed,
        progress,
        &|seed| {
            let seen = series(&mean, TRUTH, seed)?;
            instant.velocity.with_values(seen.values().to_vec())
        },
    )?;
    Ok([right, wrong])
}
