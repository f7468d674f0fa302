//! Where the mismatch is: a free-form force, inferred with the model.
//!
//! A force of unknown shape is added to the equation of motion, with a
//! Gaussian process for its prior: over distance, over time, or over speed.
//! It is a step function of [`CELLS`] cells, so the motion keeps its exact
//! solution. The square of the speed is linear in a force over distance, so
//! given the process's length and size the posterior is nearly normal: one
//! climb with the Fisher information finds it, and the evidence (Laplace)
//! weighs lengths and sizes. A speed error shows downstream of its cause;
//! the force shows where the cause is.

use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::fit::Fit;
use crate::block::List;
use crate::change::{
    Candidate, Change, Family, Mechanism, Missing, Noun, Unknown,
};
use crate::draws::{Draws, log_sum_exp};
use crate::error::{Error, Result};
use crate::infer::{Peak, climb};
use crate::model::{Posterior, Program, With};
use crate::observe::Extent;
use crate::physics::Rate;
use crate::physics::forces::{Axis, Range, STEPS, Shape, Term};
use crate::prior::{AnyPrior, LogNormal, Prior};
use crate::scalar::{Kind, Plain, Real};
use crate::seed::{Rng, Seed};

/// How many cells the force has.
pub const CELLS: usize = 40;
/// How many lengths and sizes of the process are weighed, at even quantiles
/// of their priors.
const LENGTHS: usize = 6;
const SIZES: usize = 5;
/// How many draws of the force are made.
const DRAWS: usize = 1500;
/// The prior median of the process's length \[m\], and the sd of its log.
const LENGTH: (f64, f64) = (20.0, 0.7);
/// The prior scale of the force \[m/s2\].
const SIZE: f64 = 1.0;
/// What a force of free form is called, and what it says.
pub(super) const NOUN: &str =
    "a force that no mechanism of the catalogue describes";
pub(super) const SAYS: &str =
    "A force that none of the mechanisms describes acts on the mass.";

/// A force of free form: a step function along an axis, whose values follow
/// a Gaussian process of given length and size.
#[derive(Debug, Clone)]
struct FreeForm {
    extent: Extent,
    axis: Axis,
    /// The factor of the process's covariance.
    factor: DMatrix<f64>,
}

/// The range that a free-form force covers along an axis.
pub(super) fn range(extent: &Extent, axis: Axis) -> Range {
    match axis {
        Axis::Place => Range { begin: extent.begin, span: extent.run },
        Axis::Time => Range { begin: 0.0, span: extent.duration },
        Axis::Speed => Range { begin: 0.0, span: 1.3 * extent.speed },
    }
}

impl FreeForm {
    /// The process with length and size along an axis; a length in metres
    /// stands for as large a part of the run on the other axes.
    fn new(
        extent: &Extent,
        axis: Axis,
        length: f64,
        size: f64,
    ) -> Result<Self> {
        let step = extent.run / CELLS as f64;
        let covariance = DMatrix::from_fn(CELLS, CELLS, |i, j| {
            let apart = (i as f64 - j as f64) * step / length;
            let nugget = if i == j { 1e-6 } else { 0.0 };
            size * size * ((-0.5 * apart * apart).exp() + nugget)
        });
        let factor = covariance
            .cholesky()
            .ok_or_else(|| Error::inference("no such Gaussian process"))?
            .l();
        Ok(Self { extent: *extent, axis, factor })
    }
}

impl Candidate for FreeForm {
    fn name(&self) -> &'static str {
        "unknown"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one(NOUN)
    }

    fn says(&self) -> &'static str {
        SAYS
    }

    fn unknowns(&self) -> Vec<Unknown> {
        (0..CELLS)
            .map(|i| {
                let prior = AnyPrior::Normal(0.0, 1.0);
                Unknown::new(format!("wave[{}]", i + 1), "1", prior)
            })
            .collect()
    }

    fn formula(&self) -> String {
        "+ f(s), f free".to_owned()
    }
}

impl Missing for FreeForm {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let cells: List<Real<K>> = (0..CELLS)
            .map(|i| {
                let row = values[..=i].iter().enumerate();
                row.map(|(j, x)| *x * self.factor[(i, j)]).sum()
            })
            .collect();
        let rate = Rate { constant: Real::new(-1.0), ..Rate::default() };
        let range = range(&self.extent, self.axis);
        let mut change = Change::default();
        change.forces.step = self.extent.duration / STEPS;
        change.forces.terms.push(Term {
            shape: Shape::Cells(self.axis, range, cells),
            ..Term::everywhere(rate)
        });
        change
    }
}

/// The free-form force as a mechanism of its own, with the fit of its
/// likeliest process: draws of the normal approximation.
///
/// # Errors
/// As [`locate`].
pub(super) fn free_fit<P: Program>(
    program: &P,
    extent: &Extent,
    force: &FreeForce,
    none: &Fit,
    seed: Seed,
) -> Result<(Box<dyn Mechanism>, Fit)> {
    let (length, size) = force.process;
    let free = FreeForm::new(extent, force.axis, length, size)?;
    let (peak, _) = node(program, &free, none.own())?
        .ok_or_else(|| Error::inference("no free-form force has a mode"))?;
    let with = With::new(program, &[&free]);
    let posterior = Posterior::new(&with)?;
    let mut draws = Draws::new(
        posterior.parameters().iter().map(|p| p.name.clone()).collect(),
        posterior.parameters().iter().map(|p| p.unit.clone()).collect(),
    )?;
    let mut rng = seed.rng();
    let rows = normal_draws(&peak, 400, &mut rng)
        .iter()
        .map(|line| posterior.natural(line.as_slice()))
        .collect::<Result<Vec<_>>>()?;
    draws.push_chain(rows.concat(), None)?;
    let fit = Fit {
        log_evidence: none.log_evidence + force.log_bayes_factor,
        se: none.se,
        best: peak.line.as_slice().to_vec(),
        draws,
        added: CELLS,
        warnings: Vec::new(),
    };
    Ok((Box::new(free), fit))
}

/// Draws of a peak's normal approximation, on the real line.
fn normal_draws(
    peak: &Peak,
    count: usize,
    rng: &mut Rng,
) -> Vec<DVector<f64>> {
    let Some(factor) = peak.precision.clone().cholesky() else {
        return Vec::new();
    };
    let spread = factor.l().transpose();
    let n = peak.line.len();
    (0..count)
        .filter_map(|_| {
            let z = DVector::from_fn(n, |_, _| StandardNormal.sample(rng));
            Some(&peak.line + spread.solve_upper_triangular(&z)?)
        })
        .collect()
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
    /// ln of its evidence over that of the model without it.
    pub log_bayes_factor: f64,
    /// The process's likeliest length \[m\] and size \[m/s2\].
    pub process: (f64, f64),
}

/// One length and size of the process, with its posterior.
struct Node {
    log_weight: f64,
    peak: Peak,
    factor: DMatrix<f64>,
    process: (f64, f64),
}

/// Infers a free-form force along an axis, jointly with the model's own
/// parameters; the climbs start from `own`, a place on the real line.
///
/// # Errors
/// A model that fails, or one with no density near `own`.
pub fn locate<P: Program>(
    program: &P,
    extent: &Extent,
    axis: Axis,
    own: &[f64],
    seed: Seed,
) -> Result<FreeForce> {
    let plain = With::new(program, &[]);
    let baseline = climb(&Posterior::new(&plain)?, own)?
        .and_then(|peak| peak.log_evidence())
        .ok_or_else(|| Error::inference("the model has no mode here"))?;
    let lengths = LogNormal::<Plain>::new(LENGTH.0.ln(), LENGTH.1);
    let pairs: Vec<(f64, f64)> = (0..LENGTHS)
        .flat_map(|i| (0..SIZES).map(move |j| (i, j)))
        .map(|(i, j)| {
            let length = lengths.quantile(middle(i, LENGTHS));
            let size = AnyPrior::HalfNormal(SIZE).quantile(middle(j, SIZES));
            (length.unwrap_or(LENGTH.0), size.unwrap_or(SIZE))
        })
        .collect();
    let nodes: Vec<Node> = pairs
        .into_par_iter()
        .map(|(length, size)| {
            let free = FreeForm::new(extent, axis, length, size)?;
            Ok(node(program, &free, own)?.map(|(peak, log_weight)| Node {
                log_weight,
                peak,
                factor: free.factor,
                process: (length, size),
            }))
        })
        .collect::<Result<Vec<_>>>()?
        .into_iter()
        .flatten()
        .collect();
    force(&nodes, baseline, extent, axis, seed)
}

/// The middle of the i-th of so many even parts of 0..1.
fn middle(i: usize, of: usize) -> f64 {
    (i as f64 + 0.5) / of as f64
}

fn node<P: Program>(
    program: &P,
    free: &FreeForm,
    own: &[f64],
) -> Result<Option<(Peak, f64)>> {
    let with = With::new(program, &[free]);
    let posterior = Posterior::new(&with)?;
    let start = [vec![0.0; CELLS], own.to_vec()].concat();
    let Some(peak) = climb(&posterior, &start)? else { return Ok(None) };
    Ok(peak.log_evidence().map(|log_weight| (peak, log_weight)))
}

/// Draws of the force from all nodes, and what they say.
fn force(
    nodes: &[Node],
    baseline: f64,
    extent: &Extent,
    axis: Axis,
    seed: Seed,
) -> Result<FreeForce> {
    let total = log_sum_exp(nodes.iter().map(|n| n.log_weight));
    let all = (LENGTHS * SIZES) as f64;
    let mut rng = seed.rng();
    let mut draws = Vec::with_capacity(DRAWS);
    for node in nodes {
        let share = (node.log_weight - total).exp();
        let count = (share * DRAWS as f64).round() as usize;
        for line in normal_draws(&node.peak, count, &mut rng) {
            let waves = line.rows(0, CELLS).into_owned();
            draws.push((&node.factor * waves).as_slice().to_vec());
        }
    }
    if draws.is_empty() {
        return Err(Error::inference("no free-form force has a mode"));
    }
    let range = range(extent, axis);
    let at = (0..CELLS)
        .map(|i| range.begin + middle(i, CELLS) * range.span)
        .collect();
    let (mean, sd) = moments(&draws);
    let width = simultaneous(&draws, &mean, &sd);
    let log_bayes_factor = total - all.ln() - baseline;
    let best = nodes
        .iter()
        .max_by(|a, b| a.log_weight.total_cmp(&b.log_weight))
        .map_or((LENGTH.0, SIZE), |node| node.process);
    Ok(FreeForce {
        axis,
        at,
        mean,
        sd,
        width,
        draws,
        log_bayes_factor,
        process: best,
    })
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
