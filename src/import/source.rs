//! Which reader a file is for.

use std::path::Path;

use super::columns::Columns;
use super::grid::Grid;
use super::log::Log;
use super::outline::{self, Outline};
use super::table::{self, Of};
use super::{esri_grid, geotiff, gpx_file};
use crate::error::{Error, Result};
use crate::io::{place, quoted, read_any_text, read_bytes};

/// The ending of a file's name, in small letters.
fn ending(path: &Path) -> String {
    let ending = path.extension().unwrap_or_default();
    ending.to_string_lossy().to_ascii_lowercase()
}

/// A log: GPX by its name, anything else as a table.
pub(super) fn log(path: &Path, columns: Option<&str>) -> Result<Log> {
    let named = Columns::parse(columns.unwrap_or_default())?;
    let text = read_any_text(path)?;
    match ending(path).as_str() {
        "gpx" if columns.is_some() => Err(Error::input(
            "--columns: is given, and GPX has no columns; expected it with a \
             table of text only: leave it out",
        )),
        "gpx" => gpx_file::read(&text, path),
        _ => table::read(&text, path, &named, Of::Sensor),
    }
}

/// The places of a front by time: a table.
pub(super) fn front(path: &Path, columns: Option<&str>) -> Result<Log> {
    let named = Columns::parse(columns.unwrap_or_default())?;
    table::read(&read_any_text(path)?, path, &named, Of::Front)
}

/// A terrain model: GeoTIFF by its name, anything else as an ESRI ASCII grid.
pub(super) fn terrain(path: &Path) -> Result<Grid> {
    match ending(path).as_str() {
        "tif" | "tiff" => geotiff::read(&read_bytes(path)?, path),
        _ => esri_grid::read(&read_any_text(path)?, path),
    }
}

/// A path; beside a shapefile its projection.
pub(super) fn path(path: &Path) -> Result<Outline> {
    match ending(path).as_str() {
        "shp" => {
            let beside = path.with_extension("prj");
            let prj = beside.is_file().then(|| read_any_text(&beside));
            let prj = prj.transpose()?;
            outline::shapefile(&read_bytes(path)?, prj.as_deref(), path)
        }
        "json" | "geojson" => outline::geo_json(&read_any_text(path)?, path),
        other => Err(Error::input(format!(
            "{}: ends in {}; expected a shapefile, .shp, or GeoJSON, .geojson \
             or .json: export the path as one",
            place(path),
            quoted(other)
        ))),
    }
}
