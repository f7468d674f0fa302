//! Evidence from all the peaks: many climbs, a mixture of what they find, and
//! importance sampling that corrects it.
//!
//! Where a posterior is a few peaks of nearly normal shape, as that of a
//! mechanism whose place is unknown, climbing from many starts finds them all
//! for a hundredth of what a population led from the prior costs. Along
//! coordinates that the data tell little of it is no peak but a [`Ridge`]:
//! there the climbs keep to given places, and each leaves a component as wide
//! as its neighbours are far. The normal approximations make a mixture whose
//! weights are learned from a first round of draws; importance sampling, with
//! a share of the prior, corrects it; and where its weights stay poor,
//! tempering from the mixture does the rest.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::descent::{Peak, climb, climb_holding};
use super::importance::{ImportanceSampling, normalised};
use super::mixture::Mixture;
use super::smc::{Base, Particle, Smc, population};
use super::{Backend, Inference, Progress};
use crate::draws::psis;
use crate::error::{Error, Result};
use crate::model::Posterior;
use crate::seed::Seed;

/// Importance sampling from the mixture of all peaks and ridges.
#[derive(Debug, Clone, PartialEq)]
pub struct Peaks {
    /// How many climbs start from draws of the prior.
    pub starts: usize,
    /// Further starts, on the real line.
    pub from: Vec<Vec<f64>>,
    /// Coordinates along which there may be no peak.
    pub ridges: Vec<Ridge>,
    /// How many importance draws are made in a round.
    pub draws: usize,
}

impl Default for Peaks {
    fn default() -> Self {
        let (from, ridges) = (Vec::new(), Vec::new());
        Self { starts: 24, from, ridges, draws: 2000 }
    }
}

/// Places along some of the coordinates, to be kept to.
#[derive(Debug, Clone, PartialEq)]
pub struct Ridge {
    /// Which coordinates.
    pub held: Range<usize>,
    /// The places, on the real line in all coordinates, with how far the next
    /// ones lie along the held ones.
    pub places: Vec<(Vec<f64>, Vec<f64>)>,
}

/// Peaks and places that hold so much less than the best, in ln, are left to
/// the prior's share.
const LEAST: f64 = 10.0;
/// Peaks nearer than this many widths, squared, are one.
const ONE: f64 = 1.0;
/// An effective share that is enough with a Pareto tail index below 0.7, and
/// one that is enough with an index below 1: there few draws carry the tail,
/// and the evidence is off by less than 0.1.
const ENOUGH: f64 = 0.05;
const AMPLE: f64 = 0.15;
/// Rounds of importance sampling before tempering takes over.
const ROUNDS: u64 = 4;
/// Steps of a climb along a ridge, which begins nearby.
const FEW: usize = 8;

/// A normal approximation of a part of the posterior.
struct Part {
    /// About what it holds, in ln.
    log: f64,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Part {
    fn new(peak: &Peak, precision: DMatrix<f64>) -> Option<Self> {
        let factor = precision.cholesky()?;
        let log_det: f64 = factor.l_dirty().diagonal().map(f64::ln).sum();
        Some(Self {
            log: peak.height - log_det,
            mean: peak.line.clone(),
            covariance: factor.inverse(),
        })
    }

    /// About a peak.
    fn of_peak(peak: &Peak) -> Option<Self> {
        Self::new(peak, peak.precision.clone())
    }

    /// About a place on a ridge: as wide as the next ones are far along the
    /// held coordinates, the others following as the precision tells.
    fn of_place(
        peak: &Peak,
        held: &Range<usize>,
        apart: &[f64],
    ) -> Option<Self> {
        let n = peak.line.len();
        let free: Vec<usize> = (0..n).filter(|i| !held.contains(i)).collect();
        let kept: Vec<usize> = held.clone().collect();
        let mut joint = peak.precision.clone();
        let inner = joint.select_rows(&free).select_columns(&free);
        let across = joint.select_rows(&free).select_columns(&kept);
        let follows = across.tr_mul(&inner.cholesky()?.solve(&across));
        for (i, &row) in kept.iter().enumerate() {
            for (j, &column) in kept.iter().enumerate() {
                joint[(row, column)] = follows[(i, j)];
            }
            joint[(row, row)] += 1.0 / apart[i].powi(2);
        }
        Self::new(peak, joint)
    }
}

impl Backend for Peaks {
    fn name(&self) -> &'static str {
        "peaks"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        posterior.require_proper("the mixture of peaks")?;
        let mut parts = self.parts_of_peaks(posterior, seed.child(0))?;
        parts.extend(self.parts_of_ridges(posterior)?);
        let mut mixture = mixture(parts)?;
        progress.begin("importance sampling", None);
        for round in 0..ROUNDS {
            let seed = seed.child(1 + round);
            let base = Base::Mixture(mixture.clone());
            let found =
                population(posterior, &base, self.draws, seed.child(0))?;
            progress.advance(found.len() as u64);
            if is_good(&found) {
                return ImportanceSampling::conclude(
                    posterior,
                    &found,
                    seed.child(1),
                );
            }
            let weights = tempered(&found);
            let places = found.iter().map(|p| p.z.as_slice());
            mixture = mixture.reweighted(places.zip(weights));
        }
        let base = Base::Mixture(mixture);
        let particles = self.draws / 4;
        let smc = Smc { particles, moves: 3.0, ..Smc::default() };
        smc.passage_of(posterior, base, seed.child(100), progress)
    }
}

impl Peaks {
    /// About the log evidence, from the normal approximations of the peaks
    /// alone.
    ///
    /// # Errors
    /// What no other parameter values would mend.
    pub fn outlook(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
    ) -> Result<f64> {
        let parts = self.parts_of_peaks(posterior, seed)?;
        let half = 0.5 * posterior.dimension() as f64;
        let scale = half * std::f64::consts::TAU.ln();
        let logs: Vec<f64> = parts.iter().map(|p| p.log + scale).collect();
        Ok(super::log_sum_exp(logs.iter().copied()))
    }

    /// The peaks that all starts lead to.
    fn parts_of_peaks(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
    ) -> Result<Vec<Part>> {
        let drawn = (0..self.starts)
            .into_par_iter()
            .map(|i| likely(posterior, seed.child(i as u64)))
            .collect::<Result<Vec<_>>>()?;
        let mut peaks: Vec<Peak> = self
            .from
            .par_iter()
            .chain(&drawn)
            .map(|start| climb(posterior, start))
            .collect::<Result<Vec<_>>>()?
            .into_iter()
            .flatten()
            .collect();
        peaks.sort_by(|a, b| b.height.total_cmp(&a.height));
        let mut apart: Vec<Peak> = Vec::new();
        for peak in peaks {
            if apart.iter().all(|kept| kept.distance(&peak.line) > ONE) {
                apart.push(peak);
            }
        }
        Ok(apart.iter().filter_map(Part::of_peak).collect())
    }

    fn parts_of_ridges(&self, posterior: &Posterior<'_>) -> Result<Vec<Part>> {
        let mut parts = Vec::new();
        for Ridge { held, places } in &self.ridges {
            let found = places
                .par_iter()
                .map(|(start, apart)| {
                    let held = held.clone();
                    let peak =
                        climb_holding(posterior, start, held.clone(), FEW)?;
                    Ok(peak.and_then(|p| Part::of_place(&p, &held, apart)))
                })
                .collect::<Result<Vec<_>>>()?;
            parts.extend(found.into_iter().flatten());
        }
        Ok(parts)
    }
}

/// The likeliest of a few draws from the prior.
fn likely(posterior: &Posterior<'_>, seed: Seed) -> Result<Vec<f64>> {
    let mut rng = seed.rng();
    let mut best = (f64::NEG_INFINITY, Vec::new());
    for _ in 0..8 {
        let (density, found) = posterior.draw_prior(&mut rng)?;
        let whole = found.line.len() == posterior.dimension();
        if whole && (best.1.is_empty() || density.log_likelihood > best.0) {
            best = (density.log_likelihood, found.line);
        }
    }
    Ok(best.1)
}

/// The mixture of the parts, each weighing about what it holds: the square
/// root keeps those in whose approximation is poor.
fn mixture(mut parts: Vec<Part>) -> Result<Mixture> {
    parts.sort_by(|a, b| b.log.total_cmp(&a.log));
    let best = parts.first().map_or(0.0, |part| part.log);
    let kept =
        parts.into_iter().filter(|part| best - part.log < LEAST).map(|part| {
            let weight = (0.5 * (part.log - best)).exp();
            (weight, part.mean, part.covariance)
        });
    Mixture::of(kept).ok_or_else(|| {
        Error::inference(
            "no start leads to a peak: prior and recording contradict each \
             other",
        )
    })
}

/// Weights with the largest cut (Ionides 2008), so that no single draw
/// teaches the mixture.
fn tempered(found: &[Particle]) -> Vec<f64> {
    let most = 1.0 / (found.len() as f64).sqrt();
    let cut: Vec<f64> =
        normalised(found).iter().map(|w| w.min(most)).collect();
    let total: f64 = cut.iter().sum();
    cut.into_iter().map(|w| w / total).collect()
}

fn is_good(found: &[Particle]) -> bool {
    let logs: Vec<f64> = found.iter().map(Particle::log_weight).collect();
    let once = super::log_sum_exp(logs.iter().copied());
    let twice = super::log_sum_exp(logs.iter().map(|l| 2.0 * l));
    let share = (2.0 * once - twice).exp() / logs.len() as f64;
    let (_, k) = psis(&logs);
    (share > ENOUGH && k < 0.7) || (share > AMPLE && k < 1.0)
}
