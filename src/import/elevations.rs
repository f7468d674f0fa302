//! The track under the recordings: elevations along the path, smoothed.

use super::along::Along;
use super::grid::Grid;
use super::ground::{BEYOND, ENDING, Ground, spacing, track};
use super::line::{Beside, Line};
use super::moving::Moving;
use super::options::Options;
use crate::error::{Error, Result};
use crate::io::place;

/// Further than any mass has slid that was recorded \[m\]. A track has a point
/// each metre or so, and has to have room.
const LONGEST: f64 = 100_000.0;

/// The track, whose x is 0 where the first recording begins.
pub(super) fn ground(
    options: &Options,
    grid: Option<&Grid>,
    all: &[Moving],
    along: &Along,
) -> Result<Ground> {
    let (samples, file) = match grid {
        Some(grid) => {
            let file = options.terrain.as_deref().map(place);
            (of_terrain(options, grid, &along.line)?, file)
        }
        None => {
            let (samples, one) = of_log(all, &along.beside)?;
            (samples, Some(place(&one.log.path)))
        }
    };
    let (begin, end) = along.span();
    if end - begin > LONGEST {
        let one = all.first().map(|one| place(&one.log.path));
        return Err(Error::input(format!(
            "{}: the recording goes {:.0} km far; expected at most {:.0}: are \
             the places metres, or degrees? name columns and units with \
             --columns, and cut off what is not of the motion with --from \
             and --to",
            one.unwrap_or_default(),
            1e-3 * (end - begin),
            1e-3 * LONGEST
        )));
    }
    track(&samples, begin, end, options.smooth).ok_or_else(|| {
        Error::input(format!(
            "{}: elevations are known from {:.0} to {:.0} m along the path, \
             and the recording goes from {begin:.0} to {end:.0} m; expected \
             elevations from its start on, over at least {} m: take a larger \
             terrain model, or a smaller --smooth",
            file.unwrap_or_default(),
            samples.first().map_or(0.0, |s| s.0),
            samples.last().map_or(0.0, |s| s.0),
            spacing(options.smooth)
        ))
    })
}

/// Elevations of the terrain model under the path.
fn of_terrain(
    options: &Options,
    grid: &Grid,
    line: &Line,
) -> Result<Vec<(f64, f64)>> {
    // Four places a cell, and no more than half a million.
    let cell = grid.extent.cell.0.min(grid.extent.cell.1);
    let step = (0.25 * cell).max(line.length() / 5e5);
    let count = (line.length() / step) as usize;
    let all = (0..=count).map(|i| step * i as f64);
    let all = all.chain([line.length()]).map(|along| {
        let z = grid.at(line.place(along))?;
        Some((along, z))
    });
    let samples: Vec<_> = all.flatten().collect();
    if samples.len() > 1 {
        return Ok(samples);
    }
    let (x, y) = line.place(0.0);
    Err(Error::input(format!(
        "{}: has no elevation under the path, which begins at x = {x:.0}, y \
         = {y:.0}; expected a place in it ({}): check --crs, or take another \
         terrain model",
        options.terrain.as_deref().map(place).unwrap_or_default(),
        grid.extent.told()
    )))
}

/// Heights along the path of the first recording that has them: those of
/// another receiver are off by another error.
fn of_log<'m>(
    all: &'m [Moving],
    beside: &[Vec<Beside>],
) -> Result<(Vec<(f64, f64)>, &'m Moving)> {
    for (one, beside) in all.iter().zip(beside) {
        let both = one.rows().iter().zip(beside);
        let both = both.filter_map(|(fix, b)| Some((b.along, fix.height?)));
        let mut samples: Vec<(f64, f64)> = both.collect();
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        if samples.len() > 1 {
            return Ok((samples, one));
        }
    }
    let first = all.first().map(|one| place(&one.log.path));
    Err(Error::input(format!(
        "{}: has no heights, and there is no terrain model; expected one of \
         both: give --terrain, or name the column of heights, as in \
         --columns height=h",
        first.unwrap_or_default()
    )))
}

pub(super) fn told(
    options: &Options,
    grid: Option<&Grid>,
    ground: &Ground,
    word: &str,
) -> String {
    let source = match grid {
        Some(grid) => format!(
            "the terrain model {} with cells of {}, between them linear",
            options.terrain.as_deref().map(place).unwrap_or_default(),
            grid.extent.told_cell()
        ),
        None => format!("the {word}'s own heights"),
    };
    let smoothed = match options.smooth {
        0.0 => "not smoothed".to_owned(),
        smooth => format!("smoothed over {smooth} m"),
    };
    let further = match ground.known_to {
        None => String::new(),
        Some(at) => format!(
            " Beyond {at:.0} m it goes on to {BEYOND} m behind the last \
             position at the mean slope of the last {ENDING} m, for draws \
             that run further."
        ),
    };
    format!(
        "Elevations are of {source}, {smoothed}, on points {} m apart.\
         {further}",
        spacing(options.smooth)
    )
}
