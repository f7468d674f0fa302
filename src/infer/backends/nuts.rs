//! The no-U-turn sampler, by nuts-rs.
//!
//! Each draw follows the slope of the log density along a path that ends
//! where it would turn back (Hoffman, Gelman 2014), and a place on it is
//! drawn by its density (Betancourt 2017). Steps are measured by a metric
//! learnt from draws and gradients during warm-up (Seyboldt, Carlson,
//! Carpenter 2026): scales, and the few directions in which parameters hang
//! together. A step too long for a sharp bend is halved, and the path ends
//! where it could not be followed back (WALNUTS: Bou-Rabee, Carpenter,
//! Kleppe, Liu 2025); without this, narrow places were seen to be missed.
//! It runs on the real line with the exact gradient. Where the density is
//! zero a path ends too, which counts as a divergence.

use std::cell::Cell;
use std::collections::HashMap;
use std::fmt;

use nuts_rs::{
    Chain, CpuLogpFunc, CpuMath, CpuMathError, HasDims, LogpError,
    LowRankNutsSettings, NutsError, Settings, WalnutsOptions,
};

use super::mh::to_natural;
use crate::error::{Error, Result};
use crate::infer::start::{apart, best_start};
use crate::infer::{Backend, Effort, Inference, Progress, draws_of};
use crate::model::{Posterior, Weights};
use crate::parallel;
use crate::seed::{Rng, Seed};

/// Several independent chains of the no-U-turn sampler.
///
/// ```
/// use couloir::infer::{Effort, Nuts};
/// let effort = Effort::new().chains(4).draws(1000).warmup(1000);
/// let careful = Nuts { target: 0.98, ..Nuts::of_effort(&effort) };
/// assert_eq!(careful.max_depth, 10);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Nuts {
    /// How many chains.
    pub chains: usize,
    /// Draws kept of each.
    pub draws: usize,
    /// Draws before those, in which step and metric are learnt.
    pub warmup: usize,
    /// The mean acceptance along a path that the step length is tuned to;
    /// nearer to 1 the steps are shorter.
    pub target: f64,
    /// A path has at most two to this power steps.
    pub max_depth: u64,
    /// How often a step is halved at the most where it is too long; with 0
    /// it is the sampler without WALNUTS.
    pub halvings: u64,
}

impl Default for Nuts {
    /// Four chains of 1000 draws, which are worth many more of a walk's.
    fn default() -> Self {
        Self::of_effort(&Effort { chains: 4, draws: 1000, warmup: 1000 })
    }
}

impl Nuts {
    /// As many chains and draws as an effort says.
    pub fn of_effort(effort: &Effort) -> Self {
        Self {
            chains: effort.chains,
            draws: effort.draws,
            warmup: effort.warmup,
            target: 0.9,
            max_depth: 10,
            halvings: 8,
        }
    }

    fn settings(&self) -> LowRankNutsSettings {
        let walnuts = WalnutsOptions {
            max_step_halvings: self.halvings,
            ..WalnutsOptions::default()
        };
        let mut settings = LowRankNutsSettings {
            walnuts: (self.halvings > 0).then_some(walnuts),
            num_tune: self.warmup as u64,
            num_draws: self.draws as u64,
            maxdepth: self.max_depth,
            ..LowRankNutsSettings::default()
        };
        settings.adapt_options.step_size_settings.target_accept = self.target;
        settings
    }

    fn check(&self) -> Result<()> {
        if self.chains == 0 || self.draws == 0 {
            return Err(Error::input(
                "nuts needs at least one chain and one draw",
            ));
        }
        if !(self.target > 0.0 && self.target < 1.0) {
            return Err(Error::input(format!(
                "nuts cannot aim at an acceptance of {}: it lies between 0 \
                 and 1, 0.9 as a rule",
                self.target
            )));
        }
        Ok(())
    }

    /// One chain: its draws as named, and how it went.
    fn chain(
        &self,
        posterior: &Posterior<'_>,
        from: Vec<f64>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<(Vec<f64>, Course)> {
        let mut rng = seed.rng();
        let zeros = Cell::new(0);
        let slope = Slope { posterior, zeros: &zeros };
        let mut path = self
            .settings()
            .new_chain(0, CpuMath::new(slope), &mut rng)
            .map_err(|e| Error::inference(format!("nuts: {e}")))?;
        start(posterior, from, &mut rng, |z| {
            path.set_position(z).map_err(|e| reason(e.downcast_ref(), &e))
        })?;
        let mut course = Course::default();
        let mut rows = Vec::new();
        for step in 0..self.warmup + self.draws {
            zeros.set(0);
            let (z, _, stats, said) = path
                .expanded_draw()
                .map_err(|e| reason(e.downcast_ref(), &e).error())?;
            if step >= self.warmup {
                rows.extend_from_slice(&z);
                course.add(&Draw {
                    acceptance: stats.adapt.step_size.mean_tree_accept,
                    diverged: said.diverging,
                    at_edge: said.diverging && zeros.get() > 0,
                    cut_short: stats.maxdepth_reached,
                });
            }
            if step % TELL_EVERY == TELL_EVERY - 1 {
                progress.advance(TELL_EVERY as u64);
            }
        }
        to_natural(posterior, &mut rows, posterior.dimension())?;
        Ok((rows, course))
    }

    fn warn(&self, courses: &[Course]) -> Vec<String> {
        let sum = |count: fn(&Course) -> usize| -> usize {
            courses.iter().map(count).sum()
        };
        let (draws, diverged) = (sum(|c| c.draws), sum(|c| c.diverged));
        let mut warnings = Vec::new();
        if diverged > 0 {
            warnings.push(format!(
                "{diverged} of {draws} paths diverged, {} of them where the \
                 density is zero: what lies behind may be missing from the \
                 draws; raise the target acceptance, or compare with smc",
                sum(|c| c.at_edge)
            ));
        }
        warnings
    }

    /// What would have made a better run.
    fn hints(&self, courses: &[Course]) -> Vec<String> {
        let sum = |count: fn(&Course) -> usize| -> usize {
            courses.iter().map(count).sum()
        };
        let (draws, short) = (sum(|c| c.draws), sum(|c| c.cut_short));
        let mut hints = Vec::new();
        if short > 0 {
            hints.push(format!(
                "{short} of {draws} paths were cut at depth {}: the draws are \
                 more alike than they need be; give it a longer warm-up",
                self.max_depth
            ));
        }
        hints.extend(self.untuned(courses));
        hints
    }

    /// A hint for each chain far from the acceptance aimed at.
    fn untuned(&self, courses: &[Course]) -> Vec<String> {
        let mut hints = Vec::new();
        for (index, course) in courses.iter().enumerate() {
            let acceptance = course.mean_acceptance();
            if acceptance < self.target - FAR {
                hints.push(format!(
                    "chain {} accepted {:.0} % along its paths, {:.0} % were \
                     aimed at: give it a longer warm-up",
                    index + 1,
                    100.0 * acceptance,
                    100.0 * self.target
                ));
            }
        }
        hints
    }
}

/// Progress is told every so many draws.
const TELL_EVERY: usize = 64;

/// An acceptance so far below the target was not tuned.
const FAR: f64 = 0.2;

/// How often another start is tried where one has no slope to follow.
const TRIES: usize = 20;

/// Puts a chain at its start, or where that has no slope at another, the best
/// of a few draws from the prior.
fn start(
    posterior: &Posterior<'_>,
    mut from: Vec<f64>,
    rng: &mut Rng,
    mut place: impl FnMut(&[f64]) -> Result<(), Refusal>,
) -> Result<()> {
    for _ in 0..TRIES {
        match place(&posterior.line(&from)?) {
            Err(Refusal::Zero) => from = best_start(posterior, rng)?,
            Err(Refusal::Failed(error)) => return Err(error),
            Ok(()) => return Ok(()),
        }
    }
    Err(Error::inference(format!(
        "nuts found no start in {TRIES} tries: the density has no finite \
         slope there, or none at all in some parameter; use mh or smc"
    )))
}

/// How a chain went after its warm-up.
#[derive(Debug, Default)]
struct Course {
    draws: usize,
    /// The sum of the mean acceptances along the paths.
    acceptance: f64,
    diverged: usize,
    /// Those that diverged at a place of density zero.
    at_edge: usize,
    cut_short: usize,
}

/// How one path went.
struct Draw {
    acceptance: f64,
    diverged: bool,
    at_edge: bool,
    cut_short: bool,
}

impl Course {
    fn add(&mut self, draw: &Draw) {
        self.draws += 1;
        self.acceptance += draw.acceptance;
        self.diverged += usize::from(draw.diverged);
        self.at_edge += usize::from(draw.at_edge);
        self.cut_short += usize::from(draw.cut_short);
    }

    fn mean_acceptance(&self) -> f64 {
        self.acceptance / self.draws.max(1) as f64
    }
}

/// Why a place has no slope.
#[derive(Debug)]
enum Refusal {
    /// The density is zero, or has no finite logarithm.
    Zero,
    /// What other places would not mend.
    Failed(Error),
}

impl Refusal {
    fn error(self) -> Error {
        match self {
            Self::Zero => Error::inference(
                "nuts went to a place of density zero and cannot go on",
            ),
            Self::Failed(error) => error,
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Zero => f.write_str("the density is zero"),
            Self::Failed(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Refusal {}

impl LogpError for Refusal {
    fn is_recoverable(&self) -> bool {
        matches!(self, Self::Zero)
    }
}

/// The refusal inside an error of nuts-rs; one of its own is told as it is.
fn reason(found: Option<&NutsError>, whole: &dyn fmt::Display) -> Refusal {
    match found {
        Some(NutsError::BadInitGrad(_)) => Refusal::Zero,
        Some(NutsError::LogpFailure(inner)) => match inner.downcast_ref() {
            Some(Refusal::Failed(error)) => Refusal::Failed(error.clone()),
            Some(Refusal::Zero) => Refusal::Zero,
            None => own(whole),
        },
        _ => own(whole),
    }
}

fn own(whole: &dyn fmt::Display) -> Refusal {
    Refusal::Failed(Error::inference(format!("nuts: {whole}")))
}

/// The log density on the line with its gradient, as nuts-rs asks for it.
struct Slope<'a, 'm> {
    posterior: &'a Posterior<'m>,
    /// How many places of density zero this draw met.
    zeros: &'a Cell<u64>,
}

impl HasDims for Slope<'_, '_> {
    fn dim_sizes(&self) -> HashMap<String, u64> {
        let n = self.posterior.dimension() as u64;
        ["unconstrained_parameter", "dim"]
            .map(|name| (name.to_owned(), n))
            .into()
    }
}

impl CpuLogpFunc for Slope<'_, '_> {
    type LogpError = Refusal;
    type FlowParameters = ();
    type ExpandedVector = Vec<f64>;

    fn dim(&self) -> usize {
        self.posterior.dimension()
    }

    fn logp(&mut self, z: &[f64], slope: &mut [f64]) -> Result<f64, Refusal> {
        let density = self
            .posterior
            .gradient(z, Weights::LINE, slope)
            .map_err(Refusal::Failed)?;
        let height = density.on_line();
        if density.rejected.is_some() || !height.is_finite() {
            self.zeros.set(self.zeros.get() + 1);
            return Err(Refusal::Zero);
        }
        Ok(height)
    }

    fn expand_vector<R: nuts_rs::rand::Rng + ?Sized>(
        &mut self,
        _: &mut R,
        z: &[f64],
    ) -> Result<Vec<f64>, CpuMathError> {
        Ok(z.to_vec())
    }
}

impl Backend for Nuts {
    fn name(&self) -> &'static str {
        "nuts"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        self.check()?;
        let steps = self.chains * (self.warmup + self.draws);
        progress.begin("sampling", Some(steps as u64));
        // A path of its own, beside those of the chains.
        let beside = seed.child(self.chains as u64);
        let starts = apart(posterior, self.chains, beside)?;
        let chains = parallel::try_map((0..).zip(starts), |(i, from)| {
            self.chain(posterior, from, seed.child(i), progress)
        })?;
        let mut draws = draws_of(posterior)?;
        let mut courses = Vec::new();
        for (rows, course) in chains {
            draws.push_chain(rows, Some(course.mean_acceptance()))?;
            courses.push(course);
        }
        Ok(Inference {
            draws: Some(draws),
            warnings: self.warn(&courses),
            hints: self.hints(&courses),
            ..Inference::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::{Quiet, infer};
    use crate::model::{Label, Number, Program, Run};
    use crate::prior::Normal;
    use crate::{Outcome, Stop};

    /// A standard normal, with a wall beyond which there is nothing, and a
    /// place beyond which the model fails.
    struct Walled {
        wall: f64,
        failure: f64,
    }

    impl Program for Walled {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let label = Label::new("x", "1");
            let x = run.scalar(label, Normal::<K>::new(0.0, 1.0))?;
            if x.value() > self.failure {
                return Err(Stop::Fail(Error::system("the disk is full")));
            }
            if x.value() > self.wall {
                return Err(Stop::Reject("a wall"));
            }
            Ok(())
        }
    }

    fn found(wall: f64, failure: f64) -> Result<Inference> {
        let model = Walled { wall, failure };
        let posterior = Posterior::new(&model)?;
        let nuts = Nuts { draws: 4000, ..Nuts::default() };
        infer(&nuts, &posterior, Seed::new(1), &Quiet)
    }

    #[test]
    fn a_wall_is_a_divergence_and_is_warned_of() -> Result<()> {
        let found = found(0.0, f64::INFINITY)?;
        // Half a normal has mean -(2/pi)^(1/2); its error here is about 0.01.
        let draws = found.draws.ok_or(Error::inference("no draws"))?;
        let mean = draws.mean()[0];
        assert!((mean + (2.0 / std::f64::consts::PI).sqrt()).abs() < 0.05);
        assert!(found.cost.rejections > 0);
        assert!(found.warnings[0].contains("where the density is zero"));
        Ok(())
    }

    #[test]
    fn a_failure_ends_the_run_with_its_reason() {
        let error = found(f64::INFINITY, 1.0).expect_err("a failure");
        assert_eq!(error, Error::system("the disk is full"));
    }

    #[test]
    fn an_impossible_target_is_refused() {
        let nuts = Nuts { target: 1.0, ..Nuts::default() };
        assert!(nuts.check().expect_err("a refusal").is_input());
    }
}
