//! Where the mismatch is: a free-form force, inferred with the model.
//!
//! A force of unknown shape is added to the equation of motion, with a
//! Gaussian process for its prior: over distance, over time, or over speed.
//! It is a step function of [`CELLS`] cells, so the motion keeps its exact
//! solution. The process's length and size and the model's own parameters are
//! drawn by importance sampling, the force is integrated at each draw of
//! these. A speed error shows downstream of its cause; the force shows where
//! the cause is.

mod free_form;
mod look;
mod marginal;
mod process;
mod tangent;

use rayon::prelude::*;

use crate::diagnosis::evidence::fit::{Fit, likeliest};
use crate::draws::{Draws, log_sum_exp, median};
use crate::error::Result;
use crate::infer::nested::{Effort, Integral, Learned, integrated, learn};
use crate::mechanism::{Extent, Mechanism};
use crate::model::{Posterior, Program, With};
use crate::physics::forces::Axis;
use crate::seed::Seed;

pub(super) use free_form::{FORMULA, NOUN, SAYS};
use free_form::{FreeForm, range};
use look::{COARSE, FINE, Look, Sought, proposal};
use marginal::Marginal;
pub use process::CELLS;
pub(super) use process::Process;
use tangent::Cells;

/// How many draws of the process and the model's own parameters are made.
const EFFORT: Effort =
    Effort { learning: 60, rounds: 3, last: (150, 600), error: 0.1 };
/// How many draws of the model's own parameters are told of.
const OWN: usize = 400;
/// The same along an axis whose force is far less likely than along another,
/// by so much in ln.
const FEW: Effort = Effort { last: (60, 60), ..EFFORT };
const FAR: f64 = 3.0;
/// The same where only about how much it brings is asked for.
const GLANCE: Effort =
    Effort { learning: 40, rounds: 2, last: (60, 60), ..EFFORT };

/// The free-form force as a mechanism of its own, with the fit that it has.
///
/// # Errors
/// A model that fails.
pub(crate) fn free_fit<P: Program>(
    program: &P,
    extent: &Extent,
    force: &FreeForce,
    none: &Fit,
) -> Result<(Box<dyn Mechanism>, Fit)> {
    // Any process makes any force; of this one none is far-fetched.
    let free = FreeForm::new(extent, force.axis, force.process)?;
    let with = With::new(program, &[&free]);
    let posterior = Posterior::new(&with)?;
    let lines = force.draws.iter().zip(&force.own);
    let lines: Vec<Vec<f64>> = lines
        .map(|(force, own)| Ok([free.waves(force)?, own.clone()].concat()))
        .collect::<Result<_>>()?;
    let rows = lines
        .par_iter()
        .map(|line| posterior.natural(line))
        .collect::<Result<Vec<_>>>()?;
    let mut draws = empty(&posterior)?;
    draws.push_chain(rows.concat(), None)?;
    let fit = Fit {
        log_evidence: none.log_evidence + force.log_bayes_factor,
        se: force.se.hypot(none.se),
        best: likeliest(&posterior, &draws)?,
        draws,
        added: CELLS,
        warnings: none.warnings.clone(),
    };
    Ok((Box::new(free), fit))
}

/// Draws of the model's own parameters with a force of free form in it, along
/// each axis as often as it is probable.
///
/// # Errors
/// A model that fails.
pub(crate) fn own_draws<P: Program>(
    program: &P,
    forces: &[FreeForce],
) -> Result<Draws> {
    let with = With::new(program, &[]);
    let posterior = Posterior::new(&with)?;
    let total = log_sum_exp(forces.iter().map(|f| f.log_bayes_factor));
    let of = |force: &FreeForce| -> Result<Vec<Vec<f64>>> {
        let share = (force.log_bayes_factor - total).exp();
        let count = (share * OWN as f64).round() as usize;
        // Even draws in any order: every so-manyth is a share of all.
        let every = (0..count).map(|i| i * force.spread.len() / count);
        every.map(|i| posterior.natural(&force.spread[i])).collect()
    };
    let rows = forces.iter().map(of).collect::<Result<Vec<_>>>()?.concat();
    let mut draws = empty(&posterior)?;
    draws.push_chain(rows.concat(), None)?;
    Ok(draws)
}

fn empty(posterior: &Posterior<'_>) -> Result<Draws> {
    let parameters = posterior.parameters().iter();
    Draws::new(
        parameters.clone().map(|p| p.name.clone()).collect(),
        parameters.map(|p| p.unit.clone()).collect(),
    )
}

/// What is known of the free-form force along one axis.
#[derive(Debug, Clone)]
pub struct FreeForce {
    /// Along what.
    pub axis: Axis,
    /// The middle of each cell \[m, s or m/s\].
    pub at: Vec<f64>,
    /// Its posterior mean in each cell \[m/s2\]; positive drives the mass.
    pub mean: Vec<f64>,
    /// Its posterior sd.
    pub sd: Vec<f64>,
    /// By how many sd the simultaneous 90 % band lies off the mean.
    pub width: f64,
    /// Draws of the whole force.
    pub draws: Vec<Vec<f64>>,
    /// The model's own parameters, on the real line, of each draw.
    pub(crate) own: Vec<Vec<f64>>,
    /// The same of draws by weights that are cut, [`OWN`] of them.
    pub(crate) spread: Vec<Vec<f64>>,
    /// ln of its evidence over that of the model without it.
    pub log_bayes_factor: f64,
    /// The standard error of that.
    pub se: f64,
    /// The process in the median.
    pub(crate) process: Process,
}

/// Infers a free-form force along an axis, jointly with the model's own
/// parameters, next to the fit `none` of the model without it.
///
/// # Errors
/// A model that fails, or one with no density where `none` has it.
pub fn locate<P: Program>(
    program: &P,
    extent: &Extent,
    axis: Axis,
    none: &Fit,
    seed: Seed,
) -> Result<FreeForce> {
    locate_all(program, extent, &[axis], none, seed)
        .map(|mut all| all.remove(0))
}

/// About what a free-form force brings.
#[derive(Debug, Clone)]
pub(crate) struct Outlook {
    /// About ln of the evidence with it.
    pub(crate) log: f64,
    /// The model's own parameters where it is likeliest, on the real line.
    pub(crate) own: Vec<f64>,
}

/// About what a free-form force over distance brings to a model whose own
/// parameters may be likely at some places, on the real line: from few draws,
/// about the best of these.
///
/// # Errors
/// As [`locate`].
pub(crate) fn outlook<P: Program>(
    program: &P,
    extent: &Extent,
    owns: &[Vec<f64>],
    seed: Seed,
) -> Result<Outlook> {
    let form = FreeForm::cells(extent, Axis::Place);
    let with = With::new(program, &[&form]);
    let posterior = Posterior::new(&with)?;
    let sought = Sought { cells: Cells(&posterior), extent };
    let mut looks: Vec<Look> = Vec::new();
    for own in owns {
        let others = sought.looks(own, COARSE)?;
        let log = |all: &[Look]| highest(all).map(|look| look.log_evidence);
        if looks.is_empty() || log(&others) > log(&looks) {
            looks = others;
        }
    }
    let own = highest(&looks)
        .map_or_else(Vec::new, |look| look.tangent.own.as_slice().to_vec());
    let mixture = proposal(&looks)?;
    let marginal = Marginal { sought, looks, shared: program.events() > 1 };
    let learned = learn(&marginal, mixture, GLANCE, seed.child(0))?;
    let found = integrated(&marginal, &learned, GLANCE, seed.child(1))?;
    Ok(Outlook { log: found.sum.log, own })
}

/// The look with the most evidence.
fn highest(looks: &[Look]) -> Option<&Look> {
    looks.iter().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}

/// A force of free form over distance on top of a model with mechanisms that
/// are fitted: what is left beside them.
///
/// # Errors
/// As [`locate`].
pub(crate) fn left<P: Program>(
    program: &P,
    mechanisms: &[&dyn Mechanism],
    fit: &Fit,
    extent: &Extent,
    seed: Seed,
) -> Result<FreeForce> {
    let with = With::new(program, mechanisms);
    let whole = Fit { added: 0, ..fit.clone() };
    locate(&with, extent, Axis::Place, &whole, seed)
}

/// The same along several axes; most sharply where the force is likely.
///
/// # Errors
/// As [`locate`].
pub(crate) fn locate_all<P: Program>(
    program: &P,
    extent: &Extent,
    axes: &[Axis],
    none: &Fit,
    seed: Seed,
) -> Result<Vec<FreeForce>> {
    let forms: Vec<FreeForm> =
        axes.iter().map(|axis| FreeForm::cells(extent, *axis)).collect();
    let with: Vec<With<'_, P>> =
        forms.iter().map(|form| With::new(program, &[form])).collect();
    let posteriors = with.iter().map(|with| Posterior::new(with));
    let posteriors = posteriors.collect::<Result<Vec<_>>>()?;
    let shared = program.events() > 1;
    let learned = posteriors
        .par_iter()
        .enumerate()
        .map(|(i, posterior)| {
            let sought = Sought { cells: Cells(posterior), extent };
            let looks = sought.looks(none.own(), FINE)?;
            let mixture = proposal(&looks)?;
            let marginal = Marginal { sought, looks, shared };
            let seed = seed.child(i as u64).child(0);
            let learned = learn(&marginal, mixture, EFFORT, seed)?;
            Ok((marginal, learned))
        })
        .collect::<Result<Vec<(Marginal<'_, '_>, Learned)>>>()?;
    let logs = learned.iter().map(|(_, learned)| learned.log);
    let best = logs.fold(f64::NEG_INFINITY, f64::max);
    learned
        .par_iter()
        .zip(axes)
        .enumerate()
        .map(|(i, ((marginal, learned), axis))| {
            let far = learned.log < best - FAR;
            let effort = if far { FEW } else { EFFORT };
            let seed = seed.child(i as u64);
            let found = integrated(marginal, learned, effort, seed.child(1))?;
            Ok(FreeForce::new(extent, *axis, none, &found, seed.child(2)))
        })
        .collect()
}

impl FreeForce {
    /// From what was found of the process, the model and the force.
    fn new(
        extent: &Extent,
        axis: Axis,
        none: &Fit,
        found: &Integral<Vec<Vec<f64>>>,
        seed: Seed,
    ) -> Self {
        let range = range(extent, axis);
        let cell = range.span / CELLS as f64;
        let at = (0..CELLS).map(|i| range.begin + (i as f64 + 0.5) * cell);
        let chosen = found.draws(seed);
        let spread = found.spread(OWN, seed.child(1)).into_iter();
        let each = chosen.iter();
        let own = |z: &[f64], n: usize| vec![z[2..].to_vec(); n];
        let draws: Vec<Vec<f64>> =
            each.clone().flat_map(|(_, forces)| (*forces).clone()).collect();
        let (mean, sd) = moments(&draws);
        Self {
            axis,
            at: at.collect(),
            width: simultaneous(&draws, &mean, &sd),
            mean,
            sd,
            spread: spread.map(|z| z[2..].to_vec()).collect(),
            own: each.clone().flat_map(|(z, f)| own(z, f.len())).collect(),
            log_bayes_factor: found.sum.log - none.log_evidence,
            se: found.sum.se,
            process: middle(each.map(|(z, _)| *z)),
            draws,
        }
    }
}

impl FreeForce {
    /// The medians of the model's own parameters with the force, on the real
    /// line.
    pub(super) fn middle_of_own(&self) -> Vec<f64> {
        let count = self.own.first().map_or(0, Vec::len);
        let of = |i: usize| -> Vec<f64> {
            self.own.iter().map(|own| own[i]).collect()
        };
        (0..count).map(|i| median(&of(i))).collect()
    }
}

/// The median length and the median size.
fn middle<'z>(places: impl Iterator<Item = &'z [f64]>) -> Process {
    let all: Vec<Process> = places.map(|z| Process::parted(z).0).collect();
    let of = |part: fn(&Process) -> f64| {
        median(&all.iter().map(part).collect::<Vec<_>>())
    };
    Process(of(|p| p.0), of(|p| p.1))
}

fn moments(draws: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
    let n = draws.len() as f64;
    (0..CELLS)
        .map(|i| {
            let mean = draws.iter().map(|d| d[i]).sum::<f64>() / n;
            let off = draws.iter().map(|d| (d[i] - mean).powi(2));
            (mean, (off.sum::<f64>() / n).sqrt())
        })
        .unzip()
}

/// The 90 % quantile of the largest deviate along a draw.
fn simultaneous(draws: &[Vec<f64>], mean: &[f64], sd: &[f64]) -> f64 {
    let mut largest: Vec<f64> = draws
        .iter()
        .map(|draw| {
            (0..CELLS)
                .map(|i| (draw[i] - mean[i]).abs() / sd[i].max(1e-12))
                .fold(0.0, f64::max)
        })
        .collect();
    largest.sort_by(f64::total_cmp);
    largest[(0.9 * (largest.len() - 1) as f64) as usize]
}

/// A border between cells without its round-off: to a micrometre.
fn tidy(x: f64) -> f64 {
    (x * 1e6).round() / 1e6 + 0.0
}

/// A stretch of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Where it begins and ends, along the force's axis.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
}

impl FreeForce {
    /// The stretches of one sign in which the simultaneous band leaves zero
    /// out.
    pub fn runs(&self) -> Vec<Stretch> {
        let half = 0.5 * self.step();
        let mut runs: Vec<(f64, Stretch)> = Vec::new();
        for i in 0..CELLS {
            let sign = self.sign(i);
            if sign == 0.0 {
                continue;
            }
            let (from, to) =
                (tidy(self.at[i] - half), tidy(self.at[i] + half));
            match runs.last_mut() {
                Some((before, run))
                    if *before == sign && from - run.to < half =>
                {
                    run.to = to;
                }
                _ => runs.push((sign, Stretch { from, to })),
            }
        }
        runs.into_iter().map(|(_, run)| run).collect()
    }

    /// The cell with the largest mean for its sd, as a stretch.
    pub fn strongest(&self) -> Stretch {
        let half = 0.5 * self.step();
        let score = |i: usize| self.mean[i].abs() / self.sd[i].max(1e-12);
        let best = (0..CELLS)
            .max_by(|&a, &b| score(a).total_cmp(&score(b)))
            .unwrap_or(0);
        let (from, to) = (self.at[best] - half, self.at[best] + half);
        Stretch { from: tidy(from), to: tidy(to) }
    }

    fn step(&self) -> f64 {
        self.at[1] - self.at[0]
    }

    /// The sign of the force where its band leaves zero out, else 0.
    fn sign(&self, i: usize) -> f64 {
        if self.mean[i].abs() > self.width * self.sd[i] {
            self.mean[i].signum()
        } else {
            0.0
        }
    }

    /// Each draw's mean force over a stretch \[m/s2\].
    pub fn over(&self, stretch: Stretch) -> Vec<f64> {
        let half = 0.5 * self.step();
        let shares: Vec<f64> = self
            .at
            .iter()
            .map(|x| {
                let from = stretch.from.max(x - half);
                (stretch.to.min(x + half) - from).max(0.0)
            })
            .collect();
        let total: f64 = shares.iter().sum::<f64>().max(1e-12);
        let mean = |draw: &Vec<f64>| {
            let parts = draw.iter().zip(&shares).map(|(f, w)| f * w);
            parts.sum::<f64>() / total
        };
        self.draws.iter().map(mean).collect()
    }
}

#[cfg(test)]
mod tests;
