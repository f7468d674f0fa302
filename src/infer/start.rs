//! Where chains start: at good places, far apart.
//!
//! R-hat tells of a mode only where some chain is in it (Gelman and Rubin
//! 1992 ask for starts that are more scattered than the posterior). Started
//! each at the best of a few draws from the prior, four chains were all in
//! one of two far modes with 5 of 20 seeds, and agreed.

use rand_distr::{Distribution, StandardNormal};

use crate::error::{Error, Result};
use crate::model::{Point, Posterior};
use crate::parallel;
use crate::seed::{Rng, Seed};

/// How many draws from the prior compete for a chain's start.
const CONTENDERS: usize = 40;

/// The best of a few draws from the prior, or of scattered places on the
/// line where a prior is improper.
pub(super) fn best_start(
    posterior: &Posterior<'_>,
    rng: &mut Rng,
) -> Result<Vec<f64>> {
    let mut best: Option<(f64, Vec<f64>)> = None;
    for round in 0..50 * CONTENDERS {
        let (density, found) = if posterior.is_proper() {
            posterior.draw_prior(rng)?
        } else {
            let z: Vec<f64> = (0..posterior.dimension())
                .map(|_| StandardNormal.sample(rng))
                .map(|z: f64| 2.0 * z)
                .collect();
            posterior.collect(Point::Line(&z))?
        };
        let height = density.natural();
        if density.rejected.is_none()
            && best.as_ref().is_none_or(|(top, _)| height > *top)
        {
            best = Some((height, found.natural));
        }
        if round + 1 >= CONTENDERS && best.is_some() {
            break;
        }
    }
    let (_, start) = best.ok_or_else(|| {
        Error::inference(
            "no draw from the prior has a positive density: prior and \
             recording contradict each other, or the model rejects everything",
        )
    })?;
    Ok(start)
}

/// Of how many whole draws from the prior the likeliest is a start, and how
/// many are made for these at the most.
const DRAWN: usize = 8;
const TRIES: usize = 200;

/// The likeliest of a few draws from the prior; `None` where all are cut
/// short.
pub(super) fn likely(
    posterior: &Posterior<'_>,
    seed: Seed,
) -> Result<Option<Vec<f64>>> {
    let mut rng = seed.rng();
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut whole = 0;
    for _ in 0..TRIES {
        let Some(line) = posterior.draw_place(&mut rng)? else {
            continue;
        };
        let log = posterior.density(Point::Line(&line))?.log_likelihood;
        if best.as_ref().is_none_or(|(most, _)| log > *most) {
            best = Some((log, line));
        }
        whole += 1;
        if whole == DRAWN {
            break;
        }
    }
    Ok(best.map(|(_, line)| line))
}

/// From how many good places each start is chosen.
const CHOICE: usize = 4;

/// Starts for so many chains: of [`CHOICE`] times as many good places the
/// highest, and then always the one farthest from those chosen.
pub(super) fn apart(
    posterior: &Posterior<'_>,
    chains: usize,
    seed: Seed,
) -> Result<Vec<Vec<f64>>> {
    let mut good = parallel::try_map(0..(CHOICE * chains) as u64, |i| {
        let start = best_start(posterior, &mut seed.child(i).rng())?;
        let height = posterior.density(Point::Natural(&start))?.natural();
        Ok((height, posterior.line(&start)?, start))
    })?;
    good.sort_by(|a, b| b.0.total_cmp(&a.0));
    let lines: Vec<&[f64]> = good.iter().map(|g| &g.1[..]).collect();
    let chosen = far_apart(&lines, chains);
    Ok(chosen.into_iter().map(|i| good[i].2.clone()).collect())
}

/// The first of some places, and then always the one whose nearest of those
/// chosen is farthest, in standard deviations of the places.
fn far_apart(places: &[&[f64]], count: usize) -> Vec<usize> {
    let spreads = spreads(places);
    let distance = |i: usize, j: usize| -> f64 {
        let pairs = places[i].iter().zip(places[j]).zip(&spreads);
        pairs.map(|((a, b), sd)| ((a - b) / sd).powi(2)).sum()
    };
    let mut chosen = Vec::with_capacity(count);
    let mut nearest = vec![f64::INFINITY; places.len()];
    let mut next = 0;
    while chosen.len() < count {
        chosen.push(next);
        for (i, near) in nearest.iter_mut().enumerate() {
            *near = near.min(distance(i, next));
        }
        let far = (0..places.len())
            .max_by(|i, j| nearest[*i].total_cmp(&nearest[*j]));
        next = far.unwrap_or(0);
    }
    chosen
}

/// The standard deviation of each parameter; 1 where it has none.
fn spreads(places: &[&[f64]]) -> Vec<f64> {
    let n = places.len().max(1) as f64;
    let dimension = places.first().map_or(0, |place| place.len());
    (0..dimension)
        .map(|k| {
            let mean = places.iter().map(|p| p[k]).sum::<f64>() / n;
            let off = places.iter().map(|p| (p[k] - mean).powi(2));
            let sd = (off.sum::<f64>() / n).sqrt();
            if sd > 0.0 { sd } else { 1.0 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_is_the_farthest_from_all_before() {
        let places = [[0.0, 0.0], [1.0, 0.0], [9.0, 1.0], [5.0, 0.5]];
        let places: Vec<&[f64]> = places.iter().map(|p| &p[..]).collect();
        assert_eq!(far_apart(&places, 3), [0, 2, 3]);
        assert_eq!(far_apart(&places[..1], 2), [0, 0]);
        assert!(far_apart(&places[..1], 0).is_empty());
    }
}
