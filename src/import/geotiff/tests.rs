use tiff::encoder::colortype::{self, ColorType as Kind};
use tiff::encoder::{Compression, TiffEncoder, TiffValue};

use super::*;
use crate::import::esri_grid;

/// Written by rasterio 1.4.4 (GDAL): 3 by 2 cells of 10 m, single precision,
/// deflate with a predictor for them, -1 for no data, EPSG:31254.
const DEFLATE: &[u8] = include_bytes!("deflate.tif");

/// Written by the same: 40 by 20 cells that count from 0 on, short numbers in
/// tiles of 16 by 16, LZW with differences, EPSG:32632.
const TILES: &[u8] = include_bytes!("tiles.tif");

/// The grid of the first as an ESRI ASCII grid.
const ESRI: &str = "ncols 3\nnrows 2\nxllcorner 5\nyllcorner 15\n\
                    cellsize 10\nNODATA_value -1\n1 2 3\n4 6 -1\n";

fn esri(text: &str) -> Grid {
    esri_grid::read(text, Path::new("dem.asc")).unwrap()
}

fn read(bytes: &[u8]) -> Result<Grid> {
    super::read(bytes, Path::new("dem.tif"))
}

/// The same places, and the same elevations at and between the cells.
fn same(a: &Grid, b: &Grid) {
    assert_eq!(a.extent, b.extent);
    for i in 0..60 {
        for j in 0..60 {
            let place = (0.5 * f64::from(i), 10.0 + 0.5 * f64::from(j));
            assert_eq!(a.at(place), b.at(place), "{place:?}");
        }
    }
}

const SCALE: [f64; 3] = [10.0, 10.0, 0.0];
const TIE: [f64; 6] = [0.0, 0.0, 0.0, 5.0, 35.0, 0.0];
const MOVE: [f64; 16] = [
    10.0, 0.0, 0.0, 5.0, 0.0, -10.0, 0.0, 35.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 1.0,
];

/// What a file may have beside its elevations.
#[derive(Clone, Copy)]
struct More<'m> {
    packed: Compression,
    numbers: &'m [(Tag, &'m [f64])],
    keys: &'m [u16],
    none: Option<&'m str>,
    metadata: Option<&'m str>,
}

const PLACED: More<'_> = More {
    packed: Compression::Uncompressed,
    numbers: &[
        (Tag::ModelPixelScaleTag, &SCALE),
        (Tag::ModelTiepointTag, &TIE),
    ],
    keys: &[],
    none: Some("-1"),
    metadata: None,
};

/// A file of 3 by 2 cells, by the crate's own encoder.
fn written<K: Kind>(cells: &[K::Inner], more: More<'_>) -> Vec<u8>
where
    [K::Inner]: TiffValue,
{
    let mut out = Cursor::new(Vec::new());
    let file = TiffEncoder::new(&mut out).unwrap();
    let mut file = file.with_compression(more.packed);
    let rows = cells.len() / (3 * K::BITS_PER_SAMPLE.len());
    let rows = u32::try_from(rows).unwrap();
    let mut image = file.new_image::<K>(3, rows).unwrap();
    let tags = image.encoder();
    for (tag, numbers) in more.numbers {
        tags.write_tag(*tag, *numbers).unwrap();
    }
    if !more.keys.is_empty() {
        tags.write_tag(Tag::GeoKeyDirectoryTag, more.keys).unwrap();
    }
    for (tag, text) in
        [(Tag::GdalNodata, more.none), (GDAL_METADATA, more.metadata)]
    {
        if let Some(text) = text {
            tags.write_tag(tag, text).unwrap();
        }
    }
    image.write_data(cells).unwrap();
    out.into_inner()
}

#[test]
fn another_programs_files_are_the_grids_they_were_made_of() {
    let grid = read(DEFLATE).unwrap();
    same(&grid, &esri(ESRI));
    assert_eq!(grid.epsg, Some(31254));
    let rows = (0..20).map(|row| {
        let cells = (0..40).map(|column| (40 * row + column).to_string());
        cells.collect::<Vec<_>>().join(" ") + "\n"
    });
    let text = "ncols 40\nnrows 20\nxllcorner 5\nyllcorner -165\n\
                cellsize 10\nNODATA_value -32768\n";
    let text = format!("{text}{}", rows.collect::<String>());
    let grid = read(TILES).unwrap();
    same(&grid, &esri(&text));
    assert_eq!((grid.z, grid.epsg), (esri(&text).z, Some(32632)));
}

#[test]
fn every_kind_of_number_is_read() {
    use colortype::{Gray16, Gray32, Gray32Float, Gray64Float};
    use colortype::{GrayI16, GrayI32};
    let wanted = esri(ESRI);
    let signed = [1, 2, 3, 4, 6, -1];
    let float = signed.map(f64::from);
    let single = float.map(|z| z as f32);
    let packings = [
        Compression::Uncompressed,
        Compression::Packbits,
        Compression::Lzw,
        Compression::Deflate(Default::default()),
    ];
    for packed in packings {
        let more = More { packed, ..PLACED };
        same(&read(&written::<Gray64Float>(&float, more)).unwrap(), &wanted);
        same(&read(&written::<Gray32Float>(&single, more)).unwrap(), &wanted);
        same(&read(&written::<GrayI32>(&signed, more)).unwrap(), &wanted);
        let short = signed.map(|z| z as i16);
        same(&read(&written::<GrayI16>(&short, more)).unwrap(), &wanted);
        let more = More { none: Some("65535 "), ..more };
        let short = [1, 2, 3, 4, 6, u16::MAX];
        same(&read(&written::<Gray16>(&short, more)).unwrap(), &wanted);
        let more = More { none: Some("65535"), ..more };
        let long = short.map(u32::from);
        same(&read(&written::<Gray32>(&long, more)).unwrap(), &wanted);
    }
    // No data as single precision has it, and as not a number.
    let mut none = single;
    none[5] = f32::MIN;
    let more = More { none: Some("-3.4028234663852886e+38"), ..PLACED };
    same(&read(&written::<Gray32Float>(&none, more)).unwrap(), &wanted);
    none[5] = f32::NAN;
    let more = More { none: Some("nan"), ..PLACED };
    same(&read(&written::<Gray32Float>(&none, more)).unwrap(), &wanted);
}

type Float = colortype::Gray64Float;
const CELLS: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 6.0, -1.0];

#[test]
fn places_are_those_of_the_cells_middles() {
    let wanted = esri(ESRI);
    let moved = [(Tag::ModelTransformationTag, &MOVE[..])];
    let more = More { numbers: &moved, ..PLACED };
    same(&read(&written::<Float>(&CELLS, more)).unwrap(), &wanted);
    // The tie is of another corner.
    let tie = [3.0, 2.0, 0.0, 35.0, 15.0, 0.0];
    let other =
        [(Tag::ModelPixelScaleTag, &SCALE[..]), (Tag::ModelTiepointTag, &tie)];
    let more = More { numbers: &other, ..PLACED };
    same(&read(&written::<Float>(&CELLS, more)).unwrap(), &wanted);
    // The elevation is that of the corner's place.
    let keys = [1, 1, 0, 2, 1024, 0, 1, 1, 1025, 0, 1, 2];
    let found =
        read(&written::<Float>(&CELLS, More { keys: &keys, ..PLACED }));
    let found = found.unwrap();
    assert_eq!((found.extent.west, found.extent.south), (5.0, 25.0));
    assert_eq!((found.at((5.0, 35.0)), found.epsg), (Some(1.0), None));
    // Cells that are longer than wide.
    let scale = [10.0, 20.0, 0.0];
    let long =
        [(Tag::ModelPixelScaleTag, &scale[..]), (Tag::ModelTiepointTag, &TIE)];
    let more = More { numbers: &long, ..PLACED };
    let found = read(&written::<Float>(&CELLS, more)).unwrap();
    assert_eq!(found.extent.cell, (10.0, 20.0));
    assert_eq!(found.at((15.0, 15.0)), Some((1.0 + 2.0 + 4.0 + 6.0) / 4.0));
}

#[test]
fn what_is_no_terrain_model_is_refused_with_a_mend() {
    let rows = |rows: &[[u16; 4]]| -> Vec<u16> {
        let head = [1, 1, 0, rows.len() as u16];
        head.into_iter().chain(rows.iter().flatten().copied()).collect()
    };
    let degrees = rows(&[[1024, 0, 1, 2]]);
    let feet = rows(&[[3076, 0, 1, 9002]]);
    let high = rows(&[[3072, 0, 1, 31254], [4099, 0, 1, 9003]]);
    let mut turned = MOVE;
    turned[1] = 0.1;
    let turned = [(Tag::ModelTransformationTag, &turned[..])];
    let mut south = MOVE;
    south[5] = 10.0;
    let south = [(Tag::ModelTransformationTag, &south[..])];
    let scaled = "<Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.1</Item>";
    let cases = [
        (More { keys: &degrees, ..PLACED }, "its places are longitudes"),
        (More { keys: &feet, ..PLACED }, "unit of its places is EPSG:9002"),
        (More { keys: &high, ..PLACED }, "unit of its elevations is"),
        (More { numbers: &turned, ..PLACED }, "do not go from west to east"),
        (More { numbers: &south, ..PLACED }, "with the north above"),
        (More { numbers: &[], ..PLACED }, "does not say where it lies"),
        (More { none: Some("no"), ..PLACED }, "GDAL_NODATA is \"no\""),
        (More { metadata: Some(scaled), ..PLACED }, "gdal_translate -unscale"),
    ];
    for (more, part) in cases {
        let error = read(&written::<Float>(&CELLS, more)).unwrap_err();
        let error = error.to_string();
        assert!(error.contains(part) && error.contains("expected"), "{error}");
        assert!(error.starts_with("dem.tif: "), "{error}");
    }
}

#[test]
fn what_are_no_elevations_is_refused() {
    let mut wild = CELLS;
    wild[4] = 1e15;
    let bytes = [&[7_u8; 6][..], &[7; 18]];
    let cases = [
        (written::<Float>(&wild, PLACED), "row 2, column 2 is 1000000000000"),
        (written::<colortype::Gray8>(bytes[0], PLACED), "of one byte"),
        (
            written::<colortype::RGB8>(bytes[1], PLACED),
            "is a picture (RGB(8))",
        ),
        (written::<Float>(&CELLS[..3], PLACED), "has 3 by 1 cells"),
        (b"ncols 3".to_vec(), "is no GeoTIFF that can be read"),
        (Vec::new(), "is no GeoTIFF that can be read"),
    ];
    for (bytes, part) in cases {
        let error = read(&bytes).unwrap_err().to_string();
        assert!(error.contains(part), "{part}: {error}");
    }
}

/// A size that would take the machine's memory is refused by its number.
#[test]
fn a_size_is_bounded_before_there_is_room_for_it() {
    let cells = CELLS.map(|z| z as f32);
    let mut bytes = written::<colortype::Gray32Float>(&cells, PLACED);
    let width = bytes.windows(4).position(|at| at == [0, 1, 4, 0]).unwrap();
    // The entry: tag 256, type 4, one number, and the number.
    let mut wide = |width_is: u32| {
        let at = width + 8..width + 12;
        bytes[at].copy_from_slice(&width_is.to_le_bytes());
        read(&bytes).unwrap_err().to_string()
    };
    for width in [25_000_000, u32::MAX] {
        let (error, part) = (wide(width), format!("{width} by 2 are more"));
        assert!(error.contains(&part), "{error}");
    }
}

#[test]
fn no_bytes_end_in_a_panic() {
    for good in [DEFLATE, TILES] {
        for at in 0..good.len() {
            for value in [0, 1, 2, 0x7f, 0x80, 0xff] {
                let mut bytes = good.to_vec();
                bytes[at] = value;
                let _ = read(&bytes);
            }
            let _ = read(&good[..at]);
        }
    }
}
