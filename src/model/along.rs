//! The directions along which a run takes derivatives.

use nalgebra::DMatrix;

use crate::scalar::{Kind, Real};

/// Directions on the real line, from one of them on as many as the numbers of
/// the run carry.
#[derive(Debug, Clone, Copy)]
pub(super) struct Along<'d> {
    /// A row for each direction and a column for each coordinate; `None` for
    /// the coordinates themselves.
    directions: Option<&'d DMatrix<f64>>,
    first: usize,
}

impl<'d> Along<'d> {
    /// The coordinates themselves.
    pub(super) const COORDINATES: Self = Self { directions: None, first: 0 };

    /// The rows of a matrix that has a column for each coordinate.
    pub(super) fn rows(directions: &'d DMatrix<f64>) -> Self {
        Self { directions: Some(directions), first: 0 }
    }

    pub(super) fn from(self, first: usize) -> Self {
        Self { first, ..self }
    }

    /// How many there are in all, of so many coordinates.
    pub(super) fn count(self, coordinates: usize) -> usize {
        self.directions.map_or(coordinates, DMatrix::nrows)
    }

    /// A coordinate as a number of the run.
    #[inline]
    pub(super) fn number<K: Kind>(self, z: f64, coordinate: usize) -> Real<K> {
        let Some(directions) = self.directions else {
            let direction = coordinate.wrapping_sub(self.first);
            return Real::variable(z, direction);
        };
        let count = directions.nrows();
        let column = coordinate * count..(coordinate + 1) * count;
        Real::assembled(z, &directions.as_slice()[column][self.first..])
    }

    /// Whether any of them changes a coordinate.
    pub(super) fn change(self, coordinate: usize) -> bool {
        let is_changed = |directions: &DMatrix<f64>| {
            directions.column(coordinate).iter().any(|share| *share != 0.0)
        };
        self.directions.is_none_or(is_changed)
    }

    /// Adds to a matrix along all directions one that is diagonal in the
    /// coordinates.
    pub(super) fn add_diagonal(
        self,
        diagonal: &[f64],
        sum: &mut DMatrix<f64>,
    ) {
        let Some(directions) = self.directions else {
            for (i, element) in diagonal.iter().enumerate() {
                sum[(i, i)] += element;
            }
            return;
        };
        let mut scaled = directions.clone();
        for (mut column, element) in scaled.column_iter_mut().zip(diagonal) {
            column *= *element;
        }
        sum.gemm(1.0, &scaled, &directions.transpose(), 1.0);
    }
}

/// Some of so many coordinates as directions.
pub(crate) fn coordinates(some: &[usize], count: usize) -> DMatrix<f64> {
    let mut directions = DMatrix::zeros(some.len(), count);
    for (row, &coordinate) in some.iter().enumerate() {
        directions[(row, coordinate)] = 1.0;
    }
    directions
}
