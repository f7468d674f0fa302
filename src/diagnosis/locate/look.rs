//! Looks at the process of a free-form force, at a grid of its length and
//! size: where the model's parameters are best there, the force integrated by
//! its normal approximation.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

use super::free_form::FreeForm;
use super::marginal::{Best, sharpness, step};
use super::{CELLS, LENGTH, SIZE};
use crate::error::{Error, Result};
use crate::infer::{Mixture, Peak, climb, damped_step};
use crate::model::{Posterior, Program, With};
use crate::observe::Extent;
use crate::physics::forces::Axis;
use crate::prior::AnyPrior;

/// A process, as two numbers that are standard normal beforehand: of its
/// length and of its size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Process(pub(crate) f64, pub(crate) f64);

impl Process {
    /// The first coordinates of a place, and the rest.
    pub(super) fn parted(z: &[f64]) -> (Self, &[f64]) {
        (Self(z[0], z[1]), &z[2..])
    }

    /// Its length \[m\].
    pub(super) fn length(&self) -> f64 {
        let (median, spread) = LENGTH;
        // Beyond these a process is as good as white, or as constant.
        median * (spread * self.0).exp().clamp(1e-3, 1e3)
    }

    /// Its size \[m/s2\].
    pub(super) fn size(&self) -> f64 {
        let p = Normal::standard().cdf(self.1).clamp(1e-9, 1.0 - 1e-9);
        AnyPrior::HalfNormal(SIZE).quantile(p).unwrap_or(SIZE)
    }

    pub(super) fn log_prior(&self) -> f64 {
        let Self(a, b) = self;
        -0.5 * (a * a + b * b) - std::f64::consts::TAU.ln()
    }

    /// The squared distance of another.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        (self.0 - other.0).powi(2) + (self.1 - other.1).powi(2)
    }
}

/// The grid, and how far apart its places are; its least size is hardly a
/// force.
const LENGTHS: [f64; 3] = [-1.0, 0.0, 1.0];
const SIZES: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];
const APART: f64 = 0.6;
/// By which lengths the grid grows, from either edge on, where its edge holds
/// nearly as much as its best, in ln.
const BEYOND: [&[f64]; 2] = [&[-1.0, -2.0], &[1.0, 2.0, 3.0]];
const NEARLY: f64 = 4.0;
/// Within this squared distance a look may learn from a better one, if that
/// holds so much more in ln.
const NEAR: f64 = 1.1;
const BETTER: f64 = 0.5;
/// Looks that hold so much less than the best, in ln, teach nothing.
const LEAST: f64 = 10.0;
/// The most steps of a climb, the longest along one axis of the line, and a
/// gain below which it has arrived.
const STEPS: usize = 12;
const LONGEST: f64 = 1.0;
const ARRIVED: f64 = 0.02;
/// How far the parameters are nudged to see how the force narrows.
const NUDGE: f64 = 0.02;

/// A peak of the density of a model's own parameters at one process.
#[derive(Debug, Clone)]
pub(super) struct Look {
    pub(super) process: Process,
    waves: DVector<f64>,
    /// By how much the best waves fall as the own parameters rise.
    follows: DMatrix<f64>,
    /// In the own parameters.
    pub(super) peak: Peak,
    /// ln of about what it integrates to, the process's prior included.
    log_evidence: f64,
}

impl Look {
    /// About how unlikely a place is to be under this peak.
    pub(super) fn distance(&self, process: &Process, own: &[f64]) -> f64 {
        let own = DVector::from_column_slice(own);
        self.process.distance(process) / APART.powi(2)
            + self.peak.distance(&own)
    }

    /// About the best waves there, as they follow the own parameters or not.
    pub(super) fn waves_at(&self, own: &[f64]) -> [DVector<f64>; 2] {
        let off = DVector::from_column_slice(own) - &self.peak.line;
        [&self.waves - &self.follows * off, self.waves.clone()]
    }
}

/// A program with a free-form force along an axis.
pub(super) struct Sought<'a, P> {
    pub(super) program: &'a P,
    pub(super) extent: &'a Extent,
    pub(super) axis: Axis,
}

impl<P: Program> Sought<'_, P> {
    /// What a task finds under a process.
    pub(super) fn under<T>(
        &self,
        process: Process,
        task: impl FnOnce(&FreeForm, &Posterior<'_>) -> Result<T>,
    ) -> Result<T> {
        let free = FreeForm::new(self.extent, self.axis, process)?;
        let with = With::new(self.program, &[&free]);
        task(&free, &Posterior::new(&with)?)
    }

    /// The looks of the whole grid, from likely own parameters: from small
    /// sizes to large ones, where at first the errors explain what the model
    /// does not, and back, where at first the force does.
    ///
    /// # Errors
    /// A model that fails, or one that has no density near these.
    pub(super) fn looks(&self, own: &[f64]) -> Result<Vec<Look>> {
        let mut found = self.columns(&LENGTHS, own)?;
        for lengths in BEYOND {
            for pair in lengths.windows(2) {
                if matters(&found, pair[0]) {
                    found.extend(self.columns(&pair[1..], own)?);
                }
            }
        }
        let again = found.par_iter().map(|look| self.again(look, &found));
        let found = again.collect::<Result<Vec<_>>>()?;
        if found.is_empty() {
            return Err(Error::inference("no free-form force has a mode"));
        }
        Ok(found)
    }

    /// The looks at some lengths, from both sides.
    fn columns(&self, lengths: &[f64], own: &[f64]) -> Result<Vec<Look>> {
        let (first, last) = (SIZES[0], SIZES[SIZES.len() - 1]);
        let both = lengths.into_par_iter().flat_map(|&length| {
            let sides = [(first, false), (last, true)].into_par_iter();
            sides.map(move |(size, back)| {
                let start = self.start(Process(length, size), own, back)?;
                self.along(length, &start, back)
            })
        });
        Ok(both.collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
    }

    /// Where the looks start, as waves and own parameters: at no force, or
    /// where all are best together, which is where the force follows the
    /// recording most.
    fn start(
        &self,
        process: Process,
        own: &[f64],
        best: bool,
    ) -> Result<DVector<f64>> {
        let none = [vec![0.0; CELLS], own.to_vec()].concat();
        if !best {
            return Ok(DVector::from_vec(none));
        }
        let peak = self.under(process, |_, joint| climb(joint, &none))?;
        Ok(peak.map_or(DVector::from_vec(none), |peak| peak.line))
    }

    /// The looks at one length, each from the one before.
    fn along(
        &self,
        length: f64,
        start: &DVector<f64>,
        back: bool,
    ) -> Result<Vec<Look>> {
        let mut sizes = SIZES;
        if back {
            sizes.reverse();
        }
        let (waves, own) = start.as_slice().split_at(CELLS);
        let mut from = (
            DVector::from_column_slice(waves),
            DVector::from_column_slice(own),
        );
        let mut found: Vec<Look> = Vec::new();
        for size in sizes {
            let process = Process(length, size);
            if let Some(look) = self.look(process, &from.0, &from.1)? {
                from = (look.waves.clone(), look.peak.line.clone());
                found.push(look);
            }
        }
        Ok(found)
    }

    /// A look once more, from the best of those nearby, if that is better.
    fn again(&self, look: &Look, all: &[Look]) -> Result<Look> {
        let near = all
            .iter()
            .filter(|other| other.process.distance(&look.process) < NEAR)
            .max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence));
        let better = near
            .filter(|other| other.log_evidence > look.log_evidence + BETTER);
        let Some(other) = better else { return Ok(look.clone()) };
        let found = self.look(look.process, &other.waves, &other.peak.line)?;
        let found = found.filter(|f| f.log_evidence > look.log_evidence);
        Ok(found.unwrap_or_else(|| look.clone()))
    }

    /// The look at a process that a start leads to; `None` where the start has
    /// no density.
    fn look(
        &self,
        process: Process,
        waves: &DVector<f64>,
        own: &DVector<f64>,
    ) -> Result<Option<Look>> {
        self.under(process, |_, posterior| {
            let start =
                Best::from(posterior, waves.as_slice(), own.as_slice())?;
            let Some(best) = start else { return Ok(None) };
            let climb = Climb { posterior, damping: 1e-2 };
            let (peak, waves, follows) = climb.climbed(own.clone(), best)?;
            Ok(peak.log_evidence().map(|log| {
                let log_evidence = log + process.log_prior();
                Look { process, waves, follows, peak, log_evidence }
            }))
        })
    }
}

/// Whether the looks at a length hold nearly as much as the best.
fn matters(looks: &[Look], length: f64) -> bool {
    let there = looks.iter().filter(|look| look.process.0 == length);
    most(looks.iter()) - most(there) < NEARLY
}

/// ln of what the best of some looks holds.
fn most<'l>(looks: impl Iterator<Item = &'l Look>) -> f64 {
    let logs = looks.map(|look| look.log_evidence);
    logs.fold(f64::NEG_INFINITY, f64::max)
}

/// ln of the density of the own parameters about a place, the force integrated.
struct Slope {
    gradient: DVector<f64>,
    /// About minus its Hessian.
    precision: DMatrix<f64>,
    /// By how much the best waves fall as the own parameters rise.
    follows: DMatrix<f64>,
}

/// A climb of the own parameters, the force integrated.
struct Climb<'a, 'm> {
    posterior: &'a Posterior<'m>,
    damping: f64,
}

impl Climb<'_, '_> {
    /// The peak that a start leads to, with the waves there and how they
    /// follow.
    fn climbed(
        mut self,
        mut own: DVector<f64>,
        mut best: Best,
    ) -> Result<(Peak, DVector<f64>, DMatrix<f64>)> {
        let mut slope = best.slope(self.posterior)?;
        for _ in 0..STEPS {
            match self.step(&own, &best, &slope)? {
                Some(next) => (own, best) = next,
                None => break,
            }
            slope = best.slope(self.posterior)?;
        }
        let Slope { precision, follows, .. } = slope;
        let height = best.height();
        Ok((Peak { line: own, height, precision }, best.waves, follows))
    }

    /// A step that climbs, with ever more damping until one does; `None` where
    /// there is nothing to gain.
    fn step(
        &mut self,
        own: &DVector<f64>,
        best: &Best,
        slope: &Slope,
    ) -> Result<Option<(DVector<f64>, Best)>> {
        let Slope { gradient, precision, follows } = slope;
        for _ in 0..6 {
            let off = damped_step(precision, gradient, self.damping);
            if let Some(mut off) = off {
                if 0.5 * off.dot(gradient) < ARRIVED {
                    return Ok(None);
                }
                off *= (LONGEST / off.amax()).min(1.0);
                let start = &best.waves - follows * &off;
                let next = own + off;
                let (start, own) = (start.as_slice(), next.as_slice());
                let found = Best::from(self.posterior, start, own)?;
                if let Some(found) = found
                    && found.height() > best.height()
                {
                    self.damping *= 0.2;
                    return Ok(Some((next, found)));
                }
            }
            self.damping = (5.0 * self.damping).max(1e-3);
        }
        Ok(None)
    }
}

impl Best {
    /// Its slope: that of the density along the ridge of the best forces, and
    /// how these narrow by differences.
    fn slope(&self, posterior: &Posterior<'_>) -> Result<Slope> {
        let all = &self.about.precision;
        let n = self.line.len() - CELLS;
        let across = all.view((0, CELLS), (CELLS, n)).into_owned();
        let follows = self.precision.solve(&across);
        let pull = self.about.gradient.rows(0, CELLS);
        let own = self.about.gradient.rows(CELLS, n);
        let mut gradient = own - follows.tr_mul(&pull);
        let precision =
            all.view((CELLS, CELLS), (n, n)) - across.tr_mul(&follows);
        let here = sharpness(&self.precision);
        for i in 0..n {
            let mut next = self.line.clone();
            next[CELLS + i] += NUDGE;
            let along = follows.column(i);
            next.iter_mut().zip(&along).for_each(|(x, f)| *x -= NUDGE * f);
            if let Some((_, there)) = step(&posterior.information(&next)?) {
                gradient[i] -= (sharpness(&there) - here) / NUDGE;
            }
        }
        Ok(Slope { gradient, precision, follows })
    }
}

/// Where the process and the model's parameters are likely, as the looks have
/// them.
///
/// # Errors
/// Looks without width.
pub(super) fn proposal(looks: &[Look]) -> Result<Mixture> {
    let best = most(looks.iter());
    let near = looks.iter().filter(|l| best - l.log_evidence < LEAST);
    let parts = near.filter_map(|look| {
        let n = look.peak.line.len();
        let own = look.peak.precision.clone().cholesky()?.inverse();
        let mut covariance = DMatrix::identity(2 + n, 2 + n) * APART.powi(2);
        covariance.view_mut((2, 2), (n, n)).copy_from(&own);
        let Process(length, size) = look.process;
        let own = look.peak.line.iter().copied();
        let mean: Vec<f64> = [length, size].into_iter().chain(own).collect();
        // The root keeps those in whose approximation is poor.
        let weight = (0.5 * (look.log_evidence - best)).exp();
        Some((weight, DVector::from_vec(mean), covariance))
    });
    Mixture::of(parts).ok_or_else(|| {
        Error::inference("no free-form force has a mode with a width")
    })
}
