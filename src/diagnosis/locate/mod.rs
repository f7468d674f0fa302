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

use rayon::prelude::*;

use crate::diagnosis::evidence::fit::Fit;
use crate::draws::{Draws, log_sum_exp, median};
use crate::error::Result;
use crate::infer::{Integral, Integration};
use crate::mechanism::Mechanism;
use crate::model::{Posterior, Program, With};
use crate::observe::Extent;
use crate::physics::forces::Axis;
use crate::seed::Seed;

use free_form::FreeForm;
pub(crate) use free_form::range;
pub(crate) use look::Process;
use look::{Sought, proposal};
use marginal::Marginal;

/// How many cells the force has.
pub const CELLS: usize = 40;
/// How many rounds of draws are made along an axis at the most, and a
/// standard error of ln evidence that is small enough.
const ROUNDS: usize = 8;
const SHARP: f64 = 0.12;
/// The prior median of the process's length \[m\], and the sd of its log.
const LENGTH: (f64, f64) = (20.0, 0.7);
/// The prior scale of the force \[m/s2\].
const SIZE: f64 = 1.0;
/// What a force of free form is called, and what it says.
pub(crate) const NOUN: &str =
    "a force that no mechanism of the catalogue describes";
pub(crate) const SAYS: &str =
    "A force that none of the mechanisms describes acts on the mass.";

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
    let mut draws = Draws::new(
        posterior.parameters().iter().map(|p| p.name.clone()).collect(),
        posterior.parameters().iter().map(|p| p.unit.clone()).collect(),
    )?;
    draws.push_chain(rows.concat(), None)?;
    let fit = Fit {
        log_evidence: none.log_evidence + force.log_bayes_factor,
        se: force.se.hypot(none.se),
        best: crate::diagnosis::evidence::fit::likeliest(&posterior, &draws)?,
        draws,
        added: CELLS,
        warnings: none.warnings.clone(),
    };
    Ok((Box::new(free), fit))
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
    let mut search = [Search::new(program, extent, axis, none, seed)?];
    sharpen(&mut search)?;
    search[0].force(none)
}

/// The same along every axis; as sharply as their mean evidence asks for.
pub(crate) fn locate_all<P: Program>(
    program: &P,
    extent: &Extent,
    none: &Fit,
    seed: Seed,
) -> Result<Vec<FreeForce>> {
    let axes = [Axis::Place, Axis::Time, Axis::Speed].into_par_iter();
    let mut all: Vec<Search<'_, P>> = axes
        .enumerate()
        .map(|(i, axis)| {
            Search::new(program, extent, axis, none, seed.child(i as u64))
        })
        .collect::<Result<_>>()?;
    sharpen(&mut all)?;
    all.iter().map(|search| search.force(none)).collect()
}

/// Draws on until the mean evidence is sharp enough, always where that gains
/// most.
fn sharpen<P: Program>(all: &mut [Search<'_, P>]) -> Result<()> {
    for _ in 0..ROUNDS * all.len() {
        let known: Vec<(f64, f64)> =
            all.iter().map(|search| search.integration.known()).collect();
        let total = log_sum_exp(known.iter().map(|(log, _)| *log));
        let errors: Vec<f64> =
            known.iter().map(|(log, se)| (log - total).exp() * se).collect();
        let all_errors = errors.iter().map(|e| e * e).sum::<f64>().sqrt();
        let open = (0..all.len())
            .filter(|&i| all[i].integration.rounds() < ROUNDS)
            .max_by(|&i, &j| errors[i].total_cmp(&errors[j]));
        match open {
            Some(i) if all_errors > SHARP => {
                let Search { marginal, integration } = &mut all[i];
                integration.go_on(marginal)?;
            }
            _ => break,
        }
    }
    Ok(())
}

/// The inference of a free-form force under way.
struct Search<'a, P> {
    marginal: Marginal<'a, P>,
    integration: Integration,
}

impl<'a, P: Program> Search<'a, P> {
    /// After the first round.
    fn new(
        program: &'a P,
        extent: &'a Extent,
        axis: Axis,
        none: &Fit,
        seed: Seed,
    ) -> Result<Self> {
        let sought = Sought { program, extent, axis };
        let looks = sought.looks(none.own())?;
        let mut integration = Integration::new(proposal(&looks)?, seed);
        let marginal = Marginal { sought, looks };
        integration.go_on(&marginal)?;
        Ok(Self { marginal, integration })
    }

    fn force(&self, none: &Fit) -> Result<FreeForce> {
        let Sought { extent, axis, .. } = self.marginal.sought;
        let found = self.integration.concluded()?;
        let factor = found.log_evidence - none.log_evidence;
        Ok(FreeForce::new(extent, axis, factor, &found))
    }
}

impl FreeForce {
    /// From what was found of the process, the model and the force.
    fn new(
        extent: &Extent,
        axis: Axis,
        log_bayes_factor: f64,
        found: &Integral,
    ) -> Self {
        let range = range(extent, axis);
        let cell = range.span / CELLS as f64;
        let at = (0..CELLS).map(|i| range.begin + (i as f64 + 0.5) * cell);
        let each = found.draws.iter();
        let own = |z: &[f64], n: usize| vec![z[2..].to_vec(); n];
        let draws: Vec<Vec<f64>> =
            each.clone().flat_map(|(_, forces)| forces.clone()).collect();
        let (mean, sd) = moments(&draws);
        Self {
            axis,
            at: at.collect(),
            width: simultaneous(&draws, &mean, &sd),
            mean,
            sd,
            own: each.clone().flat_map(|(z, f)| own(z, f.len())).collect(),
            log_bayes_factor,
            se: found.se,
            process: middle(found.draws.iter().map(|(z, _)| &z[..])),
            draws,
        }
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
