//! Evidence of posteriors whose coordinates fall into groups, such as those of
//! several events: given a few that all have in common, the groups are
//! independent.
//!
//! With theta in common and eta_i of group i,
//!
//! ```text
//! Z = integral of p(theta) Z_1(theta) ... Z_n(theta),
//! Z_i(theta) = integral of p(eta_i) p(y_i | theta, eta_i).
//! ```
//!
//! With nothing in common Z is the product of what each group has alone. Else
//! theta is drawn from a mixture, as [`Peaks`] does with all coordinates, and
//! every Z_i(theta) is estimated by importance sampling of its own: a product
//! of unbiased estimates leaves the estimate of Z unbiased (Tran, Scharth,
//! Gunawan, Kohn, Brown, Hawkins 2021). A proposal for all coordinates at once
//! fails instead: with five events of four parameters each, the poor tails of
//! every one multiply.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand::seq::SliceRandom;
use rayon::prelude::*;

use super::descent::{Peak, climb_holding};
use super::importance::ImportanceSampling;
use super::mixture::Mixture;
use super::part::Part;
use super::peaks::{ENOUGH, Peaks, ROUNDS, Ridge, is_good, mixture, taught};
use super::smc::{Base, Particle, log_target, population};
use super::{Backend, Evidence, Inference, Progress, draws_of, log_sum_exp};
use crate::error::{Error, Result};
use crate::model::{Point, Posterior, Slice};
use crate::seed::{Rng, Seed};

/// Some coordinates of a posterior, as a posterior of their own.
#[derive(Debug)]
pub struct Group<'a> {
    /// Prior and data of these coordinates alone.
    pub posterior: &'a Posterior<'a>,
    /// Which coordinate of the whole each of them is.
    pub places: Vec<usize>,
}

/// A posterior with its groups.
#[derive(Debug)]
pub struct Grouped<'a> {
    /// All coordinates.
    pub whole: &'a Posterior<'a>,
    /// Those that all groups have in common, under their prior alone; `None`
    /// where there are none.
    pub common: Option<Group<'a>>,
    /// Each group, what is in common among its coordinates.
    pub groups: Vec<Group<'a>>,
}

/// The share of the draws of a round that are made of what is in common: each
/// costs a climb and [`INNER`] draws in every group.
const OUTER: usize = 2;
/// How many draws estimate what a group holds at given common coordinates.
const INNER: usize = 40;
/// At how many places of the common coordinates the groups are looked at
/// closely at the most, and how far these are apart, in widths, squared.
const REGIONS: usize = 4;
const FAR: f64 = 9.0;
/// How many climbs from draws of the prior look for other modes of a group
/// there, and the effective share at which its mixture is good enough.
const STARTS: usize = 4;
const SHARP: f64 = 0.3;
/// At how many joint draws products of groups are put together.
const JOINT: usize = 2000;

impl Peaks {
    /// Explores a posterior by its groups.
    ///
    /// # Errors
    /// As [`Backend::explore`].
    pub fn explore_groups(
        &self,
        grouped: &Grouped<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        match &grouped.common {
            None => self.product(grouped, seed, progress),
            Some(common) => self.nested(grouped, common, seed, progress),
        }
    }

    /// Groups with nothing in common: each on its own.
    fn product(
        &self,
        grouped: &Grouped<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        let found = grouped
            .groups
            .iter()
            .enumerate()
            .map(|(i, group)| {
                let seed = seed.child(i as u64);
                self.within(group).explore(group.posterior, seed, progress)
            })
            .collect::<Result<Vec<_>>>()?;
        let mut rng = seed.child(found.len() as u64).rng();
        let mut all = vec![vec![0.0; grouped.whole.dimension()]; JOINT];
        let (mut log, mut variance) = (0.0, 0.0);
        let mut warnings = Vec::new();
        for (one, group) in found.into_iter().zip(&grouped.groups) {
            let (Some(draws), Some(evidence)) = (one.draws, one.evidence)
            else {
                return Err(Error::inference("a group without evidence"));
            };
            let mut rows: Vec<&[f64]> = draws.rows().collect();
            rows.shuffle(&mut rng);
            for (whole, own) in all.iter_mut().zip(rows.iter().cycle()) {
                let places = group.places.iter();
                places.zip(*own).for_each(|(&i, x)| whole[i] = *x);
            }
            log += evidence.log;
            variance += evidence.se * evidence.se;
            warnings.extend(one.warnings);
        }
        warnings.dedup();
        let mut draws = draws_of(grouped.whole)?;
        draws.push_chain(all.concat(), None)?;
        let method = "each group by itself".to_owned();
        let evidence = Evidence { log, se: variance.sqrt(), method };
        Ok(Inference {
            draws: Some(draws),
            evidence: Some(evidence),
            warnings,
            ..Inference::default()
        })
    }

    /// The same search within a group: starts and ridges where they cross it.
    fn within(&self, group: &Group<'_>) -> Self {
        let crossing = |line: &Vec<f64>| -> Vec<f64> {
            group.places.iter().map(|&i| line[i]).collect()
        };
        let mut from: Vec<Vec<f64>> = self.from.iter().map(crossing).collect();
        from.dedup();
        let ridges = self.ridges.iter().filter_map(|ridge| {
            let place = |held| group.places.iter().position(|p| p == held);
            let held = ridge.held.iter().map(place).collect::<Option<_>>()?;
            let places = ridge.places.iter();
            let places =
                places.map(|(at, apart)| (crossing(at), apart.clone()));
            Some(Ridge { held, places: places.collect() })
        });
        Self { from, ridges: ridges.collect(), ..self.clone() }
    }

    /// Groups with something in common.
    fn nested(
        &self,
        grouped: &Grouped<'_>,
        common: &Group<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        let parts =
            self.parts(grouped.whole, &common.places, seed.child(0))?;
        let marginals: Vec<Part> =
            parts.iter().map(|part| part.marginal(&common.places)).collect();
        let mut mixture = mixture(&marginals)?;
        let inner = Inner::all(grouped, common);
        let seed = seed.child(1);
        let regions = self.regions(&parts, common, &inner, seed.child(0))?;
        progress.begin("importance sampling", None);
        let mut round = 0;
        loop {
            round += 1;
            let seed = seed.child(round);
            let base = Base::Mixture(mixture.clone());
            let count = self.draws / OUTER;
            let drawn =
                population(common.posterior, &base, count, seed.child(0))?;
            let (found, wholes): (Vec<_>, Vec<_>) = drawn
                .into_par_iter()
                .enumerate()
                .map(|(i, theta)| {
                    let mut rng = seed.child(1).child(i as u64).rng();
                    completed(theta, common, &inner, &regions, &mut rng)
                })
                .collect::<Result<Vec<(Particle, Particle)>>>()?
                .into_iter()
                .unzip();
            progress.advance(count as u64);
            if round == ROUNDS || is_good(&found, ENOUGH) {
                let (whole, seed) = (grouped.whole, seed.child(2));
                return ImportanceSampling::conclude(whole, &wholes, seed);
            }
            mixture = taught(&mixture, &found, round - 1, seed.child(3));
        }
    }

    /// The regions of the common coordinates about the parts that hold most,
    /// each with what the groups look like there.
    fn regions(
        &self,
        parts: &[Part],
        common: &Group<'_>,
        inner: &[Inner<'_>],
        seed: Seed,
    ) -> Result<Vec<Region>> {
        let mut regions: Vec<Region> = Vec::new();
        for part in parts {
            let Some(mut region) = Region::new(part, &common.places) else {
                continue;
            };
            let far = |r: &Region| r.distance(&region.middle) > FAR;
            if !regions.iter().all(far) {
                continue;
            }
            let seed = seed.child(regions.len() as u64);
            region.shapes = inner
                .iter()
                .enumerate()
                .map(|(i, group)| {
                    group.shape(self, &part.mean, seed.child(i as u64))
                })
                .collect::<Result<_>>()?;
            regions.push(region);
            if regions.len() == REGIONS {
                break;
            }
        }
        Ok(regions)
    }
}

/// A region of the common coordinates.
struct Region {
    /// The best place there, in all coordinates.
    mean: DVector<f64>,
    /// The same in the common ones, and how sharp it is.
    middle: DVector<f64>,
    precision: DMatrix<f64>,
    /// How all coordinates follow the common ones.
    gain: DMatrix<f64>,
    /// What each group looks like there.
    shapes: Vec<Option<Shape>>,
}

/// What a group's own coordinates look like at given common ones.
struct Shape {
    /// Their best place.
    mode: DVector<f64>,
    mixture: Mixture,
}

impl Region {
    /// About a part, without shapes.
    fn new(part: &Part, common: &[usize]) -> Option<Self> {
        let marginal = part.marginal(common);
        let precision = marginal.covariance.cholesky()?.inverse();
        let gain = part.covariance.select_columns(common) * &precision;
        let (mean, middle) = (part.mean.clone(), marginal.mean);
        Some(Self { mean, middle, precision, gain, shapes: Vec::new() })
    }

    /// The squared distance of common coordinates, in widths.
    fn distance(&self, theta: &DVector<f64>) -> f64 {
        let off = theta - &self.middle;
        off.dot(&(&self.precision * &off))
    }

    /// About where all coordinates are best, given the common ones.
    fn reached(&self, theta: &DVector<f64>) -> DVector<f64> {
        &self.mean + &self.gain * (theta - &self.middle)
    }
}

/// A group, its coordinates parted into common and own ones.
struct Inner<'a> {
    group: &'a Group<'a>,
    /// Which of its coordinates are in common, and which its own.
    held: Vec<usize>,
    own: Vec<usize>,
}

impl<'a> Inner<'a> {
    fn all(grouped: &'a Grouped<'_>, common: &Group<'_>) -> Vec<Self> {
        let inner = |group: &'a Group<'a>| {
            let places = &group.places;
            let of_common = |i: &usize| common.places.contains(&places[*i]);
            let (held, own): (Vec<usize>, Vec<usize>) =
                (0..places.len()).partition(of_common);
            Self { group, held, own }
        };
        grouped.groups.iter().map(inner).collect()
    }

    /// The group's coordinates at a place of the whole.
    fn at(&self, whole: &[f64]) -> Vec<f64> {
        self.group.places.iter().map(|&i| whole[i]).collect()
    }

    /// What the group looks like with the common coordinates of a place of
    /// the whole; `None` where nothing near it has a density.
    fn shape(
        &self,
        peaks: &Peaks,
        whole: &DVector<f64>,
        seed: Seed,
    ) -> Result<Option<Shape>> {
        let at = self.at(whole.as_slice());
        let Some(peak) = self.climbed(&at)? else { return Ok(None) };
        let mode = peak.line.select_rows(&self.own);
        let slice = Slice::new(self.group.posterior, &at, &self.own)?;
        let posterior = Posterior::new(&slice)?;
        let search = Peaks {
            starts: STARTS,
            from: vec![mode.as_slice().to_vec()],
            ridges: Vec::new(),
            draws: peaks.draws,
        };
        let (mixture, _) = search.settled(&posterior, SHARP, seed)?;
        Ok(Some(Shape { mode, mixture }))
    }

    /// The best place near one, with the same common coordinates.
    fn climbed(&self, at: &[f64]) -> Result<Option<Peak>> {
        climb_holding(self.group.posterior, at, &self.held)
    }

    /// About the own coordinates, given those in common: what they look like
    /// in the region, carried to where they are best here, and a normal
    /// approximation; `None` where nothing near has a density.
    fn proposal<'s>(
        &self,
        at: &[f64],
        shape: Option<&'s Shape>,
    ) -> Result<Option<Proposal<'s>>> {
        let Some(peak) = self.climbed(at)? else { return Ok(None) };
        let mode = peak.line.select_rows(&self.own);
        let precision = peak.precision.select_rows(&self.own);
        let factor = precision.select_columns(&self.own).cholesky();
        let normal = factor.map(|f| (1.0, mode.clone(), f.inverse()));
        let normal = Mixture::of(normal.into_iter());
        let carried = shape.map(|s| (&s.mixture, mode - &s.mode));
        let any = normal.is_some() || carried.is_some();
        Ok(any.then_some(Proposal { normal, carried }))
    }

    /// ln Z_i(theta), estimated, at the common coordinates of a place of the
    /// whole, `prior` being ln p(theta); the group's own coordinates of the
    /// place become a draw of theirs.
    fn estimate(
        &self,
        whole: &mut [f64],
        shape: Option<&Shape>,
        prior: f64,
        rng: &mut Rng,
    ) -> Result<f64> {
        let mut at = self.at(whole);
        let Some(proposal) = self.proposal(&at, shape)? else {
            return Ok(f64::NEG_INFINITY);
        };
        let mut logs = Vec::with_capacity(INNER);
        let mut draws = Vec::with_capacity(INNER);
        for _ in 0..INNER {
            let own = proposal.draw(rng);
            self.own.iter().zip(&own).for_each(|(&i, z)| at[i] = *z);
            let density = self.group.posterior.density(Point::Line(&at))?;
            let target = log_target(&density) - prior;
            logs.push(target - proposal.log_density(&own));
            draws.push(own);
        }
        let total = log_sum_exp(logs.iter().copied());
        let mut left = rng.random::<f64>();
        let chosen = logs.iter().position(|log| {
            left -= (log - total).exp();
            left < 0.0
        });
        for (&i, z) in self.own.iter().zip(&draws[chosen.unwrap_or(0)]) {
            whole[self.group.places[i]] = *z;
        }
        Ok(total - (INNER as f64).ln())
    }
}

/// About a group's own coordinates, given the common ones; either half of the
/// draws where there are both.
struct Proposal<'s> {
    normal: Option<Mixture>,
    /// A region's mixture, and how far it is carried.
    carried: Option<(&'s Mixture, DVector<f64>)>,
}

impl Proposal<'_> {
    fn draw(&self, rng: &mut Rng) -> Vec<f64> {
        match (&self.normal, &self.carried) {
            (Some(normal), Some(_)) if rng.random::<f64>() < 0.5 => {
                normal.draw(rng)
            }
            (_, Some((mixture, by))) => {
                let drawn = mixture.draw(rng).into_iter();
                drawn.zip(by).map(|(z, by)| z + by).collect()
            }
            (Some(normal), None) => normal.draw(rng),
            (None, None) => Vec::new(),
        }
    }

    fn log_density(&self, z: &[f64]) -> f64 {
        let normal = self.normal.as_ref().map(|m| m.log_density(z));
        let carried = self.carried.as_ref().map(|(mixture, by)| {
            let back: Vec<f64> =
                z.iter().zip(by).map(|(z, b)| z - b).collect();
            mixture.log_density(&back)
        });
        let both = normal.into_iter().chain(carried);
        let count = both.clone().count() as f64;
        log_sum_exp(both) - count.ln()
    }
}

/// A draw of the common coordinates with what all groups hold there, and the
/// same with a draw of all coordinates.
fn completed(
    theta: Particle,
    common: &Group<'_>,
    inner: &[Inner<'_>],
    regions: &[Region],
    rng: &mut Rng,
) -> Result<(Particle, Particle)> {
    let place = DVector::from_column_slice(&theta.z);
    let near = |a: &&Region, b: &&Region| {
        a.distance(&place).total_cmp(&b.distance(&place))
    };
    let Some(region) = regions.iter().min_by(near) else {
        return Err(Error::inference("no start leads to a peak"));
    };
    let mut line = region.reached(&place).as_slice().to_vec();
    for (&i, z) in common.places.iter().zip(&theta.z) {
        line[i] = *z;
    }
    let prior = theta.log_target();
    let mut held = 0.0;
    for (group, shape) in inner.iter().zip(&region.shapes) {
        if prior + held > f64::NEG_INFINITY {
            held += group.estimate(&mut line, shape.as_ref(), prior, rng)?;
        }
    }
    let z = theta.z.clone();
    Ok((theta.clone().completed(z, held), theta.completed(line, held)))
}
