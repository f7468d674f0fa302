//! Evidence by a mixture of normal approximations (Laplace's) about all modes,
//! corrected by importance sampling.
//!
//! Where a posterior is a few peaks of nearly normal shape, as that of a
//! mechanism whose place is unknown, climbing from many starts finds them for
//! a hundredth of what a population led from the prior costs. Five steps:
//! *search* for modes (`search.rs`) and held places (`places.rs`), *adapt* the
//! mixture of their normal approximations (`adapt.rs`), *check* it where draws
//! that are moved on arrive (`check.rs`), freeze it, and *estimate* from fresh
//! draws (`estimate.rs`). What does not learn is *tempered* (`temper.rs`).

use crate::error::{Error, Result};
use crate::infer::adapt::Frozen;
use crate::infer::estimate::{Estimate, Precision, estimated};
use crate::infer::proposal::{Component, Mixture};
use crate::infer::schedule::Schedule;
use crate::infer::search::{Peaks, SearchSpace, components, outlook};
use crate::infer::temper::tempered;
use crate::infer::{Backend, Effort, Inference, Progress};
use crate::model::Posterior;
use crate::seed::Seed;

/// Importance sampling from a mixture of the normal approximations of all
/// modes.
#[derive(Debug, Clone, PartialEq)]
pub struct LaplaceMixture {
    /// Where modes are looked for.
    pub space: SearchSpace,
    pub(crate) schedule: Schedule,
}

impl Default for LaplaceMixture {
    fn default() -> Self {
        let space = SearchSpace { prior_starts: 24, ..SearchSpace::default() };
        Self { space, schedule: Schedule::default() }
    }
}

impl Backend for LaplaceMixture {
    fn name(&self) -> &'static str {
        "laplace-mixture"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        self.explored(posterior, Precision::Sharp, seed, progress)
    }
}

/// The effective share that makes a proposal good where nothing is known of the
/// posterior: a funnel's neck is missed by one that does for a mechanism's.
const GENERAL: f64 = 0.1;

impl LaplaceMixture {
    /// With a search space of one's own.
    pub fn within(space: SearchSpace) -> Self {
        Self { space, ..Self::default() }
    }

    /// As many draws as fit an effort, for the estimate and for learning.
    pub fn of_effort(effort: &Effort) -> Self {
        let draws = (effort.chains * effort.draws / 2).max(1000);
        let schedule = Schedule {
            learning_draws: (draws / 10).clamp(600, 4000),
            judging_draws: (draws / 5).clamp(2000, 8000),
            moved: (draws / 5).clamp(400, 2000),
            good_share: GENERAL,
            rounds: 12,
            mended_until: 10,
            final_draws: (draws, draws),
            ..Schedule::default()
        };
        Self { schedule, ..Self::default() }
    }

    /// The same with a quick search.
    pub(crate) fn quick(&self) -> Self {
        Self { space: self.space.clone(), schedule: Schedule::quick() }
    }

    /// Searches: a proposal that has learned nothing yet.
    ///
    /// # Errors
    /// An improper prior, or a model that fails.
    pub(crate) fn searched(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
    ) -> Result<Frozen> {
        posterior.require_proper("the Laplace mixture")?;
        let Self { space, schedule } = self;
        let components = components(posterior, space, schedule, seed)?;
        Ok(Frozen::new(mixture(&components)?))
    }

    /// Searches, and learns until it is good, or for as long as the schedule
    /// says.
    ///
    /// # Errors
    /// As [`LaplaceMixture::searched`].
    pub(crate) fn frozen(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
    ) -> Result<Frozen> {
        let found = self.searched(posterior, seed.child(0))?;
        let Self { schedule, .. } = self;
        found.learned(posterior, schedule, schedule.rounds, seed.child(1))
    }

    /// Evidence and draws, as sharp as asked.
    ///
    /// # Errors
    /// As [`Backend::explore`].
    pub(crate) fn explored(
        &self,
        posterior: &Posterior<'_>,
        precision: Precision,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        let frozen = self.frozen(posterior, seed.child(0))?;
        let seed = seed.child(1);
        self.estimate(posterior, &frozen, precision, seed, progress)
    }

    /// The evidence from a frozen proposal.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn estimate(
        &self,
        posterior: &Posterior<'_>,
        frozen: &Frozen,
        precision: Precision,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        progress.begin("importance sampling", None);
        let schedule = &self.schedule;
        let mut frozen = frozen.clone();
        let sharp = precision == Precision::Sharp;
        for time in 0..schedule.estimates {
            let seed = seed.child(time);
            if sharp && !frozen.good {
                break;
            }
            let estimate = estimated(
                posterior,
                &frozen,
                schedule,
                precision,
                seed.child(0),
            )?;
            if estimate.suits(precision) {
                let seed = seed.child(3);
                return match sharp {
                    true => {
                        lightened(posterior, frozen, estimate, schedule, seed)
                    }
                    false => Ok(estimate.made),
                };
            }
            frozen.good = false;
            frozen = frozen
                .moved_on(posterior, &estimate.found, schedule, seed.child(1))?
                .learned(
                    posterior,
                    schedule,
                    schedule.rounds,
                    seed.child(2),
                )?;
        }
        tempered(posterior, &frozen, schedule, seed.child(100), progress)
    }

    /// About the log evidence, from the normal approximations of the peaks
    /// alone, and the highest of these.
    ///
    /// # Errors
    /// What no other parameter values would mend.
    pub(crate) fn outlook(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
    ) -> Result<Peaks> {
        outlook(posterior, &self.space, &self.schedule, seed)
    }
}

/// A sharp estimate; where its weights are to be warned of, that from fresh
/// draws of a proposal that is mended by them.
fn lightened(
    posterior: &Posterior<'_>,
    mut frozen: Frozen,
    mut estimate: Estimate,
    schedule: &Schedule,
    seed: Seed,
) -> Result<Inference> {
    for time in 0..schedule.mendings {
        if estimate.made.warnings.is_empty() {
            break;
        }
        let (sharp, seed) = (Precision::Sharp, seed.child(time));
        frozen = frozen.mended(&estimate.found, seed.child(0));
        let seed = seed.child(1);
        estimate = estimated(posterior, &frozen, schedule, sharp, seed)?;
    }
    Ok(estimate.made)
}

/// The mixture of components, each weighing about what it holds: the square
/// root keeps those in whose approximation is poor.
pub(in crate::infer) fn mixture(components: &[Component]) -> Result<Mixture> {
    let best = components.first().map_or(0.0, |component| component.log);
    let weighted = components.iter().map(|one| {
        let weight = (0.5 * (one.log - best)).exp();
        (weight, one.mean.clone(), one.covariance.clone())
    });
    Mixture::of(weighted).ok_or_else(|| {
        Error::inference(
            "no start leads to a peak: prior and recording contradict each \
             other",
        )
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use statrs::distribution::{Continuous, Normal as StatrsNormal};
    use statrs::function::erf::erf;

    use super::*;
    use crate::error::{Outcome, Stop};
    use crate::infer::{Evidence, Quiet, Smc};
    use crate::model::{Label, Number, Program, Run};
    use crate::prior::{AnyPrior, Normal};
    use crate::scalar::Real;

    /// b ~ N(0, 1) is asked for only where a ~ N(0, 1) is near 0.
    struct CutShort;

    const NEAR: f64 = 0.05;

    impl Program for CutShort {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let normal = AnyPrior::Normal(0.0, 1.0);
            let a = run.scalar(Label::new("a", "1"), normal)?;
            if a.value().abs() > NEAR {
                return Err(Stop::Reject("a is not near 0"));
            }
            run.scalar(Label::new("b", "1"), normal)?;
            Ok(())
        }
    }

    #[test]
    fn draws_that_are_cut_short_count_as_nothing() {
        // One draw in 25 is whole: of eight mostly none.
        let posterior = Posterior::new(&CutShort).unwrap();
        let mixture = LaplaceMixture::default();
        let smc = Smc { particles: 4000, ..Smc::default() };
        let known = erf(NEAR / 2.0_f64.sqrt()).ln();
        for backend in [&mixture as &dyn Backend, &smc] {
            let found = backend.explore(&posterior, Seed::new(1), &Quiet);
            let Evidence { log, se, .. } = found.unwrap().evidence.unwrap();
            // Four standard errors of the estimate.
            let name = backend.name();
            assert!((log - known).abs() < 4.0 * se, "{name}: {log} +- {se}");
        }
    }

    /// 0 was seen of N(x_i, 0.25), six times, with wide priors.
    struct Six;

    const WIDE: f64 = 300.0;
    const SD: f64 = 0.25;

    impl Program for Six {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            for i in 0..6 {
                let prior = AnyPrior::Normal(0.0, WIDE);
                let x = run.scalar(Label::new("x", "1").at(i), prior)?;
                run.observe_each(&0.0, Normal::new(x, Real::new(SD)))?;
            }
            Ok(())
        }
    }

    /// A share of the variance with which some 40 of 2000 draws are effective.
    const NARROW: f64 = 0.06;

    /// About the peak of these, with a share of their variances.
    fn narrow(share: f64) -> Frozen {
        let covariance = DMatrix::from_diagonal_element(6, 6, share * SD * SD);
        let part = (1.0, DVector::zeros(6), covariance);
        let mixture = Mixture::of([part].into_iter()).unwrap();
        Frozen { good: true, excess: 4.0, ..Frozen::new(mixture) }
    }

    #[test]
    fn a_proposal_whose_weights_are_to_be_warned_of_is_mended() {
        let posterior = Posterior::new(&Six).unwrap();
        let (sharp, schedule) = (Precision::Sharp, Schedule::default());
        let (frozen, seed) = (narrow(NARROW), Seed::new(7));
        let first =
            estimated(&posterior, &frozen, &schedule, sharp, seed).unwrap();
        assert!(!first.made.warnings.is_empty(), "its weights are good");
        let found =
            lightened(&posterior, frozen, first, &schedule, seed).unwrap();
        assert_eq!(found.warnings, Vec::<String>::new());
        let seen = StatrsNormal::new(0.0, WIDE.hypot(SD)).unwrap();
        let Evidence { log, se, .. } = found.evidence.unwrap();
        let off = log - 6.0 * seen.ln_pdf(0.0);
        assert!(off.abs() < 4.0 * se, "{off} +- {se}");
        assert!(se < 0.1, "{se}");
    }
}
