//! The directions along which a run takes derivatives.

use nalgebra::DMatrix;

use crate::error::{Error, Result};
use crate::scalar::{Kind, Real};

/// The directions of one run: those from `first` on, as many as its numbers
/// carry.
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

    /// The rows of a matrix that has a column for each of so many coordinates.
    ///
    /// # Errors
    /// A matrix of another width.
    pub(super) fn rows(
        directions: &'d DMatrix<f64>,
        coordinates: usize,
    ) -> Result<Self> {
        check_width(directions, coordinates)?;
        Ok(Self { directions: Some(directions), first: 0 })
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
        // A run that was rejected has not come to all of them.
        let elements = diagonal.iter().copied().chain(std::iter::repeat(0.0));
        for (mut column, element) in scaled.column_iter_mut().zip(elements) {
            column *= element;
        }
        sum.gemm(1.0, &scaled, &directions.transpose(), 1.0);
    }
}

/// Refuses directions that have not as many columns as there are coordinates.
///
/// # Errors
/// A matrix of another width.
pub(super) fn check_width(
    directions: &DMatrix<f64>,
    coordinates: usize,
) -> Result<()> {
    let width = directions.ncols();
    if width == coordinates {
        return Ok(());
    }
    Err(Error::input(format!(
        "directions of {width} coordinates for {coordinates} parameters; give \
         a column for each parameter"
    )))
}

/// Some of so many coordinates as directions.
pub(crate) fn unit_directions(some: &[usize], count: usize) -> DMatrix<f64> {
    let mut directions = DMatrix::zeros(some.len(), count);
    for (row, &coordinate) in some.iter().enumerate() {
        directions[(row, coordinate)] = 1.0;
    }
    directions
}
