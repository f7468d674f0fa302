//! Whether a proposal misses a place that no draw of its own reaches.
//!
//! Weights are even where a mixture misses a place that it never draws.
//! Errors with heavy tails in a real recording have two hills, and with one
//! seed in 16 the higher was left out: a standard error of 0.06 was stated for
//! an evidence 1.4 too low. So draws are moved on by a Markov kernel that
//! leaves the posterior invariant. For weights w = p/q,
//! E_q\[w^2\] / Z^2 = E_p\[w\] / Z: their mean weight where they arrive tells the
//! effective share a second time.

use super::backends::smc::moved;
use super::proposal::{Base, Mixture, Particle};
use super::schedule::Schedule;
use super::weights::log_mean_weight;
use crate::error::Result;
use crate::model::Posterior;
use crate::seed::Seed;

/// What draws that were moved on say of a proposal.
pub(super) struct Moved {
    /// The relative variance of its weights, by them.
    pub(super) excess: f64,
    /// Where they came to.
    pub(super) places: Vec<Vec<f64>>,
}

impl Moved {
    /// Moves weighted draws of a mixture on, and looks at it where they come
    /// to.
    ///
    /// # Errors
    /// What no other parameter values would mend.
    pub(super) fn on(
        posterior: &Posterior<'_>,
        mixture: &Mixture,
        found: &[Particle],
        schedule: &Schedule,
        seed: Seed,
    ) -> Result<Self> {
        let base = Base::Mixture(mixture.clone());
        let moved = moved(posterior, base, found, schedule.moved, seed)?;
        let second = log_mean_weight(&moved) - log_mean_weight(found);
        let places = moved.into_iter().map(|p| p.z).collect();
        Ok(Self { excess: (second.exp() - 1.0).max(0.0), places })
    }

    /// Whether the mixture, of such an effective share by its own draws, misses
    /// a place that they came to.
    pub(super) fn met_more(&self, share: f64, schedule: &Schedule) -> bool {
        let tolerated = schedule.reached_share.min(HALF * share);
        self.excess + 1.0 > 1.0 / tolerated
    }
}

/// Which part of the effective share has to remain by draws that were moved
/// on: a mean of few weights scatters.
const HALF: f64 = 0.5;

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::error::Outcome;
    use crate::infer::adapt::Frozen;
    use crate::infer::proposal::population;
    use crate::infer::weights::quality;
    use crate::model::{Label, Number, Program, Run};
    use crate::prior::{AnyPrior, Normal};
    use crate::scalar::Real;

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
        let schedule = Schedule::default();
        let met_more = |mixture: &Mixture, found: &[Particle]| {
            let seed = Seed::new(2);
            let moved = Moved::on(&posterior, mixture, found, &schedule, seed);
            let (share, _) = quality(found);
            moved.unwrap().met_more(share, &schedule)
        };
        let both = on(&[1.0, -1.0]);
        let all = drawn(&both);
        assert!(!met_more(&both, &all));
        let one = on(&[1.0]);
        let half = drawn(&one);
        let short = log_mean_weight(&all) - log_mean_weight(&half);
        // Half is missed, and by the draws a fifth are effective.
        assert!((short - 2f64.ln()).abs() < 0.1, "{short}");
        let (share, _) = quality(&half);
        assert!(share > schedule.good_share, "{share}");
        assert!(met_more(&one, &half), "a hill is missed");
        let rounds = schedule.rounds;
        let learned = Frozen::new(one)
            .learned(&posterior, &schedule, rounds, Seed::new(3))
            .unwrap();
        assert!(learned.good);
        let found = log_mean_weight(&drawn(&learned.mixture));
        // Four standard errors of two means of 2000 draws of which a tenth
        // are effective; to miss half costs 0.7.
        let off = found - log_mean_weight(&all);
        assert!(off.abs() < 4.0 * 2f64.sqrt() * 0.067, "{off}");
    }
}
