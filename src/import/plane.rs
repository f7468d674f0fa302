//! All places on one projection.

use super::crs::{Crs, Place, known_codes};
use super::grid::Grid;
use super::line::Line;
use super::log::{Fix, Frame, Log};
use super::options::Options;
use super::outline::Outline;
use crate::error::{Error, Result};
use crate::io::place;

/// Places on two projections that are further apart are others \[m\].
const APART: f64 = 1.0;

/// The projection that logs, terrain and path are brought to; none where all
/// are in metres already.
pub(super) fn projection(
    options: &Options,
    logs: &[Log],
    outline: Option<&Outline>,
    grid: Option<&Grid>,
) -> Result<Option<Crs>> {
    if let Some(text) = &options.crs {
        return Crs::parse(text).map(Some);
    }
    let degrees = logs.iter().any(Log::is_geographic);
    let metres = logs.iter().any(|log| log.frame == Frame::Metres);
    let path = outline.map(|outline| outline.is_geographic);
    if !degrees && path != Some(true) {
        return Ok(None);
    }
    if let Some(epsg) = grid.and_then(|grid| grid.epsg) {
        return of_terrain(options, epsg).map(Some);
    }
    let what = if degrees && options.terrain.is_some() {
        "the log has degrees where the terrain model has metres"
    } else if degrees && path == Some(false) {
        "the log has degrees where the path has metres"
    } else if degrees && metres {
        "a log has degrees where another has metres"
    } else if metres {
        "the path has degrees where the log has metres"
    } else if options.terrain.is_some() {
        "the path has degrees where the terrain model has metres"
    } else {
        return local(logs, outline).map(Some);
    };
    Err(Error::input(format!(
        "--crs: is not given, and {what}; expected the projection of those \
         metres: add --crs, such as --crs EPSG:31254"
    )))
}

/// The projection that the terrain model names.
fn of_terrain(options: &Options, epsg: u32) -> Result<Crs> {
    Crs::by_code(epsg)?.ok_or_else(|| {
        Error::input(format!(
            "{}: is on EPSG:{epsg}; expected one of {}: give its PROJ string \
             with --crs",
            options.terrain.as_deref().map(place).unwrap_or_default(),
            known_codes()
        ))
    })
}

/// What is to doubt where `--crs` is another projection than the one that the
/// terrain model names.
pub(super) fn doubt(
    options: &Options,
    log: &Log,
    grid: Option<&Grid>,
    crs: Option<&Crs>,
) -> Result<Option<String>> {
    let named = options.crs.as_ref().and(grid).and_then(|grid| grid.epsg);
    let own = named.map(Crs::by_code).transpose()?.flatten();
    let (Some(own), Some(crs), true) = (own, crs, log.is_geographic()) else {
        return Ok(None);
    };
    let on = |crs: &Crs| crs.project(log.fixes.first()?.place, 0.0);
    let apart = on(&own).zip(on(crs));
    let apart = apart.map(|(a, b)| (a.0 - b.0).hypot(a.1 - b.1));
    Ok(apart.filter(|apart| *apart > APART).map(|apart| {
        format!(
            "The terrain model says that it is on {}, and --crs, which was \
             taken, says {}: the log's first place is {apart:.0} m apart on \
             them.",
            own.name, crs.name
        )
    }))
}

/// About the middle of the logs, which a wild row does not move far; that of
/// the path where only it has degrees.
fn local(logs: &[Log], outline: Option<&Outline>) -> Result<Crs> {
    let logs = logs.iter().filter(|log| log.is_geographic());
    let mut all: Vec<Place> =
        logs.flat_map(|log| log.fixes.iter().map(|fix| fix.place)).collect();
    if all.is_empty() {
        all = outline.map(|o| o.places.clone()).unwrap_or_default();
    }
    let middle = |of: fn(&Place) -> f64| {
        let mut all: Vec<f64> = all.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    Crs::local(middle(|p| p.0), middle(|p| p.1))
}

/// The log's places in metres. `path` is the one that a file gives.
pub(super) fn places(
    log: &Log,
    crs: Option<&Crs>,
    path: Option<&Line>,
) -> Result<Vec<Place>> {
    let on_plane = |fix: &Fix| match (log.frame, crs, path) {
        (Frame::Degrees, Some(crs), _) => {
            let height = fix.height.unwrap_or(0.0);
            crs.project(fix.place, height).ok_or_else(|| {
                let (x, y) = fix.place;
                outside(crs, x, y)
                    .within(format_args!("the log's row {}", fix.row))
            })
        }
        (Frame::Along, _, Some(path)) => on_path(log, fix, path),
        (Frame::Along, _, None) => Err(Error::input(format!(
            "{}: has distances along a path, and there is none; expected the \
             path that they are measured on: give it with --path",
            place(&log.path)
        ))),
        _ => Ok(fix.place),
    };
    log.fixes.iter().map(on_plane).collect()
}

/// A place by its distance along the path.
fn on_path(log: &Log, fix: &Fix, path: &Line) -> Result<Place> {
    let (along, length) = (fix.place.0, path.length());
    if (0.0..=length).contains(&along) {
        return Ok(path.place(along));
    }
    Err(Error::input(format!(
        "{}:{}: the distance along the path is {along} m; expected from 0 to \
         {length:.1} m, the length of the path seen from above: measure it \
         from the path's first point, or give a longer path",
        place(&log.path),
        fix.row
    )))
}

/// The path's places in metres.
pub(super) fn path(
    outline: &Outline,
    crs: Option<&Crs>,
) -> Result<Vec<Place>> {
    let on_plane = |place: &Place| match crs {
        Some(crs) if outline.is_geographic => crs
            .project(*place, 0.0)
            .ok_or_else(|| outside(crs, place.0, place.1).within("--path")),
        _ => Ok(*place),
    };
    outline.places.iter().map(on_plane).collect()
}

fn outside(crs: &Crs, x: f64, y: f64) -> Error {
    Error::input(format!(
        "longitude {x}, latitude {y} is not on {}; expected a place that the \
         projection is for: check --crs, and that the columns of longitude \
         and latitude are not exchanged",
        crs.name
    ))
}
