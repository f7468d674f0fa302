//! The rank-normalised split R-hat, which says whether chains agree.
//!
//! After Vehtari, Gelman, Simpson, Carpenter & Buerkner (2021), "Rank-
//! normalization, folding, and localization: an improved R-hat for assessing
//! convergence of MCMC", Bayesian Analysis 16(2).

use statrs::distribution::{ContinuousCDF, Normal};

use super::quantile::{quantile, sorted};
use super::spectrum::{mean, variance};

/// The rank-normalised split R-hat of one parameter, chain by chain.
///
/// The larger of two: of the ranks, which sees chains of different location,
/// and of the ranks of distances to the median, which sees chains of
/// different scale. Near 1 is good; the paper asks for less than 1.01.
///
/// One chain will do, since chains are halved. NaN below four iterations, for
/// chains of different lengths, for non-finite draws and for constants.
///
/// ```
/// use couloir::draws::rhat;
/// let there: Vec<f64> = (0..100).map(|i| (i as f64).sin()).collect();
/// let elsewhere: Vec<f64> = there.iter().map(|x| x + 5.0).collect();
/// assert!(rhat(&[there.clone(), there.clone()]) < 1.01);
/// assert!(rhat(&[there, elsewhere]) > 1.5);
/// assert!(rhat(&[]).is_nan());
/// ```
pub fn rhat(chains: &[Vec<f64>]) -> f64 {
    let Some(halves) = split(chains) else { return f64::NAN };
    let median = quantile(&sorted(chains.concat()), 0.5);
    of_ranks(&halves, &rank_normalised(&halves), median)
}

/// R-hat of split chains whose ranks and median are at hand.
pub(super) fn of_ranks(
    halves: &[&[f64]],
    ranks: &[Vec<f64>],
    median: f64,
) -> f64 {
    let distances =
        |half: &&[f64]| half.iter().map(|x| (x - median).abs()).collect();
    let folded: Vec<Vec<f64>> = halves.iter().map(distances).collect();
    let folded = rank_normalised(&folded);
    potential_scale(ranks).max(potential_scale(&folded))
}

/// The halves of every chain, without the middle draw of an odd number;
/// nothing where a diagnostic has nothing to say (see [`rhat`]).
pub(super) fn split(chains: &[Vec<f64>]) -> Option<Vec<&[f64]>> {
    let n = chains.first()?.len();
    let first = *chains.first()?.first()?;
    let pooled = || chains.iter().flatten();
    let usable = n >= 4
        && chains.iter().all(|chain| chain.len() == n)
        && pooled().all(|x| x.is_finite())
        && pooled().any(|x| *x != first);
    let halves = |chain| {
        let chain: &[f64] = chain;
        [&chain[..n / 2], &chain[n - n / 2..]]
    };
    usable.then(|| chains.iter().flat_map(|chain| halves(chain)).collect())
}

/// Normal scores of the ranks over all chains, ties sharing their mean rank
/// (with the offsets of Blom 1958).
pub(super) fn rank_normalised(chains: &[impl AsRef<[f64]>]) -> Vec<Vec<f64>> {
    let pooled = chains.iter().flat_map(|chain| chain.as_ref());
    let mut order: Vec<(f64, usize)> =
        pooled.enumerate().map(|(at, x)| (*x, at)).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let total = order.len();
    let normal = Normal::standard();
    let mut scores = vec![0.0; total];
    let mut below = 0;
    for ties in order.chunk_by(|a, b| a.0 == b.0) {
        let rank = below as f64 + (ties.len() + 1) as f64 / 2.0;
        let score = normal.inverse_cdf((rank - 0.375) / (total as f64 + 0.25));
        ties.iter().for_each(|(_, at)| scores[*at] = score);
        below += ties.len();
    }
    let mut rest = scores.as_slice();
    let take = |chain: &_| {
        let (head, tail) = rest.split_at(AsRef::<[f64]>::as_ref(chain).len());
        rest = tail;
        head.to_vec()
    };
    chains.iter().map(take).collect()
}

/// The square root of the pooled variance over that within chains (Gelman &
/// Rubin 1992).
fn potential_scale(chains: &[Vec<f64>]) -> f64 {
    let n = chains.first().map_or(0, Vec::len) as f64;
    let means: Vec<f64> = chains.iter().map(|chain| mean(chain)).collect();
    let within: f64 = chains.iter().map(|chain| variance(chain)).sum::<f64>()
        / chains.len() as f64;
    ((n - 1.0) / n + variance(&means) / within).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::sample::{chains, close};

    // Reference values from ArviZ (arviz-stats 0.8.0) on the same numbers;
    // the tolerance allows for its own inverse normal distribution.

    #[test]
    fn agrees_with_arviz() {
        let mut shifted = chains(4, 250, 0.6);
        for (c, chain) in shifted.iter_mut().enumerate() {
            chain.iter_mut().for_each(|x| *x += 0.1 * c as f64);
        }
        close(rhat(&shifted), 1.0728934037702862, 1e-9);
        let mut odd = chains(4, 251, 0.9);
        odd.iter_mut().flatten().for_each(|x| *x = x.exp());
        // Distances are to the median of all draws, as in the R package
        // posterior; ArviZ leaves out the middle draws before (1.0353136),
        // so these distances were put through its R-hat of method z_scale.
        close(rhat(&odd), 1.036147104602677, 1e-9);
    }

    #[test]
    fn folding_sees_a_difference_of_scale() {
        let mut scaled = chains(2, 100, 0.5);
        scaled[0].iter_mut().for_each(|x| *x *= 3.0);
        close(rhat(&scaled), 1.2011306614409396, 1e-9);
        let halves = split(&scaled).unwrap();
        let unfolded = potential_scale(&rank_normalised(&halves));
        close(unfolded, 1.0229125603763038, 1e-9);
    }

    #[test]
    fn ties_share_a_rank() {
        let found = rank_normalised(&[[1.0, 1.0], [0.0, 2.0]]);
        // Ranks 2.5, 2.5, 1, 4 of 4: scores 0, 0, and -+ the normal
        // quantile of 0.625 / 4.25, -1.0491314 (scipy.stats.norm.ppf).
        assert_eq!(found[0], [0.0, 0.0]);
        close(found[1][0], -1.0491313979639725, 1e-12);
        close(found[1][1], 1.0491313979639725, 1e-12);
    }

    #[test]
    fn stuck_chains_are_infinitely_apart() {
        assert_eq!(rhat(&[vec![1.0; 10], vec![2.0; 10]]), f64::INFINITY);
    }

    #[test]
    fn two_values_are_enough() {
        let flip = vec![0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0];
        assert!(rhat(&[flip]).is_finite());
    }

    #[test]
    fn no_figure_is_nan() {
        let fine = vec![1.0, 2.0, 3.0, 4.0];
        let ragged = [fine.clone(), vec![1.0]];
        assert!(rhat(&ragged).is_nan());
        let short = &fine[..3];
        for bad in [&[], short, &[1.0; 8], &[1.0, f64::NAN, 2.0, 3.0]] {
            assert!(rhat(&[bad.to_vec()]).is_nan());
        }
        assert!(rhat(&[fine]).is_finite());
    }
}
