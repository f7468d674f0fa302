//! `couloir import`: event folders from logs, a front, a terrain model and a
//! path.

use std::path::{Path, PathBuf};

use clap::Args;

use super::answer::{Answer, quoted_word};
use super::made::Made;
use super::results::{Results, folder};
use super::width;
use crate::error::Result;
use crate::export::InferenceData;
use crate::import::{FILES, Imported, Options, Particle, import_all};
use crate::report::text::wrap;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The log of a GNSS sensor: a table of text with a header (u-blox logs,
    /// any CSV), or GPX; several for several sensors in one avalanche
    #[arg(value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// The places of a front by time, a table: t, and x and y, lon and lat, or
    /// s, the horizontal distance along the path; points of one time are
    /// averaged
    #[arg(long, value_name = "FILE")]
    front: Option<PathBuf>,
    /// A project of AvaFrame: the tables of particles that com1DFA writes with
    /// writePartToCSV = True, with the project's terrain model and path
    #[arg(long, value_name = "DIR")]
    avaframe: Option<PathBuf>,
    /// Which simulation of the project, where there are several
    #[arg(long, value_name = "NAME")]
    simulation: Option<String>,
    /// What is taken of it: the mean of all particles (the default), the
    /// front, or particles by their ID; several by commas
    #[arg(long, value_name = "WHICH", value_delimiter = ',')]
    particle: Vec<Particle>,
    /// The event folder to write, or that of a folder for each recording;
    /// without it nothing is written
    #[arg(long, value_name = "DIR", value_parser = folder)]
    out: Option<PathBuf>,
    /// Columns of the log by name and unit, such as
    /// "time=UTC,speed=v_kmh:km/h"; there are time (s, ms, hh:mm:ss), lon,
    /// lat (deg), x, y, along, height (m), speed, ground-speed, vel-north,
    /// vel-east, vel-down (m/s, km/h), satellites, fix
    #[arg(long, value_name = "COLUMNS")]
    columns: Option<String>,
    /// A terrain model, an ESRI ASCII grid or a GeoTIFF (.tif)
    #[arg(long, value_name = "FILE")]
    terrain: Option<PathBuf>,
    /// The path, a shapefile or GeoJSON; the log's own positions otherwise
    #[arg(long, value_name = "FILE")]
    path: Option<PathBuf>,
    /// The projection of terrain and path, such as EPSG:31254, or a PROJ
    /// string; that of the GeoTIFF otherwise
    #[arg(long, value_name = "CRS", allow_hyphen_values = true)]
    crs: Option<String>,
    /// The length over which elevations are smoothed [m]
    #[arg(long, value_name = "METRES", default_value_t = 20.0)]
    smooth: f64,
    /// The speed above which the mass moves [m/s]
    #[arg(long, value_name = "SPEED", default_value_t = 0.6)]
    threshold: f64,
    /// How much to keep before and after that [s]
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    margin: f64,
    /// Where the recording begins instead: seconds since the log's first
    /// row, or a time of its clock
    #[arg(long, value_name = "TIME")]
    from: Option<String>,
    /// Where it ends instead
    #[arg(long, value_name = "TIME")]
    to: Option<String>,
    /// The event's name; that of the log's file otherwise
    #[arg(long)]
    name: Option<String>,
}

impl Arguments {
    pub(super) fn run(&self) -> Result<Answer> {
        let options = self.options();
        let folders = options.folders();
        let within: Vec<String> =
            folders.iter().map(|name| format!("{name}/")).collect();
        let names: Vec<&str> = match within.is_empty() {
            true => FILES.to_vec(),
            false => within.iter().map(String::as_str).collect(),
        };
        let results = Results::ready(self.out.as_deref(), &names, &[])?;
        let all = import_all(&options)?;
        let wrote = results
            .write(|| Ok(all.iter().flat_map(Imported::files).collect()));
        let width = width();
        let each = all.iter().map(|one| told(one, width));
        let mut text = each.collect::<Vec<_>>().join("\n");
        text.push_str(&results.told(&wrote, &names, width));
        text.push_str(&match &self.out {
            None => "\nNothing was written: give --out DIR.\n".to_owned(),
            Some(out) if wrote.is_ok() => next(out, &folders),
            Some(_) => String::new(),
        });
        Ok(Answer::from(text).after(wrote))
    }

    /// The same without a folder or a terminal.
    pub(super) fn made(&self) -> Result<Made> {
        let all = import_all(&self.options())?;
        let files = all.iter().flat_map(Imported::files);
        let files = files.map(|(name, text)| (name.into(), text.into()));
        let (files, reads) = (files.collect(), Vec::new());
        Ok(Made { files, reads, data: Ok(InferenceData::default()) })
    }

    fn options(&self) -> Options {
        let mut options = Options::of_logs(&self.logs);
        options.front.clone_from(&self.front);
        options.avaframe.clone_from(&self.avaframe);
        options.simulation.clone_from(&self.simulation);
        options.particles.clone_from(&self.particle);
        options.columns.clone_from(&self.columns);
        options.terrain.clone_from(&self.terrain);
        options.path.clone_from(&self.path);
        options.crs.clone_from(&self.crs);
        options.smooth = self.smooth;
        options.threshold = self.threshold;
        options.margin = self.margin;
        options.from.clone_from(&self.from);
        options.to.clone_from(&self.to);
        options.name.clone_from(&self.name);
        options
    }
}

/// What was done and what is doubted, under the recording's folder where it
/// has one.
fn told(one: &Imported, width: usize) -> String {
    let mut text = match one.folder.is_empty() {
        true => String::new(),
        false => format!("{}:\n", one.folder),
    };
    for line in one.told().lines() {
        // Below a dash, lines begin where its first one does.
        let below = if line.starts_with("- ") { "\n  " } else { "\n" };
        text.push_str(&wrap(line, width - 2).join(below));
        text.push('\n');
    }
    text
}

/// The command to go on with, as a shell takes it.
fn next(out: &Path, folders: &[String]) -> String {
    let word = |path: &Path| quoted_word(&path.to_string_lossy());
    if folders.is_empty() {
        return format!("\n    couloir calibrate {}\n", word(out));
    }
    let all = folders.iter().map(|name| word(&out.join(name)));
    let all: Vec<_> = all.collect();
    format!("\n    couloir diagnose {} --one-law\n", all.join(" "))
}
