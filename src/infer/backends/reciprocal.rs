//! The evidence from a chain's draws, as in the paper's appendix B.
//!
//! 1/Z = mean of g/(L pi) over posterior draws, g a normal density with the
//! mean and covariance of posterior draws (Heredia et al. 2020, equation A8):
//! here those of the first half of each chain, the mean being over the other.
//! It costs nothing beyond the chains, but wherever the posterior's tails fall
//! off faster than g's its variance is infinite: the Pareto index of the
//! ratios says when not to believe it.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use statrs::function::erf::erfc;

use crate::draws::{Draws, ess_mean, psis};
use crate::error::{Error, Result};
use crate::infer::{
    Backend, Effort, Evidence, Inference, MetropolisHastings, Progress,
};
use crate::model::{Point, Posterior};
use crate::parallel;
use crate::seed::Seed;

/// The paper's estimator, on the paper's random walk.
#[derive(Debug, Clone, PartialEq)]
pub struct ReciprocalImportance {
    /// The chains whose draws it uses.
    pub chains: MetropolisHastings,
}

impl ReciprocalImportance {
    /// On chains of an effort.
    pub fn of_effort(effort: &Effort) -> Self {
        Self { chains: MetropolisHastings::random_walk(effort) }
    }

    /// The evidence from draws that there already are.
    ///
    /// # Errors
    /// Draws without spread, or a model that fails.
    pub fn estimate(
        posterior: &Posterior<'_>,
        draws: &Draws,
    ) -> Result<(Evidence, Vec<String>)> {
        let chains = log_ratios(posterior, draws)?;
        let all = chains.concat();
        let top = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let ratios: Vec<Vec<f64>> = chains
            .iter()
            .map(|c| c.iter().map(|l| (l - top).exp()).collect())
            .collect();
        let n = all.len() as f64;
        let mean = ratios.iter().flatten().sum::<f64>() / n;
        let square =
            ratios.iter().flatten().map(|r| (r - mean).powi(2)).sum::<f64>();
        let se = (square / n / ess_mean(&ratios)).sqrt() / mean;
        let (_, k) = psis(&all);
        let mut warnings = Vec::new();
        if k > 0.5 {
            warnings.push(format!(
                "the estimator of appendix B has a poor variance here (Pareto \
                 k = {k:.2}, above 0.5): its error is likely larger than \
                 stated; use smc or importance"
            ));
        }
        let outside = share_outside(posterior, draws);
        if outside > se {
            warnings.push(format!(
                "{:.1} % of the normal density of appendix B lies outside the \
                 priors' bounds: the log evidence is too high by about {:.3}; \
                 use smc or importance",
                100.0 * outside,
                -(-outside.min(0.999)).ln_1p()
            ));
        }
        let method = "reciprocal importance sampling (appendix B)".into();
        Ok((Evidence { log: -(mean.ln() + top), se, method }, warnings))
    }
}

/// How much of g lies beyond the bounds of the parameters, one by one: there
/// the posterior has no draws, and what g weighs there is missing from the
/// mean, which the ratios at the draws cannot show. Bounds that follow from
/// other parameters reach at least as far as the draws do.
fn share_outside(posterior: &Posterior<'_>, draws: &Draws) -> f64 {
    let (mean, covariance) = (draws.mean(), draws.covariance());
    let parameters = posterior.parameters().iter().enumerate();
    parameters
        .map(|(i, parameter)| {
            let width = (2.0 * covariance[(i, i)]).sqrt();
            let (low, high) = draws
                .column(i)
                .iter()
                .flatten()
                .fold(parameter.bounds, |(low, high), x| {
                    (low.min(*x), high.max(*x))
                });
            let below = erfc((mean[i] - low) / width);
            let above = erfc((high - mean[i]) / width);
            0.5 * (below + above)
        })
        .sum()
}

/// ln g - ln(L pi) at the second half of each chain, with a g fitted to the
/// first halves. Fitted to the very draws that it is averaged over, g follows
/// their chance, and the spread of the ratios does not show by how much.
fn log_ratios(
    posterior: &Posterior<'_>,
    draws: &Draws,
) -> Result<Vec<Vec<f64>>> {
    let middle = draws.iterations() / 2;
    let g = Normal::fitted(draws, middle)?;
    let ratio = |row: &[f64]| -> Result<f64> {
        let density = posterior.density(Point::Natural(row))?;
        Ok(g.log_density(row) - density.natural())
    };
    (0..draws.chains())
        .map(|c| {
            parallel::try_map(middle..draws.iterations(), |i| {
                ratio(draws.row(c, i))
            })
        })
        .collect()
}

/// A normal density with the mean and covariance of draws.
struct Normal {
    mean: DVector<f64>,
    factor: DMatrix<f64>,
    log_constant: f64,
}

impl Normal {
    /// Of so many first iterations of all chains.
    fn fitted(draws: &Draws, iterations: usize) -> Result<Self> {
        let names = draws.names().to_vec();
        let mut chosen = Draws::new(names, draws.units().to_vec())?;
        for c in 0..draws.chains() {
            let rows = (0..iterations).map(|i| draws.row(c, i));
            chosen.push_chain(rows.collect::<Vec<_>>().concat(), None)?;
        }
        let shape = chosen.covariance().cholesky().ok_or_else(|| {
            Error::inference(
                "the draws have no spread in some direction: no normal \
                 density fits them",
            )
        })?;
        let (n, factor) = (draws.dimension() as f64, shape.l());
        let log_det: f64 = factor.diagonal().map(f64::ln).sum();
        let log_constant = -0.5 * n * (2.0 * PI).ln() - log_det;
        let mean = DVector::from_vec(chosen.mean());
        Ok(Self { mean, factor, log_constant })
    }

    fn log_density(&self, row: &[f64]) -> f64 {
        let mut d = DVector::from_column_slice(row) - &self.mean;
        self.factor.solve_lower_triangular_mut(&mut d);
        self.log_constant - 0.5 * d.norm_squared()
    }
}

impl Backend for ReciprocalImportance {
    fn name(&self) -> &'static str {
        "reciprocal"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        posterior.require_proper("the estimator of appendix B")?;
        let mut inference = self.chains.explore(posterior, seed, progress)?;
        if let Some(draws) = &inference.draws {
            let (evidence, warnings) = Self::estimate(posterior, draws)?;
            inference.evidence = Some(evidence);
            inference.warnings.extend(warnings);
        }
        Ok(inference)
    }
}
