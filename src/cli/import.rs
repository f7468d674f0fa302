//! `couloir import`: an event folder from a log, a terrain model and a path.

use std::path::PathBuf;

use clap::Args;

use super::answer::Answer;
use super::made::Made;
use super::results::{Results, folder};
use super::width;
use crate::error::Result;
use crate::export::InferenceData;
use crate::import::{FILES, Options, import};
use crate::report::text::wrap;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The log of a GNSS sensor: a table of text with a header (u-blox logs,
    /// any CSV), or GPX
    log: PathBuf,
    /// The event folder to write; without it nothing is written
    #[arg(long, value_name = "DIR", value_parser = folder)]
    out: Option<PathBuf>,
    /// Columns of the log by name and unit, such as
    /// "time=UTC,speed=v_kmh:km/h"; there are time (s, ms, hh:mm:ss), lon,
    /// lat (deg), x, y, height (m), speed, ground-speed, vel-north, vel-east,
    /// vel-down (m/s, km/h), satellites, fix
    #[arg(long, value_name = "COLUMNS")]
    columns: Option<String>,
    /// A terrain model, an ESRI ASCII grid
    #[arg(long, value_name = "FILE")]
    terrain: Option<PathBuf>,
    /// The path, a shapefile or GeoJSON; the log's own positions otherwise
    #[arg(long, value_name = "FILE")]
    path: Option<PathBuf>,
    /// The projection of terrain and path, such as EPSG:31254, or a PROJ
    /// string
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
        let results = Results::ready(self.out.as_deref(), &FILES, &[])?;
        let imported = import(&self.options())?;
        let wrote = results.write(|| Ok(imported.files()));
        let width = width();
        let mut text = String::new();
        for line in imported.told().lines() {
            // Below a dash, lines begin where its first one does.
            let below = if line.starts_with("- ") { "\n  " } else { "\n" };
            text.push_str(&wrap(line, width - 2).join(below));
            text.push('\n');
        }
        text.push_str(&results.told(&wrote, &FILES, width));
        text.push_str(&match &self.out {
            None => "\nNothing was written: give --out DIR.\n".to_owned(),
            Some(out) if wrote.is_ok() => {
                format!("\n    couloir calibrate {}\n", out.display())
            }
            Some(_) => String::new(),
        });
        Ok(Answer::from(text).after(wrote))
    }

    /// The same without a folder or a terminal.
    pub(super) fn made(&self) -> Result<Made> {
        let files = import(&self.options())?.files().into_iter();
        let files = files.map(|(name, text)| (name.into(), text.into()));
        Ok(Made { files: files.collect(), data: Ok(InferenceData::default()) })
    }

    fn options(&self) -> Options {
        let mut options = Options::new(&self.log);
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
