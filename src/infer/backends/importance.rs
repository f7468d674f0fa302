//! Importance sampling from a fitted mixture: evidence, and draws with it.
//!
//! Z = E_q[p/q] for any q that reaches wherever p does. q is a mixture of
//! Student-t distributions fitted to the draws of a short pilot run, refitted
//! twice, mended where it is far too low, with a share of the prior. The
//! weights say how good it is: their spread gives the standard error, their
//! Pareto tail whether to believe it (Vehtari, Simpson, Gelman, Yao, Gabry
//! 2024). What q hardly ever reaches its own draws do not tell; those of the
//! pilot do, at which the weights are looked at too.

use super::smc::Smc;
use crate::draws::Draws;
use crate::error::Result;
use crate::infer::estimate::concluded;
use crate::infer::proposal::Mixture;
use crate::infer::proposal::{Base, Particle, log_target, population};
use crate::infer::weights::{cut, log_mean_weight};
use crate::infer::{Backend, Effort, Inference, Progress, draws_of};
use crate::model::{Density, Point, Posterior};
use crate::parallel;
use crate::seed::Seed;

/// Importance sampling by a Student-t mixture.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportanceSampling {
    /// How many draws the estimate is made of.
    pub draws: usize,
    /// The run that finds where the posterior lies.
    pub pilot: Smc,
}

impl Default for ImportanceSampling {
    fn default() -> Self {
        Self {
            draws: 20_000,
            pilot: Smc { particles: 1000, refine: false, ..Smc::default() },
        }
    }
}

impl ImportanceSampling {
    /// As many draws as fit an effort.
    pub fn of_effort(effort: &Effort) -> Self {
        let draws = (effort.chains * effort.draws / 2).max(1000);
        Self { draws, ..Self::default() }
    }
}

/// How often the mixture is refitted to weighted draws.
const REFITS: u64 = 2;

/// How often components are added to it at the most.
const MENDS: u64 = 6;

/// Said where every batch of draws found places that the last had not.
const UNMENDED: &str = "the importance proposal was still too low in places \
    after it was mended six times: draws and evidence may miss narrow places; \
    compare with nuts, or write the model non-centred";

impl Backend for ImportanceSampling {
    fn name(&self) -> &'static str {
        "importance"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        posterior.require_proper("importance sampling")?;
        let pilot = self.pilot.explore(posterior, seed.child(0), progress)?;
        let draws = pilot.draws.unwrap_or(draws_of(posterior)?);
        self.from_draws(posterior, &draws, seed.child(1), progress)
    }
}

/// How many draws a mixture is fitted to at the most.
const FITTED: usize = 2000;

impl ImportanceSampling {
    /// The same without a pilot run, from posterior draws that there are.
    ///
    /// # Errors
    /// An improper prior, or a model that fails.
    pub fn from_draws(
        &self,
        posterior: &Posterior<'_>,
        draws: &Draws,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        posterior.require_proper("importance sampling")?;
        let given: Vec<Vec<f64>> = draws
            .thinned(FITTED)
            .into_iter()
            .map(|row| posterior.line(row))
            .collect::<Result<_>>()?;
        progress.begin("importance sampling", None);
        let densities: Vec<Density> =
            parallel::try_map(&given, |z| posterior.density(Point::Line(z)))?;
        let mut base = self.fitted(posterior, &given, seed, progress)?;
        let mut whole = true;
        if let Base::Mixture(mixture) = base {
            let targets: Vec<f64> = densities.iter().map(log_target).collect();
            let given = (&given[..], &targets[..]);
            let seed = seed.child(30);
            (base, whole) =
                self.mended(posterior, mixture, given, seed, progress)?;
        }
        let found = population(posterior, &base, self.draws, seed.child(20))?;
        let given: Vec<Particle> = given
            .into_iter()
            .zip(&densities)
            .map(|(z, density)| base.weighed(z, density))
            .collect();
        let mut made = concluded(posterior, &found, seed.child(21))?;
        if let Some(evidence) = &mut made.evidence {
            let seen = error_at(&given, evidence.log, found.len());
            evidence.se = evidence.se.max(seen);
        }
        if !whole {
            made.warnings.push(UNMENDED.to_owned());
        }
        Ok(made)
    }

    /// A proposal fitted to given draws, then to its own as well.
    fn fitted(
        &self,
        posterior: &Posterior<'_>,
        given: &[Vec<f64>],
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Base> {
        let even = vec![1.0 / given.len() as f64; given.len()];
        let mut base = fit(given, &even, seed.child(1));
        for round in 0..REFITS {
            let count = (self.draws / 4).clamp(500, FITTED);
            let found =
                population(posterior, &base, count, seed.child(2 + round))?;
            let (rows, weights) = joined(given, found);
            base = fit(&rows, &weights, seed.child(10 + round));
            progress.advance(count as u64);
        }
        Ok(base)
    }

    /// A proposal with more components where given draws, whose target
    /// densities come with them, or its own show that it is far too low
    /// (incremental mixture importance sampling, Raftery, Bao 2010), and
    /// whether its last draws show no such place any more. A mixture of a few
    /// components fits the bulk, whatever it leaves out of a bent tail.
    fn mended(
        &self,
        posterior: &Posterior<'_>,
        mut mixture: Mixture,
        (places, known): (&[Vec<f64>], &[f64]),
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<(Base, bool)> {
        for round in 0..MENDS {
            let count = (self.draws / 4).max(500);
            let base = Base::Mixture(mixture.clone());
            let found =
                population(posterior, &base, count, seed.child(round))?;
            let scale = log_mean_weight(&found);
            let own = found.iter().map(Particle::log_target);
            let both = known.iter().copied().chain(own);
            let targets: Vec<f64> = both.map(|log| log - scale).collect();
            let (rows, weights) = joined(places, found);
            progress.advance(count as u64);
            match mixture.mended(&rows, &weights, &targets) {
                Some(mended) => mixture = mended,
                None => return Ok((Base::Mixture(mixture), true)),
            }
        }
        Ok((Base::Mixture(mixture), false))
    }
}

/// The relative error of a mean of `count` weights w = p/q, by draws of the
/// posterior: E_q[w^2] / Z^2 = E_p[w] / Z. They may lie where draws of q never
/// do, and there the weights are large.
fn error_at(given: &[Particle], log_evidence: f64, count: usize) -> f64 {
    let second = (log_mean_weight(given) - log_evidence).exp();
    ((second - 1.0).max(0.0) / count as f64).sqrt()
}

fn fit(rows: &[Vec<f64>], weights: &[f64], seed: Seed) -> Base {
    match Mixture::fit(rows, weights, 6, &mut seed.rng()) {
        Some(mixture) => Base::Mixture(mixture),
        None => Base::Prior,
    }
}

/// What a mixture is refitted to: the given draws and the proposal's own, with
/// half of the weight each. The given draws keep every mode in.
fn joined(
    given: &[Vec<f64>],
    found: Vec<Particle>,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut weights = vec![0.5 / given.len() as f64; given.len()];
    weights.extend(cut(&found).iter().map(|w| 0.5 * w));
    let mut rows = given.to_vec();
    rows.extend(found.into_iter().map(|p| p.z));
    (rows, weights)
}

#[cfg(test)]
mod tests {
    use statrs::distribution::{ContinuousCDF, Normal};

    use super::*;
    use crate::error::Outcome;
    use crate::model::{Label, Number, Program, Run};
    use crate::prior::{self, AnyPrior};
    use crate::scalar::Real;

    /// a ~ N(0, 1), and 0 ~ N(a, 1) was seen: a is N(0, 1/2) after.
    struct Seen;

    impl Program for Seen {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let before = AnyPrior::Normal(0.0, 1.0);
            let a = run.scalar(Label::new("a", "1"), before)?;
            run.observe_each(&0.0, prior::Normal::new(a, Real::new(1.0)))
        }
    }

    #[test]
    fn draws_of_the_posterior_tell_the_error() {
        let posterior = Posterior::new(&Seen).unwrap();
        let after = Normal::new(0.0, 0.5_f64.sqrt()).unwrap();
        let n = 10_000;
        let quantile = |i| after.inverse_cdf((f64::from(i) + 0.5) / 1e4);
        let rows: Vec<_> = (0..n).map(|i| vec![quantile(i)]).collect();
        let given = rows.into_iter().map(|z| {
            let density = posterior.density(Point::Line(&z)).unwrap();
            Base::Prior.weighed(z, &density)
        });
        let given: Vec<Particle> = given.collect();
        // Z = N(0; 0, 2), and E_q[w^2] / Z^2 = 2 / sqrt(3) with the prior as
        // q.
        let log_evidence = -0.5 * (2.0 * std::f64::consts::TAU).ln();
        let found = error_at(&given, log_evidence, 100);
        let expected = ((2.0 / 3.0_f64.sqrt() - 1.0) / 100.0).sqrt();
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    }
}
