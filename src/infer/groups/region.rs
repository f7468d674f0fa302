//! Regions of the coordinates that groups have in common.

use nalgebra::{DMatrix, DVector};

use super::group::Group;
use super::inner::{Inner, Shape};
use crate::error::Result;
use crate::infer::backends::laplace_mixture::LaplaceMixture;
use crate::infer::proposal::Component;
use crate::seed::Seed;

/// At how many places of the common coordinates the groups are looked at
/// closely at the most, and how far these are apart, in widths, squared.
const REGIONS: usize = 4;
const FAR: f64 = 9.0;
/// How much less than the best, in ln, a part may hold about which there is a
/// region of its own: a draw in two hundred is made there.
const HOLDS: f64 = 5.0;
/// From how many places within a region modes of a group are looked for.
const PLACES: usize = 6;

/// A region of the common coordinates.
pub(super) struct Region {
    /// The best place there, in all coordinates.
    mean: DVector<f64>,
    /// The same in the common ones, and how sharp it is.
    middle: DVector<f64>,
    precision: DMatrix<f64>,
    /// How all coordinates follow the common ones.
    gain: DMatrix<f64>,
    /// What each group looks like there.
    pub(super) shapes: Vec<Option<Shape>>,
}

impl Region {
    /// About a part, without shapes.
    fn new(part: &Component, common: &[usize]) -> Option<Self> {
        let marginal = part.marginal(common);
        let precision = marginal.covariance.cholesky()?.inverse();
        let gain = part.covariance.select_columns(common) * &precision;
        let (mean, middle) = (part.mean.clone(), marginal.mean);
        Some(Self { mean, middle, precision, gain, shapes: Vec::new() })
    }

    /// The squared distance of common coordinates, in widths.
    pub(super) fn distance(&self, theta: &DVector<f64>) -> f64 {
        let off = theta - &self.middle;
        off.dot(&(&self.precision * &off))
    }

    /// About where all coordinates are best, given the common ones.
    pub(super) fn reached(&self, theta: &DVector<f64>) -> DVector<f64> {
        &self.mean + &self.gain * (theta - &self.middle)
    }
}

impl LaplaceMixture {
    /// The regions of the common coordinates about the parts that hold most,
    /// each with what the groups look like there.
    pub(super) fn regions(
        &self,
        parts: &[Component],
        common: &Group<'_>,
        inner: &[Inner<'_>],
        seed: Seed,
    ) -> Result<Vec<Region>> {
        let looked_at = |(k, (mut region, places)): (usize, Around<'_>)| {
            let shapes = inner.iter().enumerate().map(|(i, group)| {
                let seed = seed.child(k as u64).child(i as u64);
                group.shape(self, &places, seed)
            });
            region.shapes = shapes.collect::<Result<_>>()?;
            Ok(region)
        };
        let regions = around(parts, &common.places);
        regions.into_iter().enumerate().map(looked_at).collect()
    }
}

/// A region with the places of the parts in it, the best first.
type Around<'p> = (Region, Vec<&'p DVector<f64>>);

/// Regions around the parts that hold most, without shapes.
fn around<'p>(parts: &'p [Component], common: &[usize]) -> Vec<Around<'p>> {
    let mut regions: Vec<Around<'p>> = Vec::new();
    let best = parts.first().map_or(0.0, |part| part.log);
    for part in parts {
        let holds = best - part.log < HOLDS;
        let Some(region) = Region::new(part, common) else { continue };
        let near = |r: &Around<'p>| r.0.distance(&region.middle) <= FAR;
        match regions.iter().position(near) {
            Some(k) if regions[k].1.len() < PLACES => {
                regions[k].1.push(&part.mean);
            }
            None if holds && regions.len() < REGIONS => {
                regions.push((region, vec![&part.mean]));
            }
            _ => {}
        }
    }
    regions
}
