//! Evidence over a few coordinates, the others integrated at each draw of
//! these.
//!
//! Where a posterior is nearly normal in most of its coordinates once a few
//! others are known, a mixture in all of them does badly and one in the few
//! does well: each draw of these is weighed by an unbiased estimate of what
//! the others hold there, which leaves the evidence unbiased (Tran, Scharth,
//! Pitt, Kohn 2013).

use rayon::prelude::*;

use super::proposal::Mixture;
use super::proposal::Particle;
use super::weights::summed;
use crate::error::Result;
use crate::seed::Seed;

/// A posterior of which a few coordinates are drawn.
pub(crate) trait Conditional: Sync {
    /// What the others hold at given ones.
    fn held(&self, z: &[f64], seed: Seed) -> Result<Held>;
}

/// What the other coordinates hold at given ones.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    /// ln of an unbiased estimate of p(given, data).
    pub(crate) log: f64,
    /// Draws of the others; none where nothing is held.
    pub(crate) rest: Vec<Vec<f64>>,
}

impl Held {
    /// What a place holds that has no density.
    pub(crate) fn nothing() -> Self {
        Self { log: f64::NEG_INFINITY, rest: Vec::new() }
    }
}

/// An evidence, with draws.
#[derive(Debug)]
pub(crate) struct Integral {
    pub(crate) log_evidence: f64,
    pub(crate) se: f64,
    /// Given coordinates, each with draws of the others.
    pub(crate) draws: Vec<(Vec<f64>, Vec<Vec<f64>>)>,
}

/// How many draws a round makes.
const DRAWS: usize = 150;

/// An integral over the few coordinates under way: importance sampling from a
/// mixture, round after round.
pub(crate) struct Integration {
    mixture: Mixture,
    found: Vec<Particle>,
    held: Vec<Held>,
    seed: Seed,
}

impl Integration {
    /// With a mixture that says about where the few coordinates lie.
    pub(crate) fn new(mixture: Mixture, seed: Seed) -> Self {
        let (found, held) = (Vec::new(), Vec::new());
        Self { mixture, found, held, seed }
    }

    /// Another round of draws.
    pub(crate) fn go_on(&mut self, posterior: &dyn Conditional) -> Result<()> {
        let round = self.rounds() as u64;
        let (mixture, seed) = (&self.mixture, self.seed.child(1 + round));
        let draw = |i: usize| {
            let seed = seed.child(i as u64);
            let z = mixture.draw(&mut seed.child(0).rng());
            let held = posterior.held(&z, seed.child(1))?;
            let base = mixture.log_density(&z);
            Ok((Particle::new(z, base, held.log), held))
        };
        let more: Result<Vec<(Particle, Held)>> =
            (0..DRAWS).into_par_iter().map(draw).collect();
        for (particle, held) in more? {
            self.found.push(particle);
            self.held.push(held);
        }
        Ok(())
    }

    /// How many rounds were made.
    pub(crate) fn rounds(&self) -> usize {
        self.found.len() / DRAWS
    }

    /// ln of the evidence as known so far, and its standard error.
    pub(crate) fn known(&self) -> (f64, f64) {
        let sum = summed(&self.found);
        sum.map_or((f64::NEG_INFINITY, 0.0), |sum| (sum.log, sum.se))
    }

    /// What was found, with at least a hundred draws of the few coordinates.
    pub(crate) fn concluded(&self) -> Result<Integral> {
        let sum = summed(&self.found)?;
        let draw =
            |i: usize| (self.found[i].z.clone(), self.held[i].rest.clone());
        let draws = sum.chosen(self.seed.child(0)).into_iter().map(draw);
        let draws = draws.collect();
        Ok(Integral { log_evidence: sum.log, se: sum.se, draws })
    }
}
