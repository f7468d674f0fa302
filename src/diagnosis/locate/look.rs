//! Looks at a free-form force under a grid of processes: where the model's own
//! parameters are best, the force integrated.

use nalgebra::{DMatrix, DVector};

use super::peak::{Peak, Ridge, SPACING};
use super::process::Process;
use super::tangent::{Basis, Cells, Tangent};
use crate::error::Result;
use crate::infer::Mixture;
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
/// How much less than the best an edge holds, in ln, beyond which a grid
/// grows.
const NEARLY: f64 = 4.0;
/// Peaks that hold so much less than the best, in ln, teach nothing.
const NEGLIGIBLE: f64 = 10.0;
/// Peaks nearer than this many widths, squared, are one.
const ALIKE: f64 = 0.1;

/// A peak at one process, and what all processes may be begun from there.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Look {
    pub(super) peak: Peak,
    /// The model there, along the cells.
    pub(super) tangent: Tangent,
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
        let peaks = parallel::try_map(others, |other| {
            let ridge = self.ridge(other.peak.process);
            let from = other.tangent.along(&ridge.basis);
            Peak::climbed(&ridge, &from)
        })?;
        self.seen(peaks.into_iter().flatten().collect())
    }

    /// The looks of the whole grid, from likely own parameters: from small
    /// sizes to large ones, where at first the errors explain what the model
    /// does not, and back, where at first the force does. None where the model
    /// has no density near these.
    ///
    /// # Errors
    /// A model that fails.
    pub(super) fn looks(&self, own: &[f64], grid: Grid) -> Result<Vec<Look>> {
        let own = DVector::from_column_slice(own);
        let still = DVector::zeros(self.cells.count);
        let none = self.cells.tangent(&self.each(), &still, own)?;
        let Some(none) = none else { return Ok(Vec::new()) };
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
        self.seen(found)
    }

    /// What is seen from those peaks that hold nearly as much as the best.
    fn seen(&self, peaks: Vec<Peak>) -> Result<Vec<Look>> {
        let best = most(&peaks);
        let near = |peak: &Peak| best - peak.log_evidence < NEGLIGIBLE;
        let (near, each) = (peaks.into_iter().filter(near), self.each());
        let looks = parallel::try_map(near, |peak| {
            let own = peak.top.line.clone();
            let tangent = self.cells.tangent(&each, &peak.force, own)?;
            Ok(tangent.map(|tangent| Look { peak, tangent }))
        })?;
        Ok(looks.into_iter().flatten().collect())
    }

    /// The cells themselves as waves.
    fn each(&self) -> Basis {
        Basis::cells(self.cells.count, self.cells.own())
    }

    /// The density under a process, all of which counts.
    pub(super) fn ridge(&self, process: Process) -> Ridge<'a, 'm> {
        let basis = self.basis(&process);
        Ridge { cells: self.cells, process, basis, least: f64::NEG_INFINITY }
    }

    /// The peaks at some lengths, from both sides.
    fn columns(
        &self,
        lengths: &[f64],
        sizes: &[f64],
        none: &Tangent,
    ) -> Result<Vec<Peak>> {
        let columns = parallel::try_map(lengths, |&length| {
            let mut up = self.along(length, sizes.iter(), none, &[])?;
            let down = self.along(length, sizes.iter().rev(), none, &up)?;
            up.extend(down);
            Ok(up)
        })?;
        Ok(columns.concat())
    }

    /// The peaks at one length, each from the one before, until one is known.
    fn along<'s>(
        &self,
        length: f64,
        sizes: impl Iterator<Item = &'s f64>,
        none: &Tangent,
        known: &[Peak],
    ) -> Result<Vec<Peak>> {
        let mut found: Vec<Peak> = Vec::new();
        for &size in sizes {
            let process = Process(length, size);
            let ridge = self.ridge(process);
            let from = match found.last() {
                // Waves of one length differ in their size alone.
                Some(Peak { process: before, tangent, .. }) => {
                    tangent.scaled(process.size() / before.size())
                }
                None => none.along(&ridge.basis),
            };
            let Some(peak) = Peak::climbed(&ridge, &from)? else {
                continue;
            };
            let alike =
                |k: &Peak| k.distance(&process, &peak.top.line) < ALIKE;
            if known.iter().any(alike) {
                break;
            }
            found.push(peak);
        }
        Ok(found)
    }
}

/// Whether the peaks at a length hold nearly as much as the best.
fn matters(peaks: &[Peak], length: f64) -> bool {
    let there = peaks.iter().filter(|peak| peak.process.0 == length);
    most(peaks) - most(there) < NEARLY
}

/// The look with the most evidence.
pub(super) fn highest(looks: &[Look]) -> Option<&Look> {
    let log = |look: &Look| look.peak.log_evidence;
    looks.iter().max_by(|a, b| log(a).total_cmp(&log(b)))
}

/// ln of what the best of some peaks holds.
fn most<'l>(peaks: impl IntoIterator<Item = &'l Peak>) -> f64 {
    let logs = peaks.into_iter().map(|peak| peak.log_evidence);
    logs.fold(f64::NEG_INFINITY, f64::max)
}

/// Where the process and the model's parameters are likely, as the looks have
/// them; `None` where none has a width.
pub(super) fn proposal(looks: &[Look]) -> Option<Mixture> {
    let best = most(looks.iter().map(|look| &look.peak));
    let parts = looks.iter().filter_map(|Look { peak, .. }| {
        let n = peak.top.line.len();
        let own = peak.top.precision.clone().cholesky()?.inverse();
        let identity = DMatrix::identity(2 + n, 2 + n);
        let mut covariance = identity * SPACING.powi(2);
        covariance.view_mut((2, 2), (n, n)).copy_from(&own);
        let Process(length, size) = peak.process;
        let own = peak.top.line.iter().copied();
        let mean: Vec<f64> = [length, size].into_iter().chain(own).collect();
        // The root keeps those in whose approximation is poor.
        let weight = (0.5 * (peak.log_evidence - best)).exp();
        Some((weight, DVector::from_vec(mean), covariance))
    });
    Mixture::of(parts)
}
