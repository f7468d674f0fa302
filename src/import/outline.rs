//! The line of a path as a file has it: a shapefile or GeoJSON.

use std::path::Path;

use geojson::{GeoJson, Geometry, GeometryValue, Position};

use super::crs::Place;
use super::shapes;
use crate::error::{Error, Result};
use crate::io::{place, quoted};

/// The lines of a file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outline {
    /// The longest of them.
    pub(super) places: Vec<Place>,
    /// Whether they are longitudes and latitudes.
    pub(super) is_geographic: bool,
    /// How many lines there are.
    pub(super) count: usize,
}

/// Reads a shapefile's lines; `prj` is the text beside it.
pub(super) fn shapefile(
    bytes: &[u8],
    prj: Option<&str>,
    path: &Path,
) -> Result<Outline> {
    let wrong = |what: String| Error::input(what).within(place(path));
    let lines = shapes::lines(bytes).map_err(|why| {
        wrong(format!(
            "is no shapefile that can be read: {why}; expected a .shp with a \
             line: export it again"
        ))
    })?;
    let is_geographic =
        prj.is_some_and(|text| text.trim_start().starts_with("GEOGCS"));
    longest(lines, is_geographic).map_err(wrong)
}

/// Reads the lines of GeoJSON. They are longitudes and latitudes by its
/// standard; numbers that cannot be are metres of an older file.
pub(super) fn geo_json(text: &str, path: &Path) -> Result<Outline> {
    let wrong = |what: String| Error::input(what).within(place(path));
    let json = text.parse::<GeoJson>().map_err(|error| {
        wrong(format!(
            "is no GeoJSON that can be read ({}); expected a LineString",
            quoted(&error.to_string())
        ))
    })?;
    let mut lines = Vec::new();
    match &json {
        GeoJson::Geometry(geometry) => gather(geometry, &mut lines),
        GeoJson::Feature(feature) => {
            feature.geometry.iter().for_each(|g| gather(g, &mut lines));
        }
        GeoJson::FeatureCollection(all) => {
            let all = all.features.iter().filter_map(|f| f.geometry.as_ref());
            all.for_each(|geometry| gather(geometry, &mut lines));
        }
    }
    let fits = |p: &Place| p.0.abs() <= 180.0 && p.1.abs() <= 90.0;
    let is_geographic = lines.iter().flatten().all(fits);
    longest(lines, is_geographic).map_err(wrong)
}

fn gather(geometry: &Geometry, lines: &mut Vec<Vec<Place>>) {
    match &geometry.value {
        GeometryValue::LineString { coordinates } => {
            lines.push(places(coordinates));
        }
        GeometryValue::MultiLineString { coordinates } => {
            lines.extend(coordinates.iter().map(|line| places(line)));
        }
        GeometryValue::GeometryCollection { geometries } => {
            geometries.iter().for_each(|geometry| gather(geometry, lines));
        }
        _ => {}
    }
}

fn places(positions: &[Position]) -> Vec<Place> {
    let place = |p: &Position| match p.as_slice() {
        [x, y, ..] => Some((*x, *y)),
        _ => None,
    };
    positions.iter().filter_map(place).collect()
}

fn longest(
    lines: Vec<Vec<Place>>,
    is_geographic: bool,
) -> Result<Outline, String> {
    let count = lines.len();
    let finite = |p: &Place| p.0.abs() < 1e9 && p.1.abs() < 1e9;
    if !lines.iter().flatten().all(finite) {
        return Err("has a place that is no finite number of metres or \
                    degrees; expected places: export it again"
            .to_owned());
    }
    let length = |line: &Vec<Place>| {
        let steps = line.windows(2);
        steps.map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1)).sum::<f64>()
    };
    let longest = lines
        .into_iter()
        .max_by(|a, b| length(a).total_cmp(&length(b)))
        .filter(|line| length(line) > 0.0);
    match longest {
        Some(places) => Ok(Outline { places, is_geographic, count }),
        None => Err("has no line; expected one along the path: points and \
                     areas are not used"
            .to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::shapes::tests::shapefile as written;
    use super::*;

    fn json(text: &str) -> Result<Outline> {
        geo_json(text, Path::new("path.geojson"))
    }

    #[test]
    fn the_longest_line_of_a_file_is_taken() {
        let text = r#"{"type":"FeatureCollection","features":[
            {"type":"Feature","properties":{},"geometry":
             {"type":"LineString","coordinates":[[11,47],[11,47.001]]}},
            {"type":"Feature","properties":null,"geometry":
             {"type":"MultiLineString",
              "coordinates":[[[11,47],[11,47.01],[11,47.02]]]}}]}"#;
        let found = json(text).unwrap();
        assert_eq!((found.count, found.places.len()), (2, 3));
        assert!(found.is_geographic);
        let text = r#"{"type":"LineString","coordinates":[[79400,5],[1,2]]}"#;
        assert!(!json(text).unwrap().is_geographic);
        let places = [(79_400.5, 242_000.0), (79_400.5, 241_000.0)];
        let path = Path::new("path.shp");
        let found = shapefile(&written(&[&places]), None, path).unwrap();
        assert_eq!((&found.places[..], found.count), (&places[..], 1));
        let degrees = Some("GEOGCS[\"WGS 84\"]");
        let found = shapefile(&written(&[&places]), degrees, path).unwrap();
        assert!(found.is_geographic);
    }

    #[test]
    fn what_has_no_line_is_refused() {
        for text in [
            "",
            "{}",
            "[1]",
            r#"{"type":"Point","coordinates":[11,47]}"#,
            r#"{"type":"LineString","coordinates":[]}"#,
            r#"{"type":"LineString","coordinates":[[11,47],[11,47]]}"#,
            r#"{"type":"LineString","coordinates":[[1],[2]]}"#,
            r#"{"type":"Feature","properties":{},"geometry":null}"#,
        ] {
            let error = json(text).unwrap_err().to_string();
            assert!(error.starts_with("path.geojson: "), "{error}");
        }
    }

    #[test]
    fn no_bytes_of_a_shapefile_end_in_a_panic() {
        let good = written(&[&[(0.0, 0.0), (3.0, 4.0), (5.0, 6.0)]]);
        let path = Path::new("path.shp");
        for at in 0..good.len() {
            for value in [0, 1, 0x7f, 0x80, 0xff] {
                let mut bytes = good.clone();
                bytes[at] = value;
                let _ = shapefile(&bytes, None, path);
            }
            let _ = shapefile(&good[..at], None, path);
        }
    }
}
