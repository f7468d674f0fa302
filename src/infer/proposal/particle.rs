//! Draws from a proposal, each with its densities under proposal and posterior.

use rand::RngExt;

use super::Mixture;
use crate::error::Result;
use crate::infer::log_sum_exp;
use crate::model::{Density, Point, Posterior};
use crate::parallel;
use crate::seed::{Rng, Seed};

/// The share of prior draws in the second passage's base.
pub(in crate::infer) const PRIOR_SHARE: f64 = 0.1;

/// Where a passage starts.
#[derive(Debug)]
pub(in crate::infer) enum Base {
    /// From the prior.
    Prior,
    /// From a mixture with a share of the prior.
    Mixture(Mixture),
}

impl Base {
    /// ln q at a place on the real line whose density is known.
    pub(in crate::infer) fn log_density(
        &self,
        z: &[f64],
        density: &Density,
    ) -> f64 {
        let prior = density.log_prior + density.log_jacobian;
        match self {
            Self::Prior => prior,
            Self::Mixture(mixture) => {
                blended(PRIOR_SHARE, prior, mixture.log_density(z))
            }
        }
    }

    pub(in crate::infer) fn draw(
        &self,
        posterior: &Posterior<'_>,
        rng: &mut Rng,
    ) -> Result<Particle> {
        match self {
            Self::Mixture(mixture) if rng.random::<f64>() >= PRIOR_SHARE => {
                self.particle(posterior, mixture.draw(rng))
            }
            _ => match posterior.draw_place(rng)? {
                Some(z) => self.particle(posterior, z),
                None => Ok(Particle::without_density(posterior.dimension())),
            },
        }
    }

    pub(in crate::infer) fn particle(
        &self,
        posterior: &Posterior<'_>,
        z: Vec<f64>,
    ) -> Result<Particle> {
        let density = posterior.density(Point::Line(&z))?;
        Ok(self.weighed(z, &density))
    }

    /// A place whose density is known.
    pub(in crate::infer) fn weighed(
        &self,
        z: Vec<f64>,
        density: &Density,
    ) -> Particle {
        let base = self.log_density(&z, density);
        Particle { z, base, target: log_target(density) }
    }
}

/// The log density of a proposal with a share of the prior.
pub(in crate::infer) fn blended(share: f64, prior: f64, fitted: f64) -> f64 {
    let parts = [(1.0 - share).ln() + fitted, share.ln() + prior];
    log_sum_exp(parts.into_iter())
}

/// ln of the posterior's density on the line, up to its constant.
pub(in crate::infer) fn log_target(density: &Density) -> f64 {
    density.on_line()
}

/// A place with its log densities under base and posterior.
#[derive(Debug, Clone)]
pub(crate) struct Particle {
    pub(crate) z: Vec<f64>,
    pub(in crate::infer) base: f64,
    target: f64,
}

impl Particle {
    pub(in crate::infer) fn new(z: Vec<f64>, base: f64, target: f64) -> Self {
        Self { z, base, target }
    }

    /// Somewhere, with no weight: what a draw counts as that is cut short. To
    /// draw again instead would divide the evidence by the share of whole ones.
    pub(in crate::infer) fn without_density(dimension: usize) -> Self {
        let (base, target) = (0.0, f64::NEG_INFINITY);
        Self { z: vec![0.0; dimension], base, target }
    }

    /// ln of the importance weight of the whole way.
    pub(in crate::infer) fn log_weight(&self) -> f64 {
        if self.target == f64::NEG_INFINITY {
            f64::NEG_INFINITY
        } else {
            self.target - self.base
        }
    }

    /// ln of the posterior's density, up to its constant.
    pub(in crate::infer) fn log_target(&self) -> f64 {
        self.target
    }

    pub(in crate::infer) fn tempered(&self, t: f64) -> f64 {
        if self.target == f64::NEG_INFINITY {
            return self.target;
        }
        (1.0 - t) * self.base + t * self.target
    }
}

/// Draws a population from a base, in parallel.
pub(in crate::infer) fn population(
    posterior: &Posterior<'_>,
    base: &Base,
    count: usize,
    seed: Seed,
) -> Result<Vec<Particle>> {
    parallel::try_map(0..count as u64, |i| {
        base.draw(posterior, &mut seed.child(i).rng())
    })
}
