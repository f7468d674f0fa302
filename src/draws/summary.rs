//! A line of figures for each parameter.

use super::Draws;
use super::ess::{effective, ess_below};
use super::quantile::{quantile, sorted};
use super::rhat::{of_ranks, rank_normalised, split};
use super::spectrum::{mean, variance};

/// What is reported of one parameter; figures that do not exist are NaN.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// The parameter's name.
    pub name: String,
    /// The unit of all figures but `rhat`, `ess_bulk` and `ess_tail`.
    pub unit: String,
    /// The mean of all draws.
    pub mean: f64,
    /// Their standard deviation, with divisor draws - 1.
    pub sd: f64,
    /// The 2.5 % quantile.
    pub q025: f64,
    /// The 5 % quantile.
    pub q05: f64,
    /// The lower quartile.
    pub q25: f64,
    /// The median.
    pub q50: f64,
    /// The upper quartile.
    pub q75: f64,
    /// The 95 % quantile.
    pub q95: f64,
    /// The 97.5 % quantile.
    pub q975: f64,
    /// See [`rhat`](super::rhat()).
    pub rhat: f64,
    /// See [`ess_bulk`](super::ess_bulk).
    pub ess_bulk: f64,
    /// See [`ess_tail`](super::ess_tail).
    pub ess_tail: f64,
    /// See [`mcse_mean`](super::mcse_mean).
    pub mcse_mean: f64,
}

/// A summary of each parameter, in their order.
///
/// The same figures as the single functions give, with the draws sorted and
/// ranked once.
pub fn summarise(draws: &Draws) -> Vec<Summary> {
    (0..draws.dimension()).map(|parameter| of_one(draws, parameter)).collect()
}

fn of_one(draws: &Draws, parameter: usize) -> Summary {
    let chains = draws.column(parameter);
    let pooled = sorted(chains.concat());
    let q = |p| quantile(&pooled, p);
    let (q05, q50, q95) = (q(0.05), q(0.5), q(0.95));
    let [mut rhat, mut ess_bulk, mut ess_mean] = [f64::NAN; 3];
    if let Some(halves) = split(&chains) {
        let ranks = rank_normalised(&halves);
        rhat = of_ranks(&halves, &ranks, q50);
        ess_bulk = effective(&ranks);
        ess_mean = effective(&halves);
    }
    let variance = variance(&pooled);
    Summary {
        name: draws.names()[parameter].clone(),
        unit: draws.units()[parameter].clone(),
        mean: mean(&pooled),
        sd: variance.sqrt(),
        q025: q(0.025),
        q05,
        q25: q(0.25),
        q50,
        q75: q(0.75),
        q95,
        q975: q(0.975),
        rhat,
        ess_bulk,
        ess_tail: ess_below(&chains, q05).min(ess_below(&chains, q95)),
        mcse_mean: (variance / ess_mean).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::quantile::median;
    use crate::draws::{self, sample};

    #[test]
    fn quantiles_are_those_of_type_seven() {
        // numpy.quantile([1, 3, 4, 10, 20], p), its default method.
        let x = [1.0, 3.0, 4.0, 10.0, 20.0];
        let expected = [(0.0, 1.0), (0.1, 1.8), (0.6, 6.4), (1.0, 20.0)];
        for (p, value) in expected {
            sample::close(quantile(&x, p), value, 1e-14);
        }
        assert!(quantile(&x, 1.1).is_nan());
        assert!(quantile(&x, f64::NAN).is_nan());
        assert!(quantile(&sorted(vec![-f64::NAN, 1.0]), 0.1).is_nan());
        let infinite = [f64::NEG_INFINITY, f64::INFINITY];
        assert_eq!(quantile(&infinite, 1.0), f64::INFINITY);
        assert_eq!(median(&[f64::INFINITY; 2]), f64::INFINITY);
    }

    #[test]
    fn summary_repeats_the_single_functions() {
        let chains = sample::chains(3, 101, 0.5);
        let found = &summarise(&sample::draws(&chains))[0];
        assert_eq!((&*found.name, &*found.unit), ("x", "m"));
        let pooled = sorted(chains.concat());
        assert_eq!(found.q25, quantile(&pooled, 0.25));
        assert_eq!(found.rhat, draws::rhat(&chains));
        assert_eq!(found.ess_bulk, draws::ess_bulk(&chains));
        assert_eq!(found.ess_tail, draws::ess_tail(&chains));
        // The variance of sorted numbers sums in another order.
        sample::close(found.mcse_mean, draws::mcse_mean(&chains), 1e-12);
        sample::close(found.sd.powi(2), variance(&pooled), 1e-12);
    }

    #[test]
    fn constant_and_broken_chains_have_no_diagnostics() {
        let constant = &summarise(&sample::draws(&[vec![0.3; 20]]))[0];
        assert_eq!((constant.mean, constant.sd), (0.3, 0.0));
        assert!(constant.rhat.is_nan() && constant.ess_tail.is_nan());
        let broken = vec![1.0, f64::NAN, 2.0, 3.0, 4.0];
        let broken = &summarise(&sample::draws(&[broken]))[0];
        assert!(broken.mean.is_nan() && broken.q50.is_nan());
        let none = &summarise(&sample::draws(&[]))[0];
        assert!(none.mean.is_nan() && none.q50.is_nan());
    }
}
