//! What is known of a free-form force, and the stretches in which it is not
//! zero.

use super::free_form::range;
use super::look::{Look, highest};
use super::process::{CELLS, Process};
use crate::diagnosis::evidence::fit::Fit;
use crate::draws::median;
use crate::infer::nested::Integral;
use crate::mechanism::Extent;
use crate::physics::forces::Axis;
use crate::seed::Seed;

/// A force in each cell, and a band that holds nine of ten such forces along
/// their whole length.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Band {
    /// The posterior mean in each cell \[m/s2\]; positive drives the mass.
    pub mean: Vec<f64>,
    /// The posterior sd.
    pub sd: Vec<f64>,
    /// By how many sd the band lies off the mean.
    pub width: f64,
}

impl Band {
    /// That of draws of the force in each cell.
    pub(super) fn of(draws: &[Vec<f64>]) -> Self {
        let (mean, sd) = moments(draws);
        let width = simultaneous(draws, &mean, &sd);
        Self { mean, sd, width }
    }

    /// Its lower and its upper end in each cell.
    pub(crate) fn ends(&self) -> (Vec<f64>, Vec<f64>) {
        let each = self.mean.iter().zip(&self.sd);
        let off = |s: &f64| self.width * s;
        each.map(|(m, s)| (m - off(s), m + off(s))).unzip()
    }

    /// The sign of the force where it leaves zero out, else 0.
    pub(crate) fn sign(&self, cell: usize) -> f64 {
        let mean = self.mean[cell];
        let is_clear = mean.abs() > self.width * self.sd[cell];
        if is_clear { mean.signum() } else { 0.0 }
    }
}

/// What is known of the free-form force along one axis.
#[derive(Debug, Clone)]
pub struct FreeForce {
    /// Along what.
    pub axis: Axis,
    /// The middle of each cell \[m, s or m/s\].
    pub at: Vec<f64>,
    /// The force beside the friction law: what the law could do is left to it.
    pub band: Band,
    /// The whole force, with what no recording tells from the law, where that
    /// was inferred too.
    pub whole: Option<Band>,
    /// Draws of the force beside the law.
    pub draws: Vec<Vec<f64>>,
    /// The model's own parameters, on the real line, of each draw.
    pub(crate) own: Vec<Vec<f64>>,
    /// Where it is best under each process of a grid.
    pub(in crate::diagnosis) looks: Vec<Look>,
    /// ln of its evidence over that of the model without it.
    pub log_bayes_factor: f64,
    /// The standard error of that.
    pub se: f64,
    /// The process in the median.
    pub(crate) process: Process,
}

impl FreeForce {
    /// That with the most evidence of some.
    pub(crate) fn likeliest(all: &[Self]) -> Option<&Self> {
        let known = all.iter().filter(|f| !f.log_bayes_factor.is_nan());
        known.max_by(|a, b| a.log_bayes_factor.total_cmp(&b.log_bayes_factor))
    }

    /// From what was found of the process, the model and the force.
    pub(super) fn new(
        extent: &Extent,
        axis: Axis,
        none: &Fit,
        found: &Integral<Vec<Vec<f64>>>,
        looks: Vec<Look>,
        seed: Seed,
    ) -> Self {
        let range = range(extent, axis);
        let cell = range.span / CELLS as f64;
        let at = (0..CELLS).map(|i| range.begin + (i as f64 + 0.5) * cell);
        let chosen = found.draws(seed);
        let each = chosen.iter();
        let own = |z: &[f64], n: usize| vec![z[2..].to_vec(); n];
        let draws: Vec<Vec<f64>> =
            each.clone().flat_map(|(_, forces)| (*forces).clone()).collect();
        Self {
            axis,
            at: at.collect(),
            band: Band::of(&draws),
            whole: None,
            looks,
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
    pub(in crate::diagnosis) fn middle_of_own(&self) -> Vec<f64> {
        let count = self.own.first().map_or(0, Vec::len);
        let of = |i: usize| -> Vec<f64> {
            self.own.iter().map(|own| own[i]).collect()
        };
        (0..count).map(|i| median(&of(i))).collect()
    }

    /// The model's own parameters where they are likeliest with the force, on
    /// the real line: at a peak, since medians may lie between two.
    pub(in crate::diagnosis) fn likeliest_own(&self) -> Option<&[f64]> {
        Some(highest(&self.looks)?.peak.top.line.as_slice())
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
            let sign = self.band.sign(i);
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
        let Band { mean, sd, .. } = &self.band;
        let score = |i: usize| mean[i].abs() / sd[i].max(1e-12);
        let best = (0..CELLS)
            .max_by(|&a, &b| score(a).total_cmp(&score(b)))
            .unwrap_or(0);
        let (from, to) = (self.at[best] - half, self.at[best] + half);
        Stretch { from: tidy(from), to: tidy(to) }
    }

    fn step(&self) -> f64 {
        self.at[1] - self.at[0]
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
