//! Evidence by a mixture of normal approximations (Laplace's) about all modes,
//! corrected by importance sampling.
//!
//! Where a posterior is a few peaks of nearly normal shape, as that of a
//! mechanism whose place is unknown, climbing from many starts finds them for
//! a hundredth of what a population led from the prior costs. Five steps, each
//! in a file of its own: *search* for modes and held places
//! (`search.rs`), *adapt* the mixture of their normal approximations
//! (`adapt.rs`), *check* it where draws that are moved on arrive (`check.rs`),
//! freeze it, and *estimate* from fresh draws (`estimate.rs`). What does not
//! learn is *tempered* (`temper.rs`).

use crate::error::{Error, Result};
use crate::infer::adapt::{Frozen, adapted, judged, taught};
use crate::infer::estimate::{Estimate, Precision, estimated};
use crate::infer::proposal::{Component, Mixture};
use crate::infer::schedule::Schedule;
use crate::infer::search::{SearchSpace, components, outlook};
use crate::infer::temper::tempered;
use crate::infer::{Backend, Inference, Progress};
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
        let frozen = self.freeze(posterior, seed.child(0))?;
        let seed = seed.child(1);
        self.estimate(posterior, &frozen, Precision::Sharp, seed, progress)
    }
}

impl LaplaceMixture {
    /// With a search space of one's own.
    pub fn within(space: SearchSpace) -> Self {
        Self { space, ..Self::default() }
    }

    /// Searches and learns: a proposal that learns no more.
    ///
    /// # Errors
    /// An improper prior, or a model that fails.
    pub(crate) fn freeze(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
    ) -> Result<Frozen> {
        posterior.require_proper("the Laplace mixture")?;
        let Self { space, schedule } = self;
        let components =
            components(posterior, space, schedule, seed.child(0))?;
        adapted(posterior, mixture(&components)?, schedule, seed.child(1))
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
        for time in 0..schedule.estimates {
            let seed = seed.child(time);
            if precision == Precision::Sharp {
                frozen = judged(posterior, frozen, schedule, seed.child(0))?;
                if !frozen.good {
                    break;
                }
            }
            let seed_of = |i: u64| seed.child(1).child(i);
            let Estimate { made, found, does } = estimated(
                posterior,
                &frozen,
                schedule,
                precision,
                seed_of(0),
            )?;
            if does || precision == Precision::Rough {
                return Ok(made);
            }
            let late = schedule.reweighting_rounds + 1;
            let mixture = &frozen.mixture;
            frozen.mixture =
                taught(mixture, &found, late, schedule, seed_of(1));
        }
        tempered(posterior, &frozen, schedule, seed.child(100), progress)
    }

    /// About the log evidence, from the normal approximations of the peaks
    /// alone.
    ///
    /// # Errors
    /// What no other parameter values would mend.
    pub(crate) fn outlook(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
    ) -> Result<f64> {
        outlook(posterior, &self.space, &self.schedule, seed)
    }
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
    use statrs::function::erf::erf;

    use super::*;
    use crate::error::{Outcome, Stop};
    use crate::infer::Quiet;
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

    /// 1 was seen of N(x^2, 0.45): two hills, at 1 and -1, with a saddle of a
    /// twelfth between them. 0 was seen of N(y_i, 0.25): with so many
    /// coordinates the tails of a component on one hill hardly reach the other.
    struct Hills;

    impl Program for Hills {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let wide = AnyPrior::Normal(0.0, 300.0);
            let x = run.scalar(Label::new("x", "1"), wide)?;
            run.observe_each(&1.0, Normal::new(x * x, Real::new(0.45)))?;
            for i in 0..5 {
                let y = run.scalar(Label::new("y", "1").at(i), wide)?;
                run.observe_each(&0.0, Normal::new(y, Real::new(0.25)))?;
            }
            Ok(())
        }
    }

    #[test]
    fn draws_that_are_moved_on_tell_of_a_hill_that_is_missed() {
        let posterior = Posterior::new(&Hills).unwrap();
        let on = |hills: &[f64]| {
            let part = |x: &f64| {
                let mut at = DVector::zeros(6);
                at[0] = *x;
                (1.0, at, DMatrix::from_diagonal_element(6, 6, 0.06))
            };
            Mixture::of(hills.iter().map(part)).unwrap()
        };
        let drawn = |mixture: &Mixture| {
            let base = Base::Mixture(mixture.clone());
            population(&posterior, &base, 2000, Seed::new(1)).unwrap()
        };
        let wider = |mixture: &Mixture, found: &[Particle]| {
            beyond(&posterior, mixture, found, Seed::new(2)).unwrap()
        };
        let both = on(&[1.0, -1.0]);
        let all = drawn(&both);
        assert!(wider(&both, &all).is_none());
        let one = on(&[1.0]);
        let half = drawn(&one);
        let missed = log_mean_weight(&all) - log_mean_weight(&half);
        // Half is missed, and by the draws a fifth are effective.
        assert!((missed - 2f64.ln()).abs() < 0.1, "{missed}");
        let logs: Vec<f64> = half.iter().map(Particle::log_weight).collect();
        assert!(share(&logs) > ENOUGH, "{}", share(&logs));
        let mended = wider(&one, &half).expect("a hill is missed");
        let found = log_mean_weight(&drawn(&mended));
        // Four standard errors of two means of 2000 draws of which a tenth
        // are effective; to miss half costs 0.7.
        let off = found - log_mean_weight(&all);
        assert!(off.abs() < 4.0 * 2f64.sqrt() * 0.067, "{off}");
    }

    #[test]
    fn draws_that_are_cut_short_count_as_nothing() {
        // One draw in 25 is whole: of eight mostly none.
        let posterior = Posterior::new(&CutShort).unwrap();
        let peaks = LaplaceMixture { starts: 8, ..LaplaceMixture::default() };
        let smc = Smc { particles: 4000, ..Smc::default() };
        let known = erf(NEAR / 2.0_f64.sqrt()).ln();
        for backend in [&peaks as &dyn Backend, &smc] {
            let found = backend.explore(&posterior, Seed::new(1), &Quiet);
            let Evidence { log, se, .. } = found.unwrap().evidence.unwrap();
            // Four standard errors of the estimate.
            let name = backend.name();
            assert!((log - known).abs() < 4.0 * se, "{name}: {log} +- {se}");
        }
    }
}
