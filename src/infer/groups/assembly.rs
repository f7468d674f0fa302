//! A posterior to second order, put together from its groups.

use super::group::{Group, Grouped};
use crate::error::Result;
use crate::model::{
    Density, Information, Listener, Model, Point, Posterior, Weights,
};
use crate::scalar::Plain;

/// The same model as the whole, whose information costs each group no more
/// derivatives than it has coordinates.
pub(super) struct Assembly<'a> {
    whole: &'a Posterior<'a>,
    common: &'a Group<'a>,
    groups: &'a [Group<'a>],
}

impl<'a> Assembly<'a> {
    pub(super) fn new(
        grouped: &'a Grouped<'_>,
        common: &'a Group<'_>,
    ) -> Self {
        Self { whole: grouped.whole, common, groups: &grouped.groups }
    }
}

impl Model for Assembly<'_> {
    fn evaluate(
        &self,
        point: Point<'_>,
        listener: Option<&mut dyn Listener<Plain>>,
    ) -> Result<Density> {
        self.whole.model().evaluate(point, listener)
    }

    fn gradient(
        &self,
        z: &[f64],
        weights: Weights,
        gradient: &mut [f64],
    ) -> Result<Density> {
        self.whole.model().gradient(z, weights, gradient)
    }

    /// The sum of the groups', each of which counts the prior of what is in
    /// common.
    fn information(&self, z: &[f64]) -> Result<Information> {
        let mut all = Information::zero(z.len());
        for group in self.groups {
            all.add(&group.information(z)?, &group.places, 1.0);
            if all.density.rejected.is_some() {
                return Ok(all);
            }
        }
        let again = 1.0 - self.groups.len() as f64;
        let common = self.common.information(z)?;
        all.add(&common, &self.common.places, again);
        Ok(all)
    }
}

impl Group<'_> {
    /// At a place of the whole.
    fn information(&self, whole: &[f64]) -> Result<Information> {
        let z: Vec<f64> = self.places.iter().map(|&i| whole[i]).collect();
        self.posterior.information(&z)
    }
}
