//! Inference: backends behind one trait.
//!
//! A backend runs a whole inference on a [`Posterior`] with a [`Seed`] and
//! says in its [`Inference`] what it found: draws, a mode, an evidence, and
//! what it cost. Every random number comes from the seed by a fixed path, so
//! a run is the same to the last bit on any number of threads.

mod adapt;
mod backends;
mod check;
mod climb;
mod convergence;
mod display;
mod estimate;
#[cfg(test)]
pub(crate) mod fixture;
mod groups;
mod inference;
mod kept;
pub(crate) mod nested;
mod places;
mod profile;
mod progress;
mod proposal;
mod remembered;
mod schedule;
mod search;
pub(crate) mod simplex;
mod start;
mod suited;
mod temper;
mod weights;

pub(crate) use adapt::Frozen;
pub use backends::*;
pub(crate) use climb::{Climb, Landscape, Slope};
pub use climb::{Peak, climb};
pub(crate) use convergence::convergence;
pub(crate) use estimate::Precision;
pub use groups::{Group, Grouped};
pub use inference::{Evidence, Inference, LEVELS, Marginal, Mode};
pub use kept::kept;
pub use places::{HeldGrid, HeldPlace};
pub use progress::{Progress, Quiet, part};
pub use proposal::Mixture;
pub(crate) use proposal::student_constant;
pub(crate) use remembered::Remembered;
pub(crate) use search::Peaks;
pub use search::SearchSpace;
pub use suited::{Suited, suited};
pub(crate) use weights::systematic;

use std::fmt::Debug;
use std::time::Instant;

use crate::draws::{Draws, log_sum_exp};
use crate::error::{Error, Result};
use crate::model::{Cost, Posterior};
use crate::seed::Seed;

/// A way to explore a posterior.
pub trait Backend: Debug + Sync {
    /// Its name, such as "mh".
    fn name(&self) -> &'static str;

    /// Runs the inference; [`infer`] adds the cost.
    ///
    /// # Errors
    /// A model that this backend cannot do, or that fails.
    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference>;
}

/// Runs a backend on a posterior and adds what it cost, whether chains have
/// converged, and what the model keeps at each draw.
///
/// # Errors
/// As [`Backend::explore`], and a model whose parameters are not the same at
/// all draws.
pub fn infer(
    backend: &dyn Backend,
    posterior: &Posterior<'_>,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Inference> {
    let begun = Instant::now();
    let before = posterior.cost();
    let mut inference = backend.explore(posterior, seed, progress)?;
    let after = posterior.cost();
    inference.cost = Cost {
        densities: after.densities - before.densities,
        gradients: after.gradients - before.gradients,
        simulations: after.simulations - before.simulations,
        rejections: after.rejections - before.rejections,
        seconds: begun.elapsed().as_secs_f64(),
    };
    if let Some(draws) = &inference.draws {
        inference.kept = kept(posterior, draws, seed.called("kept"))?;
    }
    convergence::check(posterior, &mut inference)?;
    Ok(inference)
}

/// What a backend gives beside what it cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Gives {
    /// Draws from the posterior.
    pub draws: bool,
    /// The evidence.
    pub evidence: bool,
}

const DRAWS: Gives = Gives { draws: true, evidence: false };
const BOTH: Gives = Gives { draws: true, evidence: true };
const EVIDENCE: Gives = Gives { draws: false, evidence: true };
const MODE: Gives = Gives { draws: false, evidence: false };

/// A backend as the command names it: the name, what it is, and its making.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Its name.
    pub name: &'static str,
    /// What it does, in one line.
    pub about: &'static str,
    /// Whether it gives draws, and whether it gives an evidence.
    pub gives: Gives,
    /// Makes it of a given effort.
    pub make: fn(&Effort) -> Box<dyn Backend>,
}

impl Debug for Entry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// How much work a backend is asked to do; what a backend has no use for, it
/// passes over.
///
/// ```
/// use couloir::infer::Effort;
/// let effort = Effort::new().chains(2).draws(1_000).warmup(500);
/// assert_eq!((effort.chains, effort.draws), (2, 1_000));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Effort {
    /// Independent chains.
    pub chains: usize,
    /// Draws kept of each chain.
    pub draws: usize,
    /// Steps before those, for tuning.
    pub warmup: usize,
}

impl Default for Effort {
    fn default() -> Self {
        Self::new()
    }
}

impl Effort {
    /// Four chains of 10 000 draws after 5000 steps.
    pub const fn new() -> Self {
        Self { chains: 4, draws: 10_000, warmup: 5_000 }
    }

    /// The same with another number of chains.
    #[must_use]
    pub const fn chains(self, chains: usize) -> Self {
        Self { chains, ..self }
    }

    /// The same with another number of draws kept of each chain.
    #[must_use]
    pub const fn draws(self, draws: usize) -> Self {
        Self { draws, ..self }
    }

    /// The same with another number of steps for tuning.
    #[must_use]
    pub const fn warmup(self, warmup: usize) -> Self {
        Self { warmup, ..self }
    }
}

/// Every backend that the command can name.
pub const BACKENDS: &[Entry] = &[
    Entry {
        name: "mh",
        about: "Metropolis-Hastings on the real line, adaptive",
        gives: DRAWS,
        make: |effort| Box::new(MetropolisHastings::adaptive(effort)),
    },
    Entry {
        name: "random-walk",
        about: "Metropolis-Hastings of the paper, tuned covariance",
        gives: DRAWS,
        make: |effort| Box::new(MetropolisHastings::random_walk(effort)),
    },
    #[cfg(feature = "nuts")]
    Entry {
        name: "nuts",
        about: "no-U-turn sampler on the real line, exact gradient",
        gives: DRAWS,
        make: |effort| Box::new(Nuts::of_effort(effort)),
    },
    Entry {
        name: "smc",
        about: "sequential Monte Carlo, tempered, with evidence",
        gives: BOTH,
        make: |effort| Box::new(Smc::of_effort(effort)),
    },
    Entry {
        name: "importance",
        about: "importance sampling by a Student-t mixture, with evidence",
        gives: BOTH,
        make: |effort| Box::new(ImportanceSampling::of_effort(effort)),
    },
    Entry {
        name: "laplace-mixture",
        about: "importance sampling by Laplace's approximations of all modes",
        gives: BOTH,
        make: |effort| Box::new(LaplaceMixture::of_effort(effort)),
    },
    Entry {
        name: "bridge",
        about: "bridge sampling on particles, with evidence",
        gives: BOTH,
        make: |effort| Box::new(Bridge::on_particles(effort)),
    },
    Entry {
        name: "reciprocal",
        about: "evidence from chains as in the paper's appendix B",
        gives: BOTH,
        make: |effort| Box::new(ReciprocalImportance::of_effort(effort)),
    },
    Entry {
        name: "quadrature",
        about: "exact evidence and marginals, up to four parameters",
        gives: EVIDENCE,
        make: |_| Box::new(Quadrature::default()),
    },
    Entry {
        name: "map",
        about: "posterior mode by L-BFGS and Nelder-Mead",
        gives: MODE,
        make: |_| Box::new(Map::default()),
    },
];

/// The backend of that name.
///
/// # Errors
/// A name that there is not; the message lists them.
pub fn backend(name: &str, effort: &Effort) -> Result<Box<dyn Backend>> {
    match BACKENDS.iter().find(|entry| entry.name == name) {
        Some(entry) => Ok((entry.make)(effort)),
        None if name == "nuts" => Err(Error::input(
            "backend \"nuts\" is not built in; build couloir with \
             --features nuts, or take another backend",
        )),
        None => {
            let names: Vec<_> = BACKENDS.iter().map(|e| e.name).collect();
            Err(Error::input(format!(
                "backend {name:?} is not known; expected one of {}",
                names.join(", ")
            )))
        }
    }
}

/// Empty draws with the posterior's names and units.
pub(crate) fn draws_of(posterior: &Posterior<'_>) -> Result<Draws> {
    let parameters = posterior.parameters();
    Draws::new(
        parameters.iter().map(|p| p.name.clone()).collect(),
        parameters.iter().map(|p| p.unit.clone()).collect(),
    )
}
