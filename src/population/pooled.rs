//! What a population says: of itself, of the next member, and of each.

use rand::RngExt;

use super::hyper::Hyper;
use super::member::Member;
use crate::draws::{Draws, quantile};
use crate::parallel;
use crate::seed::Seed;

/// The levels that are told.
const LEVELS: [f64; 3] = [0.05, 0.5, 0.95];

/// How many draws of the population members are weighed by.
const LAWS: usize = 200;

/// What a population says of a parameter, with the 5 %, 50 % and 95 %
/// quantiles of each figure.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Shared {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Whether the population is normal in its logarithm.
    pub in_log: bool,
    /// The population's median, in the parameter's unit.
    pub median: [f64; 3],
    /// The population's standard deviation: of the logarithm where `in_log`.
    pub spread: [f64; 3],
    /// The next member's value, in the parameter's unit.
    pub next: [f64; 3],
    /// The standard errors of mean and spread, from halves of the members'
    /// draws, in shares of their standard deviations.
    pub errors: [f64; 2],
}

/// A member, alone and given all others.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Pooled {
    /// What it is called.
    pub name: String,
    /// The 5 %, 50 % and 95 % quantiles of each parameter, alone.
    pub alone: Vec<[f64; 3]>,
    /// The same given all members.
    pub pooled: Vec<[f64; 3]>,
    /// How many of its draws the weights are worth, under a population as it
    /// is drawn, on average.
    pub effective: f64,
}

fn quantiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    LEVELS.map(|level| quantile(&values, level))
}

/// What the population says of each parameter, but for its errors.
pub(super) fn parameters(
    hyper: &Hyper,
    draws: &Draws,
    seed: Seed,
) -> Vec<Shared> {
    let normal = rand_distr::StandardNormal;
    let of = |(k, scale): (usize, &super::hyper::Scale)| {
        let back = |place: f64| if scale.in_log { place.exp() } else { place };
        let mut rng = seed.child(k as u64).rng();
        let (mean, spread) = (draws.pooled(2 * k), draws.pooled(2 * k + 1));
        let next = mean.iter().zip(&spread).map(|(mean, spread)| {
            let z: f64 = rng.sample(normal);
            back(mean + spread * z)
        });
        let next = quantiles(next.collect());
        Shared {
            name: scale.name.clone(),
            unit: scale.unit.clone(),
            in_log: scale.in_log,
            median: quantiles(mean.into_iter().map(back).collect()),
            spread: quantiles(spread),
            next,
            errors: [f64::NAN; 2],
        }
    };
    hyper.scales.iter().enumerate().map(of).collect()
}

/// Every member, alone and given all others: the average over draws of the
/// population of its draws, weighted.
pub(super) fn members(
    hyper: &Hyper,
    members: &[Member],
    draws: &Draws,
) -> Vec<Pooled> {
    let laws: Vec<_> =
        draws.thinned(LAWS).into_iter().map(|row| hyper.law(row)).collect();
    let of = |(member, weighed): (&Member, &super::member::Weighed)| {
        let count = weighed.base.len();
        let mut weights = vec![0.0; count];
        let mut effective = 0.0;
        for law in &laws {
            let all = 0..count;
            let logs = all.map(|draw| hyper.log_weight(weighed, draw, law));
            let logs: Vec<f64> = logs.collect();
            let most = logs.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
            let own: Vec<f64> =
                logs.iter().map(|log| (log - most).exp()).collect();
            let total: f64 = own.iter().sum();
            let squares: f64 = own.iter().map(|w| w * w).sum();
            effective += total * total / squares / laws.len() as f64;
            for (sum, weight) in weights.iter_mut().zip(&own) {
                *sum += weight / total;
            }
        }
        let columns = 0..member.draws.dimension();
        let columns = columns.map(|k| member.draws.pooled(k));
        let (alone, pooled) = columns
            .map(|x| (quantiles(x.clone()), weighted(&x, &weights)))
            .unzip();
        Pooled { name: member.name.clone(), alone, pooled, effective }
    };
    parallel::map(members.iter().zip(&hyper.members), of)
}

/// Quantiles of values with weights.
fn weighted(values: &[f64], weights: &[f64]) -> [f64; 3] {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let total: f64 = weights.iter().sum();
    LEVELS.map(|level| {
        let mut below = 0.0;
        let reached = order.iter().find(|at| {
            below += weights[**at];
            below >= level * total
        });
        reached.or(order.last()).map_or(f64::NAN, |at| values[*at])
    })
}
