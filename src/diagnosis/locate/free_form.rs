//! A force of free form: a step function along an axis.

use nalgebra::{DMatrix, DVector};

use super::process::{CELLS, Process};
use crate::block::List;
use crate::diagnosis::hypothesis::UNKNOWN;
use crate::error::{Error, Result};
use crate::mechanism::{
    Candidate, Change, Extent, Family, Missing, Noun, Unknown,
};
use crate::physics::Rate;
use crate::physics::forces::{Axis, Range, Shape, Term};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// What a force of free form is called, and what it says.
pub(crate) const NOUN: &str =
    "a force that no mechanism of the catalogue describes";
pub(crate) const SAYS: &str =
    "A force that none of the mechanisms describes acts on the mass.";

/// What it adds to the equation of motion.
pub(crate) const FORMULA: &str = "+ f(s), f free";

/// Into how many steps of time a run is cut at least: along the speed, the
/// force has a kink in the middle of each of its cells.
const SHORT_STEPS: f64 = 100.0;

/// A force of free form, in cells along an axis.
#[derive(Debug, Clone)]
pub(super) struct FreeForm {
    extent: Extent,
    axis: Axis,
    cells: usize,
    /// What makes the cells' values of the unknowns; `None` where these are
    /// the values themselves.
    factor: Option<DMatrix<f64>>,
}

/// The range that a free-form force covers along an axis.
pub(super) fn range(extent: &Extent, axis: Axis) -> Range {
    match axis {
        Axis::Place => Range { begin: extent.begin, span: extent.run },
        Axis::Time => Range { begin: extent.since, span: extent.duration },
        Axis::Speed => Range { begin: 0.0, span: 1.3 * extent.speed },
    }
}

impl FreeForm {
    /// Independent cells, each standard normal beforehand \[m/s2\]: any
    /// process's force is one of these.
    pub(super) fn cells(extent: &Extent, axis: Axis, cells: usize) -> Self {
        Self { extent: *extent, axis, cells, factor: None }
    }

    /// The force of a process, as independent waves, one for each of
    /// [`CELLS`] cells.
    pub(super) fn new(
        extent: &Extent,
        axis: Axis,
        process: Process,
    ) -> Result<Self> {
        let factor = Some(process.whole_factor(extent)?);
        Ok(Self { extent: *extent, axis, cells: CELLS, factor })
    }

    /// The waves that make a force.
    pub(super) fn waves(&self, force: &[f64]) -> Result<Vec<f64>> {
        let Some(factor) = &self.factor else { return Ok(force.to_vec()) };
        let force = DVector::from_column_slice(force);
        let waves = factor.solve_lower_triangular(&force);
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
        (0..self.cells)
            .map(|i| {
                let prior = AnyPrior::Normal(0.0, 1.0);
                Unknown::amplitude(format!("wave[{}]", i + 1), "1", prior)
            })
            .collect()
    }

    fn formula(&self) -> String {
        FORMULA.to_owned()
    }
}

impl Missing for FreeForm {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let cells: List<Real<K>> = match &self.factor {
            None => values.iter().copied().collect(),
            Some(factor) => (0..self.cells)
                .map(|i| {
                    let row = values[..=i].iter().enumerate();
                    row.map(|(j, x)| *x * factor[(i, j)]).sum()
                })
                .collect(),
        };
        let rate = Rate { constant: Real::new(-1.0), ..Rate::default() };
        let range = range(&self.extent, self.axis);
        let mut change = Change::default();
        change.forces.step = self.extent.duration / SHORT_STEPS;
        change.forces.terms.push(Term {
            shape: Shape::Cells(self.axis, range, cells),
            ..Term::everywhere(rate)
        });
        change
    }
}
