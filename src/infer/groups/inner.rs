//! What a group holds at given common coordinates.

use nalgebra::DVector;
use rand::RngExt;

use super::{Group, Grouped};
use crate::error::Result;
use crate::infer::descent::{Peak, climb_holding};
use crate::infer::log_sum_exp;
use crate::infer::mixture::Mixture;
use crate::infer::peaks::Peaks;
use crate::infer::smc::log_target;
use crate::model::{Point, Posterior, Slice};
use crate::seed::{Rng, Seed};

/// How many draws estimate what a group holds at given common coordinates.
const INNER: usize = 40;
/// How many climbs from draws of the prior look for other modes of a group
/// there, and the effective share at which its mixture is good enough.
const STARTS: usize = 4;
const SHARP: f64 = 0.3;

/// A group, its coordinates parted into common and own ones.
pub(super) struct Inner<'a> {
    group: &'a Group<'a>,
    /// Which of its coordinates are in common, and which its own.
    held: Vec<usize>,
    own: Vec<usize>,
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
    pub(super) fn shape(
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
        let mixture = search.settled(&posterior, SHARP, seed)?.mixture;
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
    pub(super) fn estimate(
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
