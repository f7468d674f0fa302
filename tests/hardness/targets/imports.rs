//! Logs, terrain models and paths of other programs.

use std::fs;
use std::path::{Path, PathBuf};

use couloir::Error;
use couloir::import::{Options, Particle, import_all};

use super::words::text;

/// A log in metres and one in degrees, both synthetic.
const METRES: &[u8] = include_bytes!("../corpus/log/metres.csv");
const DEGREES: &[u8] = include_bytes!("../corpus/log/degrees.csv");

/// A file with an input or with what stands beside one.
fn file(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    path
}

fn metres(folder: &Path) -> Options {
    Options::new(file(folder, "metres.csv", METRES))
}

fn degrees(folder: &Path) -> Options {
    Options::new(file(folder, "degrees.csv", DEGREES))
}

/// What is imported is an event, which the import itself reads back.
fn take(options: &Options) -> Result<(), Error> {
    import_all(options).map(drop)
}

pub(crate) fn log(folder: &Path, input: &[u8]) -> Result<(), Error> {
    take(&Options::new(file(folder, "log.csv", input)))
}

pub(crate) fn gpx(folder: &Path, input: &[u8]) -> Result<(), Error> {
    take(&Options::new(file(folder, "log.gpx", input)))
}

pub(crate) fn front(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let mut options = metres(folder);
    options.front = Some(file(folder, "front.csv", input));
    take(&options)
}

pub(crate) fn columns(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let mut options = metres(folder);
    options.columns = Some(text(input)?.to_owned());
    take(&options)
}

pub(crate) fn moment(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let mut options = degrees(folder);
    options.from = Some(text(input)?.to_owned());
    let begun = take(&options);
    (options.from, options.to) = (None, options.from);
    begun.and(take(&options))
}

pub(crate) fn crs(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let mut options = degrees(folder);
    options.crs = Some(text(input)?.to_owned());
    take(&options)
}

pub(crate) fn grid(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let mut options = metres(folder);
    options.terrain = Some(file(folder, "terrain.asc", input));
    take(&options)
}

pub(crate) fn geotiff(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let mut options = metres(folder);
    options.terrain = Some(file(folder, "terrain.tif", input));
    take(&options)
}

pub(crate) fn shapefile(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let mut options = metres(folder);
    options.path = Some(file(folder, "path.shp", input));
    take(&options)
}

pub(crate) fn geojson(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let mut options = metres(folder);
    options.path = Some(file(folder, "path.geojson", input));
    take(&options)
}

/// A table of particles in place of one of a project of AvaFrame.
pub(crate) fn particles(folder: &Path, input: &[u8]) -> Result<(), Error> {
    let tables = folder.join("Outputs/com1DFA/particlesCSV");
    fs::create_dir_all(&tables).unwrap();
    for step in 0..8_u32 {
        let (t, y) = (f64::from(step), f64::from(step * step));
        let row = format!("50.0,{y},{},{},1.0,7,{t}\n", 500.0 - y, 2.0 * t);
        let text = format!("X,Y,Z,velocityMagnitude,m,ID,time\n{row}");
        let bytes = if step == 3 { input } else { text.as_bytes() };
        file(&tables, &format!("particlesslide.csv.{step:04}"), bytes);
    }
    let mut options = Options::of_logs::<PathBuf>([]);
    options.avaframe = Some(folder.to_owned());
    options.terrain = Some(file(folder, "terrain.asc", TERRAIN));
    options.path = Some(file(folder, "path.geojson", PATH));
    options.particles =
        vec![Particle::Mean, Particle::Front, Particle::Number(7)];
    take(&options)
}

/// Where the particles slide.
const TERRAIN: &[u8] = b"ncols 2\nnrows 2\nxllcenter 0\nyllcenter 0\n\
    cellsize 500\n100 100\n500 500\n";
const PATH: &[u8] = br#"{"type": "LineString", "coordinates":
    [[50, 0], [50, 500]]}"#;
