//! A terrain model as a GeoTIFF (OGC 19-008r4): one band of elevations, where
//! its cells lie, and on which projection.

use std::io::Cursor;
use std::path::Path;

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use super::grid::{Extent, Grid, MOST, bounded, elevation};
use super::tiff_tags;
use crate::error::{Error, Result};
use crate::io::{place, quoted};

type Image<'b> = Decoder<Cursor<&'b [u8]>>;

/// What GDAL writes of its own: values that stand for others.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// Reads a GeoTIFF.
pub(super) fn read(bytes: &[u8], path: &Path) -> Result<Grid> {
    grid(bytes).map_err(|what| Error::input(what).within(place(path)))
}

fn grid(bytes: &[u8]) -> Result<Grid, String> {
    if !tiff_tags::fit(bytes) {
        return Err(
            "has a tag that is longer than the file; expected a whole \
                    GeoTIFF: copy or export it again"
                .to_owned(),
        );
    }
    let mut image =
        Decoder::new(Cursor::new(bytes)).map_err(|e| broken(&e))?;
    let (columns, rows) = image.dimensions().map_err(|e| broken(&e))?;
    let (columns, rows) = (columns as usize, rows as usize);
    bounded(columns, rows)?;
    if columns < 2 || rows < 2 {
        return Err(format!(
            "has {columns} by {rows} cells; expected two by two at least: \
             take a larger terrain model"
        ));
    }
    one_band(&mut image)?;
    let keys = Keys::of(&mut image)?;
    keys.check()?;
    let extent = extent(&mut image, &keys, columns, rows)?;
    let none = no_data(&mut image)?;
    // Eight bytes a cell, and a tile that may be wider than the model.
    let mut limits = Limits::default();
    limits.decoding_buffer_size = 8 * MOST;
    let decoded =
        image.with_limits(limits).read_image().map_err(|e| broken(&e))?;
    let z = elevations(decoded, none, columns)?;
    if z.len() != columns * rows {
        return Err(format!(
            "has {} elevations; expected {rows} rows of {columns}: export it \
             again",
            z.len()
        ));
    }
    Ok(Grid { extent, z, epsg: keys.projection() })
}

fn broken(error: &TiffError) -> String {
    format!(
        "is no GeoTIFF that can be read ({}); expected one band of \
         elevations, plain or packed by deflate or LZW: export it again, or \
         as an ESRI ASCII grid",
        quoted(&error.to_string())
    )
}

/// Refuses pictures, and elevations that stand for others.
fn one_band(image: &mut Image) -> Result<(), String> {
    let color = image.colortype().map_err(|e| broken(&e))?;
    let light = Tag::PhotometricInterpretation;
    let light =
        image.find_tag_unsigned::<u16>(light).map_err(|e| broken(&e))?;
    // 0: the greatest value is black, and values are turned as they are read.
    if !matches!(color, ColorType::Gray(_)) || light == Some(0) {
        return Err(format!(
            "is a picture ({color:?}); expected one band of elevations: \
             export that band alone"
        ));
    }
    let more = image.find_tag(GDAL_METADATA).map_err(|e| broken(&e))?;
    let more = more.and_then(|text| text.into_string().ok());
    let more = more.unwrap_or_default();
    if more.contains("role=\"scale\"") || more.contains("role=\"offset\"") {
        return Err("its values have a scale and an offset (GDAL_METADATA); \
                    expected elevations [m]: write them as such, as \
                    `gdal_translate -unscale -ot Float32` does"
            .to_owned());
    }
    Ok(())
}

/// Numbers of a tag, where it is there.
fn numbers(image: &mut Image, tag: Tag) -> Result<Option<Vec<f64>>, String> {
    let found = image.find_tag(tag).map_err(|e| broken(&e))?;
    found.map(|value| value.into_f64_vec().map_err(|e| broken(&e))).transpose()
}

/// The keys of a GeoTIFF that are short numbers.
struct Keys(Vec<(u16, u16)>);

impl Keys {
    /// By rows of four: a key, where its value stands (0: in the row), how
    /// many there are, and the value.
    fn of(image: &mut Image) -> Result<Self, String> {
        let tag = Tag::GeoKeyDirectoryTag;
        let all =
            image.find_tag_unsigned_vec::<u16>(tag).map_err(|e| broken(&e))?;
        let all = all.unwrap_or_default();
        let rows = all.chunks_exact(4).skip(1);
        let short = rows.filter(|row| row[1] == 0).map(|row| (row[0], row[3]));
        Ok(Self(short.collect()))
    }

    fn get(&self, key: u16) -> Option<u16> {
        self.0.iter().find(|row| row.0 == key).map(|row| row.1)
    }

    /// Whether a cell's elevation is that of its corner's place
    /// (GTRasterTypeGeoKey), and not of the area that begins there.
    fn is_point(&self) -> bool {
        self.get(1025) == Some(2)
    }

    /// The code of the projection (ProjectedCSTypeGeoKey); 32767 stands for
    /// one without a code.
    fn projection(&self) -> Option<u32> {
        self.get(3072)
            .filter(|code| (1024..32767).contains(code))
            .map(u32::from)
    }

    /// Refuses degrees (GTModelTypeGeoKey) and other units than the metre
    /// (ProjLinearUnitsGeoKey, VerticalUnitsGeoKey; EPSG 9001).
    fn check(&self) -> Result<(), String> {
        if self.get(1024) == Some(2) {
            return Err("its places are longitudes and latitudes; expected \
                        metres on a projection: bring it to one, as \
                        `gdalwarp -t_srs EPSG:32632` does"
                .to_owned());
        }
        for (key, what) in [(3076, "places"), (4099, "elevations")] {
            let unit = self.get(key).filter(|unit| *unit != 9001);
            if let Some(unit) = unit {
                return Err(format!(
                    "the unit of its {what} is EPSG:{unit}; expected metres, \
                     EPSG:9001: convert it to metres"
                ));
            }
        }
        Ok(())
    }
}

/// Where the cells lie: by a place and the width of a cell, or by a
/// transformation without rotation.
fn extent(
    image: &mut Image,
    keys: &Keys,
    columns: usize,
    rows: usize,
) -> Result<Extent, String> {
    let scale = numbers(image, Tag::ModelPixelScaleTag)?;
    let tie = numbers(image, Tag::ModelTiepointTag)?;
    let whole = numbers(image, Tag::ModelTransformationTag)?;
    // The corner of the cell in the north-west and the steps from there.
    let (x, y, cell) = match (scale.as_deref(), tie.as_deref(), whole) {
        (Some([across, up, ..]), Some([i, j, _, x, y, _]), _) => {
            (x - i * across, y + j * up, (*across, *up))
        }
        (_, _, Some(m)) => by_transformation(&m)?,
        _ => {
            return Err("does not say where it lies; expected \
                        ModelPixelScale with one ModelTiepoint, or \
                        ModelTransformation: export it as a GeoTIFF with its \
                        place"
                .to_owned());
        }
    };
    let half = if keys.is_point() { 0.0 } else { 0.5 };
    let west = x + half * cell.0;
    let south = y - (half + (rows - 1) as f64) * cell.1;
    let is_cell = |width: f64| width > 0.0 && width < 1e6;
    let fits = is_cell(cell.0) && is_cell(cell.1);
    if !(fits && west.abs() < 1e9 && south.abs() < 1e9) {
        return Err(format!(
            "its cells are {} by {} m wide, the first at {x}, {y}; expected \
             metres, more than 0, with the north above: export it again",
            cell.0, cell.1
        ));
    }
    Ok(Extent { columns, rows, west, south, cell })
}

/// A corner and the steps from it, of x = m0 i + m1 j + m3 and
/// y = m4 i + m5 j + m7.
fn by_transformation(m: &[f64]) -> Result<(f64, f64, (f64, f64)), String> {
    match m {
        [a, b, _, x, c, d, _, y, ..] if *b == 0.0 && *c == 0.0 => {
            Ok((*x, *y, (*a, -d)))
        }
        _ => Err("its rows do not go from west to east; expected a terrain \
                  model that is not turned: bring it to such a grid, as \
                  `gdalwarp` does"
            .to_owned()),
    }
}

/// The number that stands for no data (GDAL_NODATA); -9999 as in an ESRI
/// ASCII grid where the file says none.
fn no_data(image: &mut Image) -> Result<f64, String> {
    let Some(text) =
        image.find_tag(Tag::GdalNodata).map_err(|e| broken(&e))?
    else {
        return Ok(-9999.0);
    };
    let text = text.into_string().map_err(|e| broken(&e))?;
    text.trim_matches(['\0', ' ']).parse().map_err(|_| {
        format!(
            "GDAL_NODATA is {}; expected a number: export it again",
            quoted(&text)
        )
    })
}

fn elevations(
    decoded: DecodingResult,
    none: f64,
    columns: usize,
) -> Result<Vec<f64>, String> {
    let all: Vec<f64> = match decoded {
        DecodingResult::F64(all) => all,
        // No data as the file can have it, which has fewer digits.
        DecodingResult::F32(all) => {
            let own =
                |z: &f32| if *z == none as f32 { none } else { (*z).into() };
            all.iter().map(own).collect()
        }
        DecodingResult::I16(all) => all.into_iter().map(f64::from).collect(),
        DecodingResult::U16(all) => all.into_iter().map(f64::from).collect(),
        DecodingResult::I32(all) => all.into_iter().map(f64::from).collect(),
        DecodingResult::U32(all) => all.into_iter().map(f64::from).collect(),
        _ => {
            return Err("its values are of one byte, or of a kind that is \
                        not read; expected elevations as Float32, Float64, \
                        Int16, UInt16 or Int32: export it as Float32"
                .to_owned());
        }
    };
    let all = all.into_iter().enumerate().map(|(i, z)| {
        elevation(z, none).ok_or_else(|| {
            format!(
                "row {}, column {} is {z}; expected an elevation [m]",
                i / columns + 1,
                i % columns + 1
            )
        })
    });
    all.collect()
}

#[cfg(test)]
mod tests;
