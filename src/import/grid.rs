//! A terrain model as an ESRI ASCII grid.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::{Error, Result};
use crate::io::{place, quoted};

/// The most cells of a terrain model.
const MOST: usize = 40_000_000;

/// Elevations on a grid of square cells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    columns: usize,
    rows: usize,
    /// The middle of the cell in the south-west \[m\].
    west: f64,
    south: f64,
    /// The width of a cell \[m\].
    pub(super) cell: f64,
    /// Row by row from the north; not a number where there is none \[m\].
    z: Vec<f64>,
}

/// Reads a grid.
pub(super) fn read(text: &str, path: &Path) -> Result<Grid> {
    let mut header = BTreeMap::new();
    let mut lines = (1..).zip(text.lines()).peekable();
    let wrong = |line: usize, what: &str| {
        Error::input(what).within(format_args!("{}:{line}", place(path)))
    };
    while let Some((line, text)) = lines.peek() {
        let begins = text.trim_start().chars().next();
        if begins.is_some_and(|c| !c.is_ascii_alphabetic()) {
            break;
        }
        if begins.is_some() {
            let (key, value) = entry(text).map_err(|e| wrong(*line, &e))?;
            header.insert(key, (*line, value));
        }
        lines.next();
    }
    let mut grid = Grid::of(&header).map_err(|(at, e)| wrong(at, &e))?;
    let none = header.get("nodata_value").map_or(-9999.0, |h| h.1);
    let wanted = grid.columns * grid.rows;
    for (line, text) in lines {
        for cell in text.split_ascii_whitespace() {
            let z = number(cell).ok_or_else(|| {
                wrong(
                    line,
                    &format!(
                        "found {}; expected an elevation [m]",
                        quoted(cell)
                    ),
                )
            })?;
            grid.z.push(if z == none { f64::NAN } else { z });
        }
        if grid.z.len() > wanted {
            return Err(wrong(line, &grid.miscounted()));
        }
    }
    match grid.z.len() == wanted {
        true => Ok(grid),
        false => Err(wrong(text.lines().count(), &grid.miscounted())),
    }
}

/// A finite number that a grid may have; `nan` is none, as no data are.
fn number(cell: &str) -> Option<f64> {
    let z = cell.parse::<f64>().ok()?;
    (z.is_nan() || z.abs() < 1e12 || z.abs() > 1e37).then_some(match z {
        // The largest single-precision number stands for no data, too.
        z if z.abs() > 1e37 => f64::NAN,
        z => z,
    })
}

/// A line of the header: `ncols 121`.
fn entry(text: &str) -> Result<(String, f64), String> {
    let mut words = text.split_ascii_whitespace();
    let (key, value) = (words.next().unwrap_or_default(), words.next());
    match value.and_then(|value| value.parse::<f64>().ok()) {
        Some(value) if words.next().is_none() => {
            Ok((key.to_ascii_lowercase(), value))
        }
        _ => Err(format!(
            "found {}; expected a header of an ESRI ASCII grid, such as \
             \"ncols 121\": export the terrain model as one",
            quoted(text.trim())
        )),
    }
}

/// What is wrong with a header that has no such key.
fn lacks(key: &str) -> (usize, String) {
    let what = format!(
        "the header has no {key}; expected ncols, nrows, xllcorner or \
         xllcenter, yllcorner or yllcenter, and cellsize: export the terrain \
         model as an ESRI ASCII grid"
    );
    (1, what)
}

impl Grid {
    /// A grid as its header says, without elevations.
    fn of(
        header: &BTreeMap<String, (usize, f64)>,
    ) -> Result<Self, (usize, String)> {
        let get = |key: &str| header.get(key).copied();
        let count = |key: &str| match get(key) {
            None => Err(lacks(key)),
            Some((_, n)) if (2.0..=1e6).contains(&n) && n.fract() == 0.0 => {
                Ok(n as usize)
            }
            Some((line, n)) => {
                Err((line, format!("{key} is {n}; expected from 2 to 10^6")))
            }
        };
        let (columns, rows) = (count("ncols")?, count("nrows")?);
        if columns * rows > MOST {
            let what = format!(
                "{columns} by {rows} are more than {MOST} cells; expected at \
                 most as many: crop the terrain model about the path"
            );
            return Err((1, what));
        }
        let cell = match get("cellsize").ok_or_else(|| lacks("cellsize"))? {
            (_, cell) if cell > 0.0 && cell < 1e6 => cell,
            (line, cell) => {
                let what = format!("cellsize is {cell}; expected metres, > 0");
                return Err((line, what));
            }
        };
        // The middle of the first cell, whichever way it is given.
        let middle = |axis: &str| {
            let edge = get(&format!("{axis}llcorner")).map(|h| h.1);
            let middle = get(&format!("{axis}llcenter")).map(|h| h.1);
            let at = middle.or(edge.map(|at| at + 0.5 * cell));
            at.filter(|at| at.abs() < 1e9)
                .ok_or_else(|| lacks(&format!("{axis}llcorner")))
        };
        let (west, south) = (middle("x")?, middle("y")?);
        Ok(Self { columns, rows, west, south, cell, z: Vec::new() })
    }

    fn miscounted(&self) -> String {
        format!(
            "{} elevations up to here; expected {} rows of {}: the file is \
             cut off, or its header is another one's",
            self.z.len(),
            self.rows,
            self.columns
        )
    }

    /// The elevation between the four cells about a place \[m\]; nothing
    /// outside the model and where one of them has none.
    pub(super) fn at(&self, (x, y): (f64, f64)) -> Option<f64> {
        let right = (x - self.west) / self.cell;
        let up = (y - self.south) / self.cell;
        let last = ((self.columns - 1) as f64, (self.rows - 1) as f64);
        let inside =
            (0.0..=last.0).contains(&right) && (0.0..=last.1).contains(&up);
        if !inside {
            return None;
        }
        let i = (right as usize).min(self.columns - 2);
        let j = (up as usize).min(self.rows - 2);
        let (a, b) = (right - i as f64, up - j as f64);
        let z = |i: usize, j: usize| {
            self.z[(self.rows - 1 - j) * self.columns + i]
        };
        let below = (1.0 - a) * z(i, j) + a * z(i + 1, j);
        let above = (1.0 - a) * z(i, j + 1) + a * z(i + 1, j + 1);
        let between = (1.0 - b) * below + b * above;
        between.is_finite().then_some(between)
    }

    /// Where the model lies: from x and y to x and y \[m\].
    pub(super) fn extent(&self) -> String {
        let east = self.west + self.cell * (self.columns - 1) as f64;
        let north = self.south + self.cell * (self.rows - 1) as f64;
        format!(
            "x from {} to {east}, y from {} to {north}",
            self.west, self.south
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "ncols 3\nNROWS 2\nxllcenter 10\nyllcorner 15\n\
                        cellsize 10\nNODATA_value -1\n";

    fn grid(text: &str) -> Result<Grid> {
        read(text, Path::new("dem.asc"))
    }

    #[test]
    fn elevations_are_between_those_of_the_cells() {
        let grid = grid(&format!("{HEAD}1 2 3\n4 6 -1\n")).unwrap();
        assert_eq!(grid.at((10.0, 20.0)), Some(4.0));
        assert_eq!(grid.at((10.0, 30.0)), Some(1.0));
        assert_eq!(grid.at((15.0, 25.0)), Some(3.25));
        // A cell without data, and outside.
        assert_eq!(grid.at((25.0, 25.0)), None);
        assert_eq!(grid.at((9.0, 25.0)), None);
        assert_eq!(grid.at((f64::NAN, 25.0)), None);
    }

    #[test]
    fn a_broken_grid_is_named_by_its_line() {
        for (text, part) in [
            (String::new(), "dem.asc:1: the header has no ncols"),
            ("P6 1 1".into(), "dem.asc:1: found \"P6 1 1\""),
            ("ncols x".into(), "dem.asc:1: found \"ncols x\""),
            ("ncols 1e99\nnrows 2\n".into(), "dem.asc:1: ncols is"),
            (format!("{HEAD}1 2 3\n4 a 6"), "dem.asc:8: found \"a\""),
            (format!("{HEAD}1 2 3\n4 5"), "dem.asc:8: 5 elevations"),
            (format!("{HEAD}1 2 3\n4 5 6 7"), "dem.asc:8: 7 elevations"),
            ("ncols 1000000\nnrows 1000000\n".into(), "crop the terrain"),
        ] {
            let error = grid(&text).unwrap_err().to_string();
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}
