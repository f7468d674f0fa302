//! Regions of the coordinates that groups have in common.

use nalgebra::{DMatrix, DVector};

use super::Group;
use super::inner::{Inner, Shape};
use crate::error::Result;
use crate::infer::part::Part;
use crate::infer::peaks::Peaks;
use crate::seed::Seed;

/// At how many places of the common coordinates the groups are looked at
/// closely at the most, and how far these are apart, in widths, squared.
const REGIONS: usize = 4;
const FAR: f64 = 9.0;

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
    fn new(part: &Part, common: &[usize]) -> Option<Self> {
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

impl Peaks {
    /// The regions of the common coordinates about the parts that hold most,
    /// each with what the groups look like there.
    pub(super) fn regions(
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
