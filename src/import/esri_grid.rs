//! A terrain model as an ESRI ASCII grid.

use std::collections::BTreeMap;
use std::path::Path;

use super::grid::{Extent, Grid, bounded, elevation};
use crate::error::{Error, Result};
use crate::io::{place, quoted};

/// Reads a grid.
pub(super) fn read(text: &str, path: &Path) -> Result<Grid> {
    let wrong = |line: usize, what: &str| {
        Error::input(what).within(format_args!("{}:{line}", place(path)))
    };
    let (header, first) = header(text).map_err(|(at, e)| wrong(at, &e))?;
    let lines = (first..).zip(text.lines().skip(first - 1));
    let extent = extent(&header).map_err(|(at, e)| wrong(at, &e))?;
    let none = header.get("nodata_value").map_or(-9999.0, |h| h.1);
    let wanted = extent.columns * extent.rows;
    let mut all: Vec<f64> = Vec::new();
    for (line, text) in lines {
        for cell in text.split_ascii_whitespace() {
            let z = cell.parse().ok().and_then(|z| elevation(z, none));
            all.push(z.ok_or_else(|| {
                wrong(
                    line,
                    &format!(
                        "found {}; expected an elevation [m]",
                        quoted(cell)
                    ),
                )
            })?);
        }
        if all.len() > wanted {
            return Err(wrong(line, &miscounted(extent, all.len())));
        }
    }
    match all.len() == wanted {
        true => Ok(Grid { extent, z: all, epsg: None }),
        false => {
            let what = miscounted(extent, all.len());
            Err(wrong(text.lines().count(), &what))
        }
    }
}

/// The numbers of a header by their keys, in small letters, with their lines.
type Header = BTreeMap<String, (usize, f64)>;

/// The header, and the first line behind it.
fn header(text: &str) -> Result<(Header, usize), (usize, String)> {
    let mut header = Header::new();
    for (line, text) in (1..).zip(text.lines()) {
        let first = text.split_ascii_whitespace().next();
        // A cell may be "nan".
        if first.is_some_and(|word| word.parse::<f64>().is_ok()) {
            return Ok((header, line));
        }
        if first.is_some() {
            let (key, value) = entry(text).map_err(|e| (line, e))?;
            header.insert(key, (line, value));
        }
    }
    Ok((header, text.lines().count() + 1))
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

/// Where the cells lie, as the header says.
fn extent(header: &Header) -> Result<Extent, (usize, String)> {
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
    bounded(columns, rows).map_err(|what| (1, what))?;
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
    Ok(Extent { columns, rows, west, south, cell: (cell, cell) })
}

fn miscounted(extent: Extent, found: usize) -> String {
    format!(
        "{found} elevations up to here; expected {} rows of {}: the file is \
         cut off, or its header is another one's",
        extent.rows, extent.columns
    )
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
