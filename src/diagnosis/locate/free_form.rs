//! A force of free form: a step function whose values follow a Gaussian
//! process.

use nalgebra::{DMatrix, DVector};

use super::look::Process;
use super::{CELLS, NOUN, SAYS};
use crate::block::List;
use crate::diagnosis::hypothesis::UNKNOWN;
use crate::error::{Error, Result};
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::observe::Extent;
use crate::physics::Rate;
use crate::physics::forces::{Axis, Range, STEPS, Shape, Term};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A force of free form: a step function along an axis, whose values follow
/// a Gaussian process of given length and size.
#[derive(Debug, Clone)]
pub(super) struct FreeForm {
    extent: Extent,
    axis: Axis,
    /// The factor of the process's covariance.
    factor: DMatrix<f64>,
}

/// The range that a free-form force covers along an axis.
pub(crate) fn range(extent: &Extent, axis: Axis) -> Range {
    match axis {
        Axis::Place => Range { begin: extent.begin, span: extent.run },
        Axis::Time => Range { begin: 0.0, span: extent.duration },
        Axis::Speed => Range { begin: 0.0, span: 1.3 * extent.speed },
    }
}

impl FreeForm {
    /// The process along an axis; its length stands for as large a part of
    /// the run on the other axes.
    pub(super) fn new(
        extent: &Extent,
        axis: Axis,
        process: Process,
    ) -> Result<Self> {
        let (length, size) = (process.length(), process.size());
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

    /// The force \[m/s2\] in each cell that independent waves make.
    pub(super) fn force(&self, waves: &[f64]) -> Vec<f64> {
        let force = &self.factor * DVector::from_column_slice(waves);
        force.as_slice().to_vec()
    }

    /// The waves that make a force.
    pub(super) fn waves(&self, force: &[f64]) -> Result<Vec<f64>> {
        let force = DVector::from_column_slice(force);
        let waves = self.factor.solve_lower_triangular(&force);
        let waves = waves.map(|waves| waves.as_slice().to_vec());
        waves.ok_or_else(|| Error::inference("no such Gaussian process"))
    }
}

impl Candidate for FreeForm {
    fn name(&self) -> &'static str {
        UNKNOWN
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
                Unknown::amplitude(format!("wave[{}]", i + 1), "1", prior)
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
