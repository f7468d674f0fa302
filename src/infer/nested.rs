//! The evidence over a few coordinates, the others integrated at each draw of
//! these.
//!
//! Where a posterior is nearly normal in most of its coordinates once a few
//! others are known, a mixture in all of them does badly and one in the few
//! does well: each draw of these is weighed by an unbiased estimate of what
//! the others hold there, which leaves the evidence unbiased (Tran, Scharth,
//! Pitt, Kohn 2013). The mixture learns from rounds of draws, is frozen, and
//! fresh draws make the estimate, as with the Laplace mixture.

use super::adapt::{fitted, reweighted};
use super::proposal::{Base, Mixture, Particle};
use super::weights::{Sum, log_mean_weight, quality, summed_cut};
use crate::error::Result;
use crate::model::Posterior;
use crate::parallel;
use crate::seed::{Rng, Seed};

/// A posterior of which a few coordinates are drawn, the outer ones.
pub(crate) trait Outer: Sync {
    /// A draw of the others.
    type Rest: Send;

    /// ln of an unbiased estimate of what the others hold at given outer
    /// coordinates, the prior of these included, with draws of the others;
    /// none where nothing is held.
    fn held(&self, z: &[f64], seed: Seed) -> Result<Held<Self::Rest>>;

    /// The prior of the outer coordinates, where a share of the draws is to be
    /// made of it, so that no place is out of reach.
    fn prior(&self) -> Option<&Posterior<'_>> {
        None
    }
}

/// What the other coordinates hold at given ones.
#[derive(Debug, Clone)]
pub(crate) struct Held<R> {
    pub(crate) log: f64,
    pub(crate) rest: Option<R>,
}

impl<R> Held<R> {
    /// What a place holds that has no density.
    pub(crate) fn nothing() -> Self {
        Self { log: f64::NEG_INFINITY, rest: None }
    }
}

/// How many draws of the outer coordinates are made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// In a round of learning.
    pub(crate) learning: usize,
    /// The most rounds of learning.
    pub(crate) rounds: u64,
    /// For the estimate: the fewest and the most, and the standard error of
    /// ln evidence that they are made for.
    pub(crate) last: (usize, usize),
    pub(crate) error: f64,
}

/// A frozen proposal of the outer coordinates.
#[derive(Debug, Clone)]
pub(crate) struct Learned {
    mixture: Mixture,
    /// About ln of the evidence.
    pub(crate) log: f64,
    /// The effective share of the last draws.
    share: f64,
}

/// Fresh draws of the outer coordinates, each with one of the others.
pub(crate) struct Integral<R> {
    pub(crate) sum: Sum,
    pub(crate) found: Vec<(Particle, Option<R>)>,
}

impl<R> Integral<R> {
    /// As many even draws as the weights are worth, and a hundred at least.
    pub(crate) fn draws(&self, seed: Seed) -> Vec<(&[f64], &R)> {
        self.with_rest(self.sum.chosen(seed))
    }

    /// So many even draws. Where few draws weigh most, weights that are cut say
    /// how wide they lie, and lean to the proposal, which is wider.
    pub(crate) fn spread(
        &self,
        count: usize,
        seed: Seed,
    ) -> Vec<(&[f64], &R)> {
        self.with_rest(self.sum.even(count, seed))
    }

    fn with_rest(&self, chosen: Vec<usize>) -> Vec<(&[f64], &R)> {
        let of = |i: usize| {
            let (particle, rest) = &self.found[i];
            rest.as_ref().map(|rest| (&particle.z[..], rest))
        };
        chosen.into_iter().filter_map(of).collect()
    }
}

/// Teaches a mixture of the outer coordinates where they lie.
///
/// # Errors
/// What no other parameter values would mend.
pub(crate) fn learn<O: Outer>(
    outer: &O,
    mut mixture: Mixture,
    effort: Effort,
    seed: Seed,
) -> Result<Learned> {
    let (mut log, mut share) = (f64::NEG_INFINITY, 0.0);
    for round in 0..effort.rounds {
        let seed = seed.child(round);
        let found = drawn(outer, &mixture, effort.learning, seed.child(0))?;
        let found: Vec<Particle> = found.into_iter().map(|f| f.0).collect();
        let (is, tail) = quality(&found);
        (log, share) = (log_mean_weight(&found), is);
        if share > GOOD && tail < 1.0 {
            break;
        }
        mixture = match round {
            0 | 1 => reweighted(&mixture, &found),
            _ => fitted(&mixture, &found, seed.child(1)),
        };
    }
    Ok(Learned { mixture, log, share })
}

/// An effective share that needs no further round: each draw costs dozens of
/// simulations, and one round of reweighting gains most.
const GOOD: f64 = 0.25;

/// The evidence from fresh draws, their weights cut.
///
/// # Errors
/// No draw with a positive density, or a model that fails.
pub(crate) fn integrated<O: Outer>(
    outer: &O,
    learned: &Learned,
    effort: Effort,
    seed: Seed,
) -> Result<Integral<O::Rest>> {
    let (fewest, most) = effort.last;
    let excess = 1.0 / learned.share.max(1e-6) - 1.0;
    let needed = (excess / effort.error.powi(2)) as usize;
    let count = needed.clamp(fewest, most);
    let found = drawn(outer, &learned.mixture, count, seed)?;
    let particles: Vec<Particle> = found.iter().map(|f| f.0.clone()).collect();
    // Each weight is an estimate, and one far too high would be all.
    Ok(Integral { sum: summed_cut(&particles)?, found })
}

/// Draws of the outer coordinates, each with what the others hold there.
fn drawn<O: Outer>(
    outer: &O,
    mixture: &Mixture,
    count: usize,
    seed: Seed,
) -> Result<Vec<(Particle, Option<O::Rest>)>> {
    parallel::try_map(0..count as u64, |i| {
        let seed = seed.child(i);
        let mut rng = seed.child(0).rng();
        let (z, base) = proposed(outer, mixture, &mut rng)?;
        let Some(base) = base else {
            return Ok((Particle::without_density(z.len()), None));
        };
        let held = outer.held(&z, seed.child(1))?;
        Ok((Particle::new(z, base, held.log), held.rest))
    })
}

/// A draw of the outer coordinates with ln of the proposal's density; `None`
/// in the place of that where their prior has no density.
fn proposed<O: Outer>(
    outer: &O,
    mixture: &Mixture,
    rng: &mut Rng,
) -> Result<(Vec<f64>, Option<f64>)> {
    let Some(prior) = outer.prior() else {
        let z = mixture.draw(rng);
        let base = mixture.log_density(&z);
        return Ok((z, Some(base)));
    };
    let base = Base::Mixture(mixture.clone());
    let particle = base.draw(prior, rng)?;
    let whole = particle.log_target() > f64::NEG_INFINITY;
    let base = whole.then_some(particle.base);
    Ok((particle.z, base))
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use statrs::distribution::{Continuous, Normal as StatrsNormal};

    use super::*;
    use crate::error::{Outcome, Stop};
    use crate::model::{Label, Number, Point, Program, Run};
    use crate::prior::AnyPrior;

    /// x ~ N(0, 1), which has no density below 0.
    struct Above;

    impl Program for Above {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let prior = AnyPrior::Normal(0.0, 1.0);
            let x = run.scalar(Label::new("x", "1"), prior)?;
            if x.value() < 0.0 {
                return Err(Stop::Reject("x is below 0"));
            }
            Ok(())
        }
    }

    /// 1 was seen of N(x, 0.1).
    struct Seen<'p>(Posterior<'p>);

    const ERROR: f64 = 0.1;

    impl Outer for Seen<'_> {
        type Rest = ();

        fn held(&self, z: &[f64], _: Seed) -> Result<Held<()>> {
            let prior = self.0.density(Point::Line(z))?.on_line();
            let law = StatrsNormal::new(z[0], ERROR).unwrap();
            Ok(Held { log: prior + law.ln_pdf(1.0), rest: Some(()) })
        }

        fn prior(&self) -> Option<&Posterior<'_>> {
            Some(&self.0)
        }
    }

    #[test]
    fn draws_without_a_density_are_learned_from_as_nothing() {
        let outer = Seen(Posterior::new(&Above).unwrap());
        // Most of what is drawn is below 0, and hardly any of it near 1.
        let mean = DVector::from_element(1, -2.0);
        let part = (1.0, mean, DMatrix::from_element(1, 1, 1.0));
        let mixture = Mixture::of([part].into_iter()).unwrap();
        let effort =
            Effort { learning: 200, rounds: 6, last: (400, 400), error: 0.1 };
        let learned = learn(&outer, mixture, effort, Seed::new(1)).unwrap();
        assert!(learned.share > GOOD, "{}", learned.share);
        let found = integrated(&outer, &learned, effort, Seed::new(2));
        let Sum { log, se, .. } = found.unwrap().sum;
        let known = StatrsNormal::new(0.0, ERROR.hypot(1.0)).unwrap();
        let off = log - known.ln_pdf(1.0);
        // Four standard errors of the estimate.
        assert!(off.abs() < 4.0 * se && se < 0.1, "{off} +- {se}");
    }
}
