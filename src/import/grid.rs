//! A terrain model: elevations on a grid, and between its cells.

use crate::error::Result;

/// The most cells of a terrain model.
///
/// Read from a GeoTIFF, which may be small beside what is in it, twenty
/// million take 240 MB: a square of 4.5 km in cells of a metre.
pub(super) const MOST: usize = 20_000_000;

/// Where the cells of a grid lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// The middle of the cell in the south-west \[m\].
    pub(super) west: f64,
    pub(super) south: f64,
    /// How wide a cell is from west to east, and from south to north \[m\].
    pub(super) cell: (f64, f64),
}

/// Elevations on a grid of cells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    pub(super) extent: Extent,
    /// Row by row from the north; not a number where there is none \[m\].
    pub(super) z: Vec<f64>,
    /// The EPSG code of its projection, where the file says one.
    pub(super) epsg: Option<u32>,
}

/// An elevation as a file has it, with `none` for no data; nothing where it
/// can be neither.
pub(super) fn elevation(z: f64, none: f64) -> Option<f64> {
    // The largest single-precision number stands for no data, too.
    let is_none = z == none || z.is_nan() || z.abs() > 1e37;
    (is_none || z.abs() < 1e12).then_some(if is_none { f64::NAN } else { z })
}

/// Refuses more cells than there may be, before there is room for them.
pub(super) fn bounded(columns: usize, rows: usize) -> Result<(), String> {
    match columns.checked_mul(rows) {
        Some(cells) if cells <= MOST => Ok(()),
        _ => Err(format!(
            "{columns} by {rows} are more than {MOST} cells; expected at \
             most as many: crop the terrain model about the path"
        )),
    }
}

impl Grid {
    /// The elevation between the four cells about a place \[m\]; nothing
    /// outside the model and where one of them has none.
    pub(super) fn at(&self, (x, y): (f64, f64)) -> Option<f64> {
        let Extent { columns, rows, west, south, cell } = self.extent;
        let right = (x - west) / cell.0;
        let up = (y - south) / cell.1;
        let last = ((columns - 1) as f64, (rows - 1) as f64);
        let inside =
            (0.0..=last.0).contains(&right) && (0.0..=last.1).contains(&up);
        if !inside {
            return None;
        }
        let i = (right as usize).min(columns - 2);
        let j = (up as usize).min(rows - 2);
        let (a, b) = (right - i as f64, up - j as f64);
        let z = |i: usize, j: usize| self.z[(rows - 1 - j) * columns + i];
        let below = (1.0 - a) * z(i, j) + a * z(i + 1, j);
        let above = (1.0 - a) * z(i, j + 1) + a * z(i + 1, j + 1);
        let between = (1.0 - b) * below + b * above;
        between.is_finite().then_some(between)
    }
}

impl Extent {
    /// Where the model lies: from x and y to x and y \[m\].
    pub(super) fn told(&self) -> String {
        let east = self.west + self.cell.0 * (self.columns - 1) as f64;
        let north = self.south + self.cell.1 * (self.rows - 1) as f64;
        format!(
            "x from {} to {east}, y from {} to {north}",
            self.west, self.south
        )
    }

    /// The size of a cell in words.
    pub(super) fn told_cell(&self) -> String {
        match self.cell {
            (across, up) if across == up => format!("{across} m"),
            (across, up) => format!("{across} by {up} m"),
        }
    }
}
