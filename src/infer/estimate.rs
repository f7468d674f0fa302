//! The evidence from fresh draws of a frozen proposal.
//!
//! Nothing that made the proposal is counted again: draws that chose it would
//! lean towards the places that they happened to meet, and towards too small
//! an error.

use super::adapt::Frozen;
use super::proposal::{Base, Particle, population};
use super::schedule::Schedule;
use super::weights::{quality, summed};
use super::{Evidence, Inference, draws_of};
use crate::error::Result;
use crate::model::Posterior;
use crate::parallel;
use crate::seed::Seed;

/// How sharp an estimate has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    /// As the schedule asks.
    Sharp,
    /// As sharp as a moderate number of draws makes it, of what has a share in
    /// an answer but does not decide it.
    Fair,
    /// A few draws, of what is so far below the best that no answer depends
    /// on it.
    Rough,
}

/// Draws of a rough estimate, and the most of a fair one.
const ROUGH: usize = 300;
const FAIR: usize = 3000;
/// The largest standard error of ln evidence that a fair estimate may have.
const FAIR_ERROR: f64 = 0.3;

/// How many draws make an estimate as sharp as asked: the relative variance of
/// a mean of n weights is their own over n.
fn count(frozen: &Frozen, schedule: &Schedule, precision: Precision) -> usize {
    let (fewest, most) = schedule.final_draws;
    match precision {
        Precision::Rough => ROUGH,
        Precision::Fair => needed(frozen, schedule).clamp(fewest, FAIR),
        Precision::Sharp => needed(frozen, schedule).clamp(fewest, most),
    }
}

fn needed(frozen: &Frozen, schedule: &Schedule) -> usize {
    (frozen.excess / schedule.error.powi(2)) as usize
}

impl Estimate {
    /// Whether it is as good as asked for.
    pub(super) fn suits(&self, precision: Precision) -> bool {
        let se = self.made.evidence.as_ref().map_or(f64::NAN, |e| e.se);
        match precision {
            Precision::Rough => true,
            Precision::Fair => self.does || se < FAIR_ERROR,
            Precision::Sharp => self.does,
        }
    }
}

/// Evidence and draws from fresh draws of a frozen proposal.
///
/// # Errors
/// No draw with a positive density, or a model that fails.
pub(super) fn estimated(
    posterior: &Posterior<'_>,
    frozen: &Frozen,
    schedule: &Schedule,
    precision: Precision,
    seed: Seed,
) -> Result<Estimate> {
    let count = count(frozen, schedule, precision);
    let base = Base::Mixture(frozen.mixture.clone());
    let found = population(posterior, &base, count, seed.child(0))?;
    let does = schedule.does(quality(&found));
    let mut made = concluded(posterior, &found, seed.child(1))?;
    if let Some(evidence) = &mut made.evidence
        && frozen.excess.is_finite()
    {
        // Draws that were moved on may know of weights that these do not.
        let seen = (frozen.excess / count as f64).sqrt();
        evidence.se = evidence.se.max(seen.min(1.0));
    }
    Ok(Estimate { made, found, does })
}

/// What fresh draws say.
pub(super) struct Estimate {
    pub(super) made: Inference,
    pub(super) found: Vec<Particle>,
    /// Whether their weights are as good as the proposal was judged to be.
    pub(super) does: bool,
}

/// Evidence and draws from weighted particles.
///
/// # Errors
/// As [`estimated`].
pub(super) fn concluded(
    posterior: &Posterior<'_>,
    found: &[Particle],
    seed: Seed,
) -> Result<Inference> {
    let sum = summed(found)?;
    let rows = parallel::try_map(sum.chosen(seed), |i| {
        posterior.natural(&found[i].z)
    })?;
    let mut draws = draws_of(posterior)?;
    draws.push_chain(rows.concat(), None)?;
    Ok(Inference {
        draws: Some(draws),
        evidence: Some(Evidence {
            log: sum.log,
            se: sum.se,
            method: "importance sampling by a Student-t mixture".into(),
        }),
        warnings: sum.warnings,
        ..Inference::default()
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use statrs::distribution::{Continuous, Normal as StatrsNormal};

    use super::*;
    use crate::error::Outcome;
    use crate::infer::proposal::Mixture;
    use crate::model::{Label, Number, Program, Run};
    use crate::prior::{AnyPrior, Normal};
    use crate::scalar::Real;

    /// 0.5 was seen of N(x, 1), x ~ N(0, 1): x is N(0.25, 1/2) of it.
    struct Seen;

    impl Program for Seen {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let prior = AnyPrior::Normal(0.0, 1.0);
            let x = run.scalar(Label::new("x", "1"), prior)?;
            run.observe_each(&0.5, Normal::new(x, Real::new(1.0)))
        }
    }

    /// A proposal that fits, and what is said of its weights.
    fn frozen(excess: f64) -> Frozen {
        let mean = DVector::from_element(1, 0.25);
        let part = (1.0, mean, DMatrix::from_element(1, 1, 0.5));
        let mixture = Mixture::of([part].into_iter()).unwrap();
        Frozen { mixture, log: 0.0, excess, good: true, round: 0 }
    }

    #[test]
    fn an_estimate_suits_what_is_asked_of_it() {
        let of = |se: f64, does: bool| {
            let (log, method) = (0.0, String::new());
            let evidence = Some(Evidence { log, se, method });
            let made = Inference { evidence, ..Inference::default() };
            let estimate = Estimate { made, found: Vec::new(), does };
            [Precision::Rough, Precision::Fair, Precision::Sharp]
                .map(|precision| estimate.suits(precision))
        };
        assert_eq!(of(5.0, true), [true; 3]);
        assert_eq!(of(0.2, false), [true, true, false]);
        assert_eq!(of(0.4, false), [true, false, false]);
        assert_eq!(of(f64::NAN, false), [true, false, false]);
    }

    #[test]
    fn as_many_draws_as_the_error_asks_for() {
        let final_draws = (1000, 6000);
        let schedule =
            Schedule { error: 0.05, final_draws, ..Schedule::default() };
        let of = |excess: f64, precision: Precision| {
            count(&frozen(excess), &schedule, precision)
        };
        // 4/n = 0.05^2, between 1000 and 6000.
        assert!(of(4.0, Precision::Sharp).abs_diff(1600) <= 1);
        assert_eq!(of(0.1, Precision::Sharp), 1000);
        assert_eq!(of(1e3, Precision::Sharp), 6000);
        assert_eq!(of(4.0, Precision::Rough), 300);
    }

    #[test]
    fn the_evidence_is_the_known_one_with_no_less_than_the_error_seen() {
        let posterior = Posterior::new(&Seen).unwrap();
        let final_draws = (1000, 6000);
        let schedule = Schedule { final_draws, ..Schedule::default() };
        let known = StatrsNormal::new(0.0, 2.0_f64.sqrt()).unwrap();
        let of = |excess: f64, precision: Precision| {
            let frozen = frozen(excess);
            let seed = Seed::new(4);
            estimated(&posterior, &frozen, &schedule, precision, seed).unwrap()
        };
        let own = of(0.0, Precision::Sharp);
        assert!(own.does && own.found.len() == 1000);
        let evidence = own.made.evidence.as_ref().unwrap();
        assert!(evidence.se > 0.0 && evidence.se < schedule.error);
        let off = evidence.log - known.ln_pdf(0.5);
        assert!(off.abs() < 4.0 * evidence.se, "{off} +- {}", evidence.se);
        // Some 800 are effective, and to choose among them scatters as much.
        let summary = own.made.draws.as_ref().map(crate::draws::summarise);
        let x = &summary.unwrap()[0];
        assert!((x.mean - 0.25).abs() < 4.0 * (2.0 * 0.5_f64 / 800.0).sqrt());
        let error = (2.0_f64 / (2.0 * 800.0)).sqrt();
        assert!((x.sd / 0.5_f64.sqrt() - 1.0).abs() < 4.0 * error);
        assert!(own.made.warnings.is_empty());
        // One weight of e^50.
        let mut poor = own.found;
        poor.push(Particle::new(vec![0.25], -50.0, 0.0));
        let made = concluded(&posterior, &poor, Seed::new(5)).unwrap();
        assert!(!made.warnings.is_empty());
        // sqrt(40/6000), the error that draws moved on have seen.
        let seen = of(40.0, Precision::Sharp).made.evidence.unwrap();
        assert!((seen.se - (40.0_f64 / 6000.0).sqrt()).abs() < 1e-15);
        // At the most 1; what is infinite says nothing.
        let most = of(1e6, Precision::Rough).made.evidence.unwrap();
        assert_eq!(most.se, 1.0);
        let nothing = of(f64::INFINITY, Precision::Sharp);
        let evidence = nothing.made.evidence.unwrap();
        assert!(evidence.se > 0.0 && evidence.se < schedule.error);
    }
}
