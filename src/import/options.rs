//! What is imported, and how.

use std::path::PathBuf;

use crate::error::{Error, Result};

/// What is imported, and how.
///
/// ```
/// let mut options = couloir::import::Options::new("log.csv");
/// options.smooth = 10.0;
/// assert_eq!(options.threshold, 0.6);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// The log: a table of text with a header, or GPX.
    pub log: PathBuf,
    /// Columns by name, as `--columns` has them.
    pub columns: Option<String>,
    /// A terrain model, an ESRI ASCII grid.
    pub terrain: Option<PathBuf>,
    /// A path, a shapefile or GeoJSON.
    pub path: Option<PathBuf>,
    /// The projection of terrain and path: an EPSG code, or a PROJ string.
    pub crs: Option<String>,
    /// The length over which elevations are smoothed \[m\].
    pub smooth: f64,
    /// The speed above which the mass moves \[m/s\].
    pub threshold: f64,
    /// How much is kept before and after that \[s\].
    pub margin: f64,
    /// Where the recording begins, instead: seconds since the log's first
    /// row, or a time of its clock.
    pub from: Option<String>,
    /// Where it ends, instead.
    pub to: Option<String>,
    /// The event's name, instead of the log's.
    pub name: Option<String>,
}

impl Options {
    /// A log by itself, with the defaults of the command.
    pub fn new(log: impl Into<PathBuf>) -> Self {
        Self {
            log: log.into(),
            columns: None,
            terrain: None,
            path: None,
            crs: None,
            smooth: 20.0,
            threshold: 0.6,
            margin: 0.0,
            from: None,
            to: None,
            name: None,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        for (name, value, unit, most) in [
            ("--smooth", self.smooth, "metres", 1000.0),
            ("--threshold", self.threshold, "m/s", 100.0),
            ("--margin", self.margin, "seconds", 600.0),
        ] {
            if !(0.0..=most).contains(&value) {
                return Err(Error::input(format!(
                    "{name}: found {value}; expected {unit} from 0 to {most}"
                )));
            }
        }
        Ok(())
    }
}
