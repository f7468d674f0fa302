//! What a group holds at given common coordinates.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;

use super::group::{Group, Grouped};
use crate::error::Result;
use crate::infer::backends::laplace_mixture::LaplaceMixture;
use crate::infer::climb::{Held, Peak, climb_holding};
use crate::infer::log_sum_exp;
use crate::infer::proposal::Mixture;
use crate::infer::proposal::{PRIOR_SHARE, blended, log_target};
use crate::infer::schedule::Schedule;
use crate::infer::search::SearchSpace;
use crate::infer::weights::systematic;
use crate::model::{Point, Posterior, Slice, unit_directions};
use crate::seed::{Rng, Seed};

/// How many draws estimate what a group holds at given common coordinates. The
/// relative variance of one is 0.7 to 1.4 in the median, that of a draw of what
/// is in common 1.5 and more: more of them would cost more than they sharpen
/// (docs/record/speed-tried.md).
const INNER: usize = 16;
/// How many climbs from draws of the prior look for other modes of a group
/// there, and the effective share at which its mixture is good enough.
const STARTS: usize = 4;
const SHARP: f64 = 0.3;
/// The draws of early and of late rounds that teach that mixture: a third and a
/// quarter of the usual, since no more than a few draws at a time are made of it.
const EARLY: usize = 200;
const LATE: usize = 500;
/// The most rounds.
const LEARNED: u64 = 4;
/// The most steps to where a group is best at given common coordinates, from
/// where a region's normal approximation has it: five cost 7 % more CPU, with the
/// same evidences (docs/record/speed-tried.md).
const FEW: usize = 2;

/// A group, its coordinates parted into common and own ones.
pub(super) struct Inner<'a> {
    group: &'a Group<'a>,
    /// Which of its coordinates are in common, and which its own.
    held: Vec<usize>,
    own: Vec<usize>,
    /// The own ones as directions.
    free: DMatrix<f64>,
}

impl<'a> Inner<'a> {
    pub(super) fn all(
        grouped: &'a Grouped<'_>,
        common: &Group<'_>,
    ) -> Vec<Self> {
        let inner = |group: &'a Group<'a>| {
            let places = &group.places;
            let of_common = |i: &usize| common.places.contains(&places[*i]);
            let (held, own): (Vec<usize>, Vec<usize>) =
                (0..places.len()).partition(of_common);
            let free = unit_directions(&own, places.len());
            Self { group, held, own, free }
        };
        grouped.groups.iter().map(inner).collect()
    }

    /// The group's coordinates at a place of the whole.
    fn at(&self, whole: &[f64]) -> Vec<f64> {
        self.group.places.iter().map(|&i| whole[i]).collect()
    }

    /// What the group looks like with the common coordinates of the first of
    /// some places of the whole, from all of which modes are looked for;
    /// `None` where nothing near it has a density.
    pub(super) fn shape(
        &self,
        laplace: &LaplaceMixture,
        places: &[&DVector<f64>],
        seed: Seed,
    ) -> Result<Option<Shape>> {
        let all = places.iter().map(|place| self.at(place.as_slice()));
        let all: Vec<Vec<f64>> = all.collect();
        let Some(peak) = self.climbed(&all[0])? else { return Ok(None) };
        let (mode, normal) = self.normal(&peak);
        if normal.is_none() {
            return Ok(None);
        }
        let slice = Slice::new(self.group.posterior, &all[0], &self.own)?;
        let posterior = Posterior::new(&slice)?;
        let own = |at: &Vec<f64>| self.own.iter().map(|&i| at[i]).collect();
        let mut from: Vec<Vec<f64>> = all.iter().map(own).collect();
        from.push(mode.as_slice().to_vec());
        let space = SearchSpace {
            prior_starts: STARTS,
            starts: from,
            grids: Vec::new(),
        };
        let schedule = Schedule {
            good_share: SHARP,
            learning_draws: EARLY,
            judging_draws: LATE,
            rounds: LEARNED,
            ..laplace.schedule
        };
        let search = LaplaceMixture { space, schedule };
        let mixture = search.frozen(&posterior, seed)?.mixture;
        Ok(Some(Shape { mode, mixture }))
    }

    /// The own coordinates of a peak, and its normal approximation in them.
    fn normal(&self, peak: &Peak) -> (DVector<f64>, Option<Mixture>) {
        let mode = peak.line.select_rows(&self.own);
        let precision = peak.precision.select_rows(&self.own);
        let factor = precision.select_columns(&self.own).cholesky();
        let part = factor.map(|f| (1.0, mode.clone(), f.inverse()));
        (mode, Mixture::of(part.into_iter()))
    }

    /// The best place near one, with the same common coordinates.
    fn climbed(&self, at: &[f64]) -> Result<Option<Peak>> {
        let landscape = Held {
            free: Some(&self.free),
            ..Held::new(self.group.posterior, &self.held)
        };
        climb_holding(&landscape, at, FEW)
    }

    /// About the own coordinates, given those in common: what they look like
    /// in the region, carried to where they are best here, and a normal
    /// approximation; neither where nothing near has a density.
    fn proposal<'s>(
        &self,
        at: &[f64],
        shape: Option<&'s Shape>,
    ) -> Result<Proposal<'s>> {
        let mut peak = self.climbed(at)?;
        if let (None, Some(shape)) = (&peak, shape) {
            let mut start = at.to_vec();
            self.put(shape.mode.as_slice(), &mut start);
            peak = self.climbed(&start)?;
        }
        let found = peak.map(|peak| self.normal(&peak));
        let by = |shape: &Shape| match &found {
            Some((mode, _)) => mode - &shape.mode,
            None => DVector::zeros(self.own.len()),
        };
        let carried = shape.map(|shape| (&shape.mixture, by(shape)));
        let normal = found.and_then(|(_, normal)| normal);
        Ok(Proposal { normal, carried })
    }

    /// Puts own coordinates into the group's.
    fn put(&self, own: &[f64], at: &mut [f64]) {
        self.own.iter().zip(own).for_each(|(&i, z)| at[i] = *z);
    }

    /// ln Z_i(theta), estimated, at the common coordinates of a place of the
    /// whole, `prior` being ln p(theta); the group's own coordinates of the
    /// place become a draw of theirs.
    pub(super) fn estimate(
        &self,
        whole: &mut [f64],
        shape: Option<&Shape>,
        prior: f64,
        rng: &mut Rng,
    ) -> Result<f64> {
        let mut at = self.at(whole);
        let proposal = self.proposal(&at, shape)?;
        let mut logs = Vec::with_capacity(INNER);
        let mut draws = Vec::with_capacity(INNER);
        for _ in 0..INNER {
            // A draw of the prior that is cut short counts as nothing.
            let Some(own) = self.draw(&proposal, &at, rng)? else { continue };
            self.put(&own, &mut at);
            logs.push(self.log_weight(&proposal, &at, &own, prior)?);
            draws.push(own);
        }
        let total = log_sum_exp(logs.iter().copied());
        if total == f64::NEG_INFINITY {
            return Ok(total);
        }
        let weights: Vec<f64> =
            logs.iter().map(|log| (log - total).exp()).collect();
        let chosen = &draws[systematic(&weights, 1, rng)[0]];
        for (&i, z) in self.own.iter().zip(chosen) {
            whole[self.group.places[i]] = *z;
        }
        Ok(total - (INNER as f64).ln())
    }

    /// Own coordinates from a proposal, or from the prior given those in common
    /// of a place, so that no place is out of reach; `None` for a draw of the
    /// prior that is cut short.
    fn draw(
        &self,
        proposal: &Proposal<'_>,
        at: &[f64],
        rng: &mut Rng,
    ) -> Result<Option<Vec<f64>>> {
        if rng.random::<f64>() >= proposal.prior_share() {
            return Ok(Some(proposal.draw(rng)));
        }
        let posterior = self.group.posterior;
        // A run that is rejected ends before its last own parameters.
        let mut known = posterior.natural(at)?;
        known.resize(at.len(), f64::NAN);
        self.own.iter().for_each(|&i| known[i] = f64::NAN);
        if self.held.iter().any(|&i| known[i].is_nan()) {
            return Ok(None);
        }
        let found = posterior.draw_place_given(&known, rng)?;
        Ok(found.map(|line| self.own.iter().map(|&i| line[i]).collect()))
    }

    /// ln of the importance weight of own coordinates, in a place of the
    /// group's.
    fn log_weight(
        &self,
        proposal: &Proposal<'_>,
        at: &[f64],
        own: &[f64],
        prior: f64,
    ) -> Result<f64> {
        let density = self.group.posterior.density(Point::Line(at))?;
        let target = log_target(&density);
        if target == f64::NEG_INFINITY {
            return Ok(target);
        }
        let before = density.log_prior + density.log_jacobian - prior;
        let fitted = proposal.log_density(own);
        let base = blended(proposal.prior_share(), before, fitted);
        Ok(target - prior - base)
    }
}

/// What a group's own coordinates look like at given common ones.
pub(super) struct Shape {
    /// Their best place.
    mode: DVector<f64>,
    mixture: Mixture,
}

/// About a group's own coordinates, given the common ones; either half of the
/// draws where there are both.
struct Proposal<'s> {
    normal: Option<Mixture>,
    /// A region's mixture, and how far it is carried.
    carried: Option<(&'s Mixture, DVector<f64>)>,
}

impl Proposal<'_> {
    /// How much is drawn from the prior instead.
    fn prior_share(&self) -> f64 {
        let none = self.normal.is_none() && self.carried.is_none();
        if none { 1.0 } else { PRIOR_SHARE }
    }

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
        match both.clone().count() {
            0 => f64::NEG_INFINITY,
            count => log_sum_exp(both) - (count as f64).ln(),
        }
    }
}
