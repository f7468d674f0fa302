//! What a free-form force holds at a given process and given parameters of
//! the model: the force integrated by importance sampling.

use nalgebra::DVector;
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use super::look::{Look, Sought, proposal};
use super::peak::Ridge;
use super::process::Process;
use super::tangent::{Tangent, Waves, half_log_det, log_normal};
use crate::draws::log_sum_exp;
use crate::error::{Error, Result};
use crate::infer::nested::{Effort, Held, Learned, Outer, learn};
use crate::infer::{student_constant, systematic};
use crate::seed::{Rng, Seed};

/// How many forces are drawn at a place: half of them mirror the others at
/// the best one, so that what is odd about it cancels.
const FORCES: usize = 12;
/// How many of these are kept.
const KEPT: usize = 8;
/// Degrees of freedom of what they are drawn from: somewhat heavier tails than
/// the normal ones.
const FREEDOM: f64 = 10.0;
/// From how many looks a start is taken.
const NEAREST: usize = 3;
/// How far below the highest peak, in ln, a place counts for nothing.
const DEEP: f64 = 12.0;
/// By how much, in ln, the weight of a draw must exceed what a normal
/// approximation holds to show that there is better, and how often that is
/// looked for.
const SURPRISE: f64 = 1.0;
const AGAIN: usize = 3;

/// A model with a free-form force, as one of the process and the model's own
/// parameters.
pub(super) struct Marginal<'a, 'm> {
    pub(super) sought: Sought<'a, 'm>,
    /// Where the force is known to be best.
    pub(super) looks: Vec<Look>,
    /// ln of a density below which a place counts for nothing.
    least: f64,
    /// Whether several events share the force: what is likely is rougher
    /// then, for the ground bends at the points of every track.
    shared: bool,
}

impl Outer for Marginal<'_, '_> {
    /// Forces in each cell \[m/s2\].
    type Rest = Vec<Vec<f64>>;

    fn held(&self, z: &[f64], seed: Seed) -> Result<Held<Self::Rest>> {
        let (process, own) = Process::parted(z);
        let own = DVector::from_column_slice(own);
        let ridge = Ridge {
            least: self.least - process.log_prior(),
            ..self.sought.ridge(process)
        };
        let Some(from) = self.start(&ridge, &own) else {
            return Ok(Held::nothing());
        };
        let Some(mut best) = ridge.best(&own, &from)? else {
            return Ok(Held::nothing());
        };
        if self.shared {
            let mut rng = seed.child(0).rng();
            best = outdone(&ridge, best, &own, &mut rng)?;
        }
        let mut rng = seed.child(1).rng();
        let (waves, logs) = drawn(&ridge, &best.1, &own, &mut rng)?;
        let total = log_sum_exp(logs.iter().copied());
        if total == f64::NEG_INFINITY {
            return Ok(Held::nothing());
        }
        let weights: Vec<f64> =
            logs.iter().map(|log| (log - total).exp()).collect();
        let chosen = systematic(&weights, KEPT, &mut rng).into_iter();
        let force = |i: usize| &ridge.basis.factor * &waves[i];
        let rest = chosen.map(|i| force(i).as_slice().to_vec()).collect();
        let log = total - (FORCES as f64).ln() + process.log_prior();
        Ok(Held { log, rest: Some(rest) })
    }
}

impl<'a, 'm> Marginal<'a, 'm> {
    /// With a force that several events may share, and what draws from where
    /// the looks have it teach; `None` where it has no density there.
    ///
    /// # Errors
    /// A model that fails.
    pub(super) fn learned(
        sought: Sought<'a, 'm>,
        looks: Vec<Look>,
        shared: bool,
        effort: Effort,
        seed: Seed,
    ) -> Result<Option<(Self, Learned)>> {
        let Some(mixture) = proposal(&looks) else { return Ok(None) };
        let heights = looks.iter().map(|look| look.peak.top.height);
        let least = heights.fold(f64::NEG_INFINITY, f64::max) - DEEP;
        let marginal = Self { sought, looks, least, shared };
        let learned = learn(&marginal, mixture, effort, seed)?;
        Ok(learned.log.is_finite().then_some((marginal, learned)))
    }

    /// The tangent to start from: of the nearest looks the one that promises
    /// most.
    fn start(
        &self,
        ridge: &Ridge<'_, '_>,
        own: &DVector<f64>,
    ) -> Option<Tangent> {
        let off = |look: &Look| look.peak.distance(&ridge.process, own);
        let mut near: Vec<(f64, &Look)> =
            self.looks.iter().map(|look| (off(look), look)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let nearest = near.into_iter().take(NEAREST);
        let promising = nearest.map(|(_, look)| {
            let tangent = look.tangent.along(&ridge.basis);
            let height = tangent.waves(own).map(|w| tangent.height(&w));
            (height.unwrap_or(f64::NEG_INFINITY), tangent)
        });
        let best = promising.max_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, tangent)| tangent)
    }
}

/// The best, or a better one that draws about it lead to.
fn outdone(
    ridge: &Ridge<'_, '_>,
    mut best: (Tangent, Waves),
    own: &DVector<f64>,
    rng: &mut Rng,
) -> Result<(Tangent, Waves)> {
    let height = |(tangent, waves): &(Tangent, Waves)| tangent.height(waves);
    for _ in 0..AGAIN {
        let (waves, logs) = drawn(ridge, &best.1, own, rng)?;
        let top = logs.iter().zip(waves);
        let top = top.max_by(|a, b| a.0.total_cmp(b.0));
        let surprise = height(&best) + SURPRISE;
        let Some((_, waves)) = top.filter(|(log, _)| **log > surprise) else {
            break;
        };
        let tangent =
            ridge.cells.tangent(&ridge.basis, &waves, own.clone())?;
        let Some(tangent) = tangent else { break };
        match ridge.best(own, &tangent)? {
            Some(other) if height(&other) > height(&best) => best = other,
            _ => break,
        }
    }
    Ok(best)
}

/// Waves drawn about the best, each with ln of its importance weight.
fn drawn(
    ridge: &Ridge<'_, '_>,
    waves: &Waves,
    own: &DVector<f64>,
    rng: &mut Rng,
) -> Result<(Vec<DVector<f64>>, Vec<f64>)> {
    let spread = waves.precision.l().transpose();
    let (mut all, mut logs) = (Vec::new(), Vec::new());
    for _ in 0..FORCES / 2 {
        let (white, base) = student(waves.mean.len(), rng)?;
        let base = base + half_log_det(&waves.precision);
        let Some(off) = spread.solve_upper_triangular(&white) else {
            continue;
        };
        for waves in [&waves.mean + &off, &waves.mean - &off] {
            let force = &ridge.basis.factor * &waves;
            let log = ridge.cells.log_density(&force, own.as_slice())?;
            logs.push(log + log_normal(&waves) - base);
            all.push(waves);
        }
    }
    Ok((all, logs))
}

/// A draw of Student's t distribution of so many dimensions, with ln of its
/// density.
fn student(count: usize, rng: &mut Rng) -> Result<(DVector<f64>, f64)> {
    let (n, k) = (count as f64, FREEDOM);
    let law = ChiSquared::new(k)
        .map_err(|e| Error::inference(format!("degrees of freedom: {e}")))?;
    let shrink = (k / law.sample(rng)).sqrt();
    let white = DVector::from_fn(count, |_, _| {
        let normal: f64 = StandardNormal.sample(rng);
        shrink * normal
    });
    let tail = 0.5 * (k + n) * (white.norm_squared() / k).ln_1p();
    Ok((white, student_constant(k, n) - tail))
}
