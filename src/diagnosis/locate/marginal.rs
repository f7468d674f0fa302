//! What a free-form force holds at a given process and given parameters of
//! the model: the force integrated.
//!
//! The square of the speed is linear in a force over distance, so that given
//! the process and the model's parameters the force is nearly normal, while
//! the process's size and the errors are not: where all are climbed together
//! the best place is one at which the force follows every error, and what a
//! normal approximation there integrates to was seen to be 4 in ln too low.

use nalgebra::{Cholesky, DVector, Dyn};
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use super::CELLS;
use super::look::{Look, Process, Sought};
use crate::draws::log_sum_exp;
use crate::error::{Error, Result};
use crate::infer::{Conditional, Held, student_constant, systematic};
use crate::model::{Information, Point, Posterior, Program};
use crate::seed::{Rng, Seed};

/// How many forces are drawn at a place: half of them mirror the others at
/// the best one, so that what is odd about it cancels.
const FORCES: usize = 32;
/// How many of these are kept.
const KEPT: usize = 8;
/// Degrees of freedom of what they are drawn from: somewhat heavier tails than
/// the normal ones.
const FREEDOM: f64 = 10.0;
/// The most steps to where the force is best, and a gain of the log density
/// below which a step more is not worth it.
const STEPS: usize = 8;
const ARRIVED: f64 = 0.1;
/// From how many looks a start is taken.
const NEAREST: usize = 6;
/// By how much, in ln, the weight of a draw must exceed what a normal
/// approximation holds to show that there is better, and how often that is
/// looked for.
const SURPRISE: f64 = 1.0;
const AGAIN: usize = 4;

/// A model with a free-form force, as one of the process and the model's own
/// parameters.
pub(super) struct Marginal<'a, P> {
    pub(super) sought: Sought<'a, P>,
    /// Where the waves are known to be best.
    pub(super) looks: Vec<Look>,
}

impl<P: Program> Conditional for Marginal<'_, P> {
    fn held(&self, z: &[f64], seed: Seed) -> Result<Held> {
        let (process, own) = Process::parted(z);
        self.sought.under(process, |free, posterior| {
            let start = self.start(&process, own, posterior)?;
            let Some(mut best) = Best::from(posterior, &start, own)? else {
                return Ok(Held::nothing());
            };
            if self.sought.program.events() > 1 {
                let mut rng = seed.child(0).rng();
                best = best.outdone(posterior, own, &mut rng)?;
            }
            let mut rng = seed.child(1).rng();
            let (waves, logs) = best.drawn(posterior, own, &mut rng)?;
            let total = log_sum_exp(logs.iter().copied());
            if total == f64::NEG_INFINITY {
                return Ok(Held::nothing());
            }
            let weights: Vec<f64> =
                logs.iter().map(|log| (log - total).exp()).collect();
            let chosen = systematic(&weights, KEPT, &mut rng).into_iter();
            let log = total - (FORCES as f64).ln() + process.log_prior();
            let rest = chosen.map(|i| free.force(&waves[i])).collect();
            Ok(Held { log, rest })
        })
    }
}

impl<P> Marginal<'_, P> {
    /// Waves to start from: the likeliest that the nearest looks have.
    fn start(
        &self,
        process: &Process,
        own: &[f64],
        posterior: &Posterior<'_>,
    ) -> Result<Vec<f64>> {
        let off = |look: &Look| look.distance(process, own);
        let mut near: Vec<(f64, &Look)> =
            self.looks.iter().map(|look| (off(look), look)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = (f64::NEG_INFINITY, vec![0.0; CELLS]);
        for (_, look) in near.iter().take(NEAREST) {
            for waves in look.waves_at(own) {
                let log = log_density(posterior, &waves, own)?;
                if log > best.0 {
                    best = (log, waves.as_slice().to_vec());
                }
            }
        }
        Ok(best.1)
    }
}

/// Waves that are about best, given a model's own parameters.
pub(super) struct Best {
    pub(super) waves: DVector<f64>,
    pub(super) precision: Cholesky<f64, Dyn>,
    /// The last place before, and the model there.
    pub(super) line: Vec<f64>,
    pub(super) about: Information,
}

impl Best {
    /// Those that a start leads to; `None` where it has no density.
    pub(super) fn from(
        posterior: &Posterior<'_>,
        start: &[f64],
        own: &[f64],
    ) -> Result<Option<Self>> {
        let mut waves = DVector::from_column_slice(start);
        let mut found = None;
        for _ in 0..STEPS {
            let line = [waves.as_slice(), own].concat();
            let about = posterior.information(&line)?;
            let Some((step, precision)) = step(&about) else { break };
            let gain = 0.5 * step.dot(&about.gradient.rows(0, CELLS));
            let (from, height) = (waves.clone(), about.density.on_line());
            let next = &from + &step;
            found = Some(Self { waves: next, precision, line, about });
            if gain < ARRIVED {
                break;
            }
            match climbed(posterior, &from, &step, own, height)? {
                Some(higher) => waves = higher,
                None => break,
            }
        }
        Ok(found)
    }

    /// ln of the density of the own parameters, the force integrated.
    pub(super) fn height(&self) -> f64 {
        let before = DVector::from_column_slice(&self.line[..CELLS]);
        let pull = self.about.gradient.rows(0, CELLS);
        let gain = 0.5 * (&self.waves - before).dot(&pull);
        let n = CELLS as f64;
        self.about.density.on_line() + gain - sharpness(&self.precision)
            + 0.5 * n * std::f64::consts::TAU.ln()
    }

    /// The same, or better ones that draws about it lead to.
    ///
    /// The ground bends at the track's points: where the errors are small,
    /// what is likely is rough, and more so the more events share a force.
    fn outdone(
        mut self,
        posterior: &Posterior<'_>,
        own: &[f64],
        rng: &mut Rng,
    ) -> Result<Self> {
        for _ in 0..AGAIN {
            let (waves, logs) = self.drawn(posterior, own, rng)?;
            let drawn = logs.iter().zip(&waves);
            let top = drawn.max_by(|a, b| a.0.total_cmp(b.0));
            let surprise = self.height() + SURPRISE;
            let Some((_, start)) = top.filter(|(log, _)| **log > surprise)
            else {
                break;
            };
            match Self::from(posterior, start, own)? {
                Some(other) if other.height() > self.height() => self = other,
                _ => break,
            }
        }
        Ok(self)
    }

    /// Waves drawn about the best, each with ln of its importance weight.
    fn drawn(
        &self,
        posterior: &Posterior<'_>,
        own: &[f64],
        rng: &mut Rng,
    ) -> Result<(Vec<Vec<f64>>, Vec<f64>)> {
        let spread = self.precision.l().transpose();
        let (mut all, mut logs) = (Vec::new(), Vec::new());
        for _ in 0..FORCES / 2 {
            let (white, base) = student(rng)?;
            let base = base + sharpness(&self.precision);
            let Some(off) = spread.solve_upper_triangular(&white) else {
                continue;
            };
            for waves in [&self.waves + &off, &self.waves - &off] {
                logs.push(log_density(posterior, &waves, own)? - base);
                all.push(waves.as_slice().to_vec());
            }
        }
        Ok((all, logs))
    }
}

/// Half of ln det of a precision.
pub(super) fn sharpness(precision: &Cholesky<f64, Dyn>) -> f64 {
    precision.l_dirty().diagonal().iter().map(|d| d.ln()).sum()
}

/// Newton's step of the waves, with the precision that it goes by.
pub(super) fn step(
    about: &Information,
) -> Option<(DVector<f64>, Cholesky<f64, Dyn>)> {
    if !about.density.on_line().is_finite() {
        return None;
    }
    let precision = about.precision.view((0, 0), (CELLS, CELLS));
    let precision = precision.into_owned().cholesky()?;
    let step = precision.solve(&about.gradient.rows(0, CELLS).into_owned());
    step.iter().all(|s| s.is_finite()).then_some((step, precision))
}

/// As much of a step as climbs, if any of it does.
fn climbed(
    posterior: &Posterior<'_>,
    waves: &DVector<f64>,
    step: &DVector<f64>,
    own: &[f64],
    before: f64,
) -> Result<Option<DVector<f64>>> {
    for share in [1.0, 0.5, 0.2, 0.05] {
        let next = waves + share * step;
        if log_density(posterior, &next, own)? > before {
            return Ok(Some(next));
        }
    }
    Ok(None)
}

/// ln of the density of waves and own parameters.
fn log_density(
    posterior: &Posterior<'_>,
    waves: &DVector<f64>,
    own: &[f64],
) -> Result<f64> {
    let line = [waves.as_slice(), own].concat();
    Ok(posterior.density(Point::Line(&line))?.on_line())
}

/// A draw of Student's t distribution of as many dimensions as there are
/// cells, with ln of its density.
fn student(rng: &mut Rng) -> Result<(DVector<f64>, f64)> {
    let (n, k) = (CELLS as f64, FREEDOM);
    let law = ChiSquared::new(k)
        .map_err(|e| Error::inference(format!("degrees of freedom: {e}")))?;
    let shrink = (k / law.sample(rng)).sqrt();
    let white = DVector::from_fn(CELLS, |_, _| {
        let normal: f64 = StandardNormal.sample(rng);
        shrink * normal
    });
    let tail = 0.5 * (k + n) * (white.norm_squared() / k).ln_1p();
    Ok((white, student_constant(k, n) - tail))
}
