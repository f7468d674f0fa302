//! Evidence over a few coordinates, the others integrated at each draw of
//! these.
//!
//! Where a posterior is nearly normal in most of its coordinates once a few
//! others are known, a mixture in all of them does badly and one in the few
//! does well: each draw of these is weighed by an unbiased estimate of what
//! the others hold there, which leaves the evidence unbiased (Tran, Scharth,
//! Pitt, Kohn 2013).

use rayon::prelude::*;

use super::importance::{Sum, summed};
use super::mixture::Mixture;
use super::smc::{Particle, systematic};
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

/// How many draws a round makes, and how many rounds there are at the most.
const DRAWS: usize = 150;
const ROUNDS: u64 = 8;
/// A standard error of the log evidence that is small enough.
const ENOUGH: f64 = 0.12;

/// An integral over the few coordinates under way: importance sampling from a
/// mixture, round after round.
pub(crate) struct Integration {
    mixture: Mixture,
    found: Vec<Particle>,
    held: Vec<Held>,
    seed: Seed,
    round: u64,
}

impl Integration {
    /// With a mixture that says about where the few coordinates lie.
    pub(crate) fn new(mixture: Mixture, seed: Seed) -> Self {
        let (found, held) = (Vec::new(), Vec::new());
        Self { mixture, found, held, seed, round: 0 }
    }

    /// Another round of draws.
    pub(crate) fn go_on(&mut self, posterior: &dyn Conditional) -> Result<()> {
        let (mixture, seed) = (&self.mixture, self.seed.child(self.round));
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
        self.round += 1;
        Ok(())
    }

    /// As many rounds as the standard error asks for.
    pub(crate) fn finish(&mut self, posterior: &dyn Conditional) -> Result<()> {
        while self.round < ROUNDS && !self.is_sharp() {
            self.go_on(posterior)?;
        }
        Ok(())
    }

    fn is_sharp(&self) -> bool {
        summed(&self.found).is_ok_and(|sum| sum.se < ENOUGH)
    }

    /// ln of the evidence as known so far.
    pub(crate) fn log_evidence(&self) -> f64 {
        summed(&self.found).map_or(f64::NEG_INFINITY, |sum| sum.log)
    }

    /// What was found, with at least a hundred draws of the few coordinates.
    pub(crate) fn concluded(&self) -> Result<Integral> {
        let Sum { log, se, weights, effective, .. } = summed(&self.found)?;
        let count = effective.max(100.0) as usize;
        let mut rng = self.seed.child(ROUNDS).rng();
        let draw = |i: usize| {
            (self.found[i].z.clone(), self.held[i].rest.clone())
        };
        let chosen = systematic(&weights, count, &mut rng).into_iter();
        let draws = chosen.map(draw).collect();
        Ok(Integral { log_evidence: log, se, draws })
    }
}
