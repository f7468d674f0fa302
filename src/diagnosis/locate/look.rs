//! Looks at a free-form force under a grid of processes: where the model's own
//! parameters are best, the force integrated.

use nalgebra::{DMatrix, DVector};

use super::process::Process;
use super::tangent::{Basis, Cells, Tangent, Waves, half_log_det};
use crate::error::{Error, Result};
use crate::infer::{Climb, Landscape, Mixture, Slope};
use crate::mechanism::Extent;
use crate::model::Posterior;
use crate::parallel;

/// A grid of processes: their lengths and sizes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    lengths: &'static [f64],
    sizes: &'static [f64],
    /// By which lengths it grows, from either edge on, where its edge holds
    /// nearly as much as its best.
    beyond: [&'static [f64]; 2],
}

/// The least size is hardly a force.
pub(super) const FINE: Grid = Grid {
    lengths: &[-1.0, 0.0, 1.0],
    sizes: &[-2.0, -1.0, 0.0, 1.0, 2.0],
    beyond: [&[-1.0, -2.0], &[1.0, 2.0, 3.0]],
};
/// Enough to begin from where noises are compared: their evidences are then
/// within 1 in ln of those from the fine grid.
pub(super) const COARSE: Grid = Grid {
    lengths: &[0.0],
    sizes: &[-1.0, 1.0],
    beyond: [&[0.0, -2.0], &[0.0, 2.0]],
};
/// How wide what is drawn about a place of the fine grid lies.
const SPACING: f64 = 0.6;
/// How much less than the best an edge holds, in ln, beyond which a grid
/// grows.
const NEARLY: f64 = 4.0;
/// Looks that hold so much less than the best, in ln, teach nothing.
const NEGLIGIBLE: f64 = 10.0;
/// Looks nearer than this many widths, squared, are one.
const ALIKE: f64 = 0.1;
/// A climb of the own parameters.
const CLIMB: Climb =
    Climb { steps: 10, longest: 1.0, arrived: 0.02, leaps: 0 };
/// The most tangents at given own parameters, and what a further one has to
/// promise, in ln.
const TANGENTS: usize = 4;
const NEARBY: f64 = 0.5;
/// How many times as much as the last tangent gained those after it may gain:
/// of 6900 places that counted, 24 gained more.
const FURTHER: f64 = 2.0;

/// A peak of the density of a model's own parameters at one process.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Look {
    pub(super) process: Process,
    /// The model there, along the cells.
    pub(super) tangent: Tangent,
    /// About minus the Hessian of the own parameters' density.
    precision: DMatrix<f64>,
    /// ln of its height, and of about what it integrates to, both with the
    /// process's prior.
    pub(super) height: f64,
    pub(super) log_evidence: f64,
}

impl Look {
    /// One with the slope of the density and the model at a peak; `None`
    /// where that has no width.
    fn of(process: Process, slope: Slope, tangent: Tangent) -> Option<Self> {
        let half = half_log_det(&slope.precision.clone().cholesky()?);
        let n = slope.gradient.len() as f64;
        let height = slope.height + process.log_prior();
        let log_evidence =
            height - half + 0.5 * n * std::f64::consts::TAU.ln();
        let precision = slope.precision;
        Some(Self { process, tangent, precision, height, log_evidence })
    }

    /// About how unlikely a place is to be under this peak.
    pub(super) fn distance(
        &self,
        process: &Process,
        own: &DVector<f64>,
    ) -> f64 {
        let off = own - &self.tangent.own;
        self.process.distance(process) / SPACING.powi(2)
            + off.dot(&(&self.precision * &off))
    }
}

/// A model with a force of cells, over the extent of its events.
#[derive(Clone, Copy)]
pub(super) struct Sought<'a, 'm> {
    pub(super) cells: Cells<'a, 'm>,
    pub(super) extent: &'a Extent,
    /// Forces of their own along the whole run, beforehand each as large as
    /// the process's.
    pub(super) besides: Option<&'a DMatrix<f64>>,
}

impl<'a, 'm> Sought<'a, 'm> {
    /// Of so many cells, with a process's force alone.
    pub(super) fn of(
        posterior: &'a Posterior<'m>,
        extent: &'a Extent,
        cells: usize,
    ) -> Self {
        let cells = Cells { posterior, count: cells };
        Self { cells, extent, besides: None }
    }

    /// What makes a process's force of standard normal waves.
    pub(super) fn basis(&self, process: &Process) -> Basis {
        let factor = process.factor(self.extent, self.cells.count);
        let own = self.cells.own();
        let Some(besides) = self.besides else {
            return Basis::new(factor, own);
        };
        let scaled = besides * process.size();
        let waves = factor.ncols();
        let mut all = factor.resize_horizontally(waves + scaled.ncols(), 0.0);
        all.columns_mut(waves, scaled.ncols()).copy_from(&scaled);
        Basis::new(all, own)
    }

    /// The looks at the processes of others, from where these are.
    ///
    /// # Errors
    /// A model that fails.
    pub(super) fn looks_from(&self, others: &[Look]) -> Result<Vec<Look>> {
        let best = most(others.iter());
        let near = |l: &&Look| best - l.log_evidence < NEGLIGIBLE;
        let looks = parallel::try_map(others.iter().filter(near), |other| {
            self.look(other.process, &other.tangent)
        })?;
        Ok(looks.into_iter().flatten().collect())
    }

    /// The looks of the whole grid, from likely own parameters: from small
    /// sizes to large ones, where at first the errors explain what the model
    /// does not, and back, where at first the force does.
    ///
    /// # Errors
    /// A model that fails, or one that has no density near these.
    pub(super) fn looks(&self, own: &[f64], grid: Grid) -> Result<Vec<Look>> {
        let own = DVector::from_column_slice(own);
        let count = self.cells.count;
        let cells = Basis::cells(count, self.cells.own());
        let none = self.cells.tangent(&cells, &DVector::zeros(count), own)?;
        let Some(none) = none else { return Err(no_mode()) };
        let Grid { lengths, sizes, beyond } = grid;
        let mut found = self.columns(lengths, sizes, &none)?;
        for lengths in beyond {
            for pair in lengths.windows(2) {
                if matters(&found, pair[0]) {
                    let next = self.columns(&pair[1..], sizes, &none)?;
                    found.extend(next);
                }
            }
        }
        if found.is_empty() { Err(no_mode()) } else { Ok(found) }
    }

    /// The looks at some lengths, from both sides.
    fn columns(
        &self,
        lengths: &[f64],
        sizes: &[f64],
        none: &Tangent,
    ) -> Result<Vec<Look>> {
        let columns = parallel::try_map(lengths, |&length| {
            let mut up = self.along(length, sizes.iter(), none, &[])?;
            let down = self.along(length, sizes.iter().rev(), none, &up)?;
            up.extend(down);
            Ok(up)
        })?;
        Ok(columns.concat())
    }

    /// The looks at one length, each from the one before, until one is known.
    fn along<'s>(
        &self,
        length: f64,
        sizes: impl Iterator<Item = &'s f64>,
        none: &Tangent,
        known: &[Look],
    ) -> Result<Vec<Look>> {
        let mut found: Vec<Look> = Vec::new();
        for &size in sizes {
            let process = Process(length, size);
            let from = found.last().map_or(none, |look| &look.tangent);
            let Some(look) = self.look(process, from)? else { continue };
            let own = &look.tangent.own;
            if known.iter().any(|k| k.distance(&process, own) < ALIKE) {
                break;
            }
            found.push(look);
        }
        Ok(found)
    }

    /// The look at a process that a tangent leads to; `None` where the start
    /// has no density.
    fn look(&self, process: Process, from: &Tangent) -> Result<Option<Look>> {
        let ridge = Ridge {
            cells: self.cells,
            basis: self.basis(&process),
            least: f64::NEG_INFINITY,
        };
        let own = from.own.clone();
        let still = DVector::zeros(own.len());
        let from = from.along(&ridge.basis);
        let Some((slope, tangent)) = ridge.slope(&own, &still, &from)? else {
            return Ok(None);
        };
        let found =
            CLIMB.ascend(&ridge, (own, slope, tangent), |_, _| false)?;
        let Some((own, slope, tangent)) = found else { return Ok(None) };
        let Some(waves) = tangent.waves(&own) else { return Ok(None) };
        let cells = Basis::cells(self.cells.count, self.cells.own());
        let force = &ridge.basis.factor * waves.mean;
        let Some(tangent) = self.cells.tangent(&cells, &force, own)? else {
            return Ok(None);
        };
        Ok(Look::of(process, slope, tangent))
    }
}

fn no_mode() -> Error {
    Error::inference("no free-form force has a mode")
}

/// Whether the looks at a length hold nearly as much as the best.
fn matters(looks: &[Look], length: f64) -> bool {
    let there = looks.iter().filter(|look| look.process.0 == length);
    most(looks.iter()) - most(there) < NEARLY
}

/// The look with the most evidence.
pub(super) fn highest(looks: &[Look]) -> Option<&Look> {
    looks.iter().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}

/// ln of what the best of some looks holds.
fn most<'l>(looks: impl Iterator<Item = &'l Look>) -> f64 {
    let logs = looks.map(|look| look.log_evidence);
    logs.fold(f64::NEG_INFINITY, f64::max)
}

/// The density of the own parameters under one process, the force integrated.
pub(super) struct Ridge<'a, 'm> {
    pub(super) cells: Cells<'a, 'm>,
    pub(super) basis: Basis,
    /// ln of a density below which nothing counts.
    pub(super) least: f64,
}

impl Ridge<'_, '_> {
    /// A tangent at the waves that are about best at some own parameters, from
    /// one nearby, and the best waves by it; `None` where there is no density.
    ///
    /// Climbs make a tangent at each step, and draws about the best are weighed,
    /// so it is made anew only where the force is far off: else draws in the
    /// tails would count for too little. Where a further one cannot lead to
    /// what counts it is not made either.
    pub(super) fn best(
        &self,
        own: &DVector<f64>,
        from: &Tangent,
    ) -> Result<Option<(Tangent, Waves)>> {
        let Some(Waves { mut mean, .. }) = from.waves(own) else {
            return Ok(None);
        };
        let mut found: Option<(Tangent, Waves)> = None;
        for _ in 0..TANGENTS {
            let tangent =
                self.cells.tangent(&self.basis, &mean, own.clone())?;
            let Some(tangent) = tangent else { break };
            let Some(next) = tangent.waves(own) else { break };
            let gain = next.gain_from(&mean);
            let most = || tangent.height(&next) + FURTHER * gain;
            let ends = gain < NEARBY || most() < self.least;
            mean.copy_from(&next.mean);
            found = Some((tangent, next));
            if ends {
                break;
            }
        }
        Ok(found)
    }
}

impl Landscape for Ridge<'_, '_> {
    type Trace = Tangent;

    fn held(&self) -> &[usize] {
        &[]
    }

    fn slope(
        &self,
        at: &DVector<f64>,
        _step: &DVector<f64>,
        from: &Tangent,
    ) -> Result<Option<(Slope, Tangent)>> {
        Ok(self
            .best(at, from)?
            .map(|(tangent, waves)| (tangent.marginal(&waves), tangent)))
    }
}

/// Where the process and the model's parameters are likely, as the looks have
/// them.
///
/// # Errors
/// Looks without width.
pub(super) fn proposal(looks: &[Look]) -> Result<Mixture> {
    let best = most(looks.iter());
    let near = looks.iter().filter(|l| best - l.log_evidence < NEGLIGIBLE);
    let parts = near.filter_map(|look| {
        let n = look.tangent.own.len();
        let own = look.precision.clone().cholesky()?.inverse();
        let identity = DMatrix::identity(2 + n, 2 + n);
        let mut covariance = identity * SPACING.powi(2);
        covariance.view_mut((2, 2), (n, n)).copy_from(&own);
        let Process(length, size) = look.process;
        let own = look.tangent.own.iter().copied();
        let mean: Vec<f64> = [length, size].into_iter().chain(own).collect();
        // The root keeps those in whose approximation is poor.
        let weight = (0.5 * (look.log_evidence - best)).exp();
        Some((weight, DVector::from_vec(mean), covariance))
    });
    Mixture::of(parts).ok_or_else(|| {
        Error::inference("no free-form force has a mode with a width")
    })
}
