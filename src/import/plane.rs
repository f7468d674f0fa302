//! All places on one projection.

use super::crs::{Crs, Place};
use super::log::Log;
use super::options::Options;
use super::outline::Outline;
use crate::error::{Error, Result};

/// The projection that log, terrain and path are brought to; none where all
/// are in metres already.
pub(super) fn projection(
    options: &Options,
    log: &Log,
    outline: Option<&Outline>,
) -> Result<Option<Crs>> {
    if let Some(text) = &options.crs {
        return Crs::parse(text).map(Some);
    }
    let in_metres = outline.is_some_and(|outline| !outline.is_geographic);
    let in_degrees = outline.is_some_and(|outline| outline.is_geographic);
    let wanted = |what: &str| {
        Err(Error::input(format!(
            "--crs: is not given, and {what}; expected the projection of \
             those metres: add --crs, such as --crs EPSG:31254"
        )))
    };
    match (log.is_geographic, options.terrain.is_some(), in_metres) {
        (true, true, _) => {
            wanted("the log has degrees where the terrain model has metres")
        }
        (true, false, true) => {
            wanted("the log has degrees where the path has metres")
        }
        (true, false, false) => local(log).map(Some),
        (false, ..) if in_degrees => {
            wanted("the path has degrees where the log has metres")
        }
        (false, ..) => Ok(None),
    }
}

/// About the middle of the log, which a wild row does not move far.
fn local(log: &Log) -> Result<Crs> {
    let middle = |of: fn(&Place) -> f64| {
        let mut all: Vec<f64> =
            log.fixes.iter().map(|fix| of(&fix.place)).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    Crs::local(middle(|p| p.0), middle(|p| p.1))
}

/// The log's places in metres.
pub(super) fn places(log: &Log, crs: Option<&Crs>) -> Result<Vec<Place>> {
    let on_plane = |fix: &super::log::Fix| match crs {
        Some(crs) if log.is_geographic => {
            let height = fix.height.unwrap_or(0.0);
            crs.project(fix.place, height).ok_or_else(|| {
                let (x, y) = fix.place;
                outside(crs, x, y)
                    .within(format_args!("the log's row {}", fix.row))
            })
        }
        _ => Ok(fix.place),
    };
    log.fixes.iter().map(on_plane).collect()
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
