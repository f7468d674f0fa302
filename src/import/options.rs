//! What is imported, and how.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// What is imported, and how: one recording or several of one avalanche.
///
/// ```
/// use couloir::import::Options;
/// let mut options = Options::new("log.csv");
/// options.smooth = 10.0;
/// assert_eq!(options.threshold, 0.6);
/// assert!(options.folders().is_empty());
/// options.front = Some("front.csv".into());
/// assert_eq!(options.folders(), ["log", "front"]);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Logs of sensors: tables of text with a header, or GPX.
    pub logs: Vec<PathBuf>,
    /// The places of a front by time: a table with a header, of `t` \[s\] and
    /// of `x`, `y` \[m\] (or `lon`, `lat` \[degrees\]) or `s`, the horizontal
    /// distance along the path \[m\]. Rows of one time are averaged.
    pub front: Option<PathBuf>,
    /// Columns by name, as `--columns` has them.
    pub columns: Option<String>,
    /// A terrain model, an ESRI ASCII grid or a GeoTIFF.
    pub terrain: Option<PathBuf>,
    /// A path, a shapefile or GeoJSON.
    pub path: Option<PathBuf>,
    /// The projection of terrain and path: an EPSG code, or a PROJ string.
    /// Where there is none, the one that the terrain model names.
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
        Self::of_logs([log])
    }

    /// Logs of several sensors in one avalanche; none, for a front.
    pub fn of_logs<P: Into<PathBuf>>(
        logs: impl IntoIterator<Item = P>,
    ) -> Self {
        Self {
            logs: logs.into_iter().map(Into::into).collect(),
            front: None,
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

    /// The folder of each recording's event, by the names of the files; none
    /// where there is one recording only, whose event needs no folder more.
    pub fn folders(&self) -> Vec<String> {
        let files: Vec<&Path> = self
            .logs
            .iter()
            .chain(&self.front)
            .map(PathBuf::as_path)
            .collect();
        if files.len() < 2 {
            return Vec::new();
        }
        let mut folders: Vec<String> = Vec::new();
        for file in files {
            let name = folder(file);
            let mut all = (2..).map(|n| format!("{name}-{n}"));
            let taken = |n: &String| folders.contains(n);
            let next = match taken(&name) {
                false => Some(name),
                true => all.find(|name| !taken(name)),
            };
            folders.extend(next);
        }
        folders
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
        let count = self.logs.iter().chain(&self.front).count();
        if count == 0 {
            return Err(Error::input(
                "there is no recording; expected a log, or a front: give the \
                 file of a log, or --front FILE",
            ));
        }
        if count > 1 && self.name.is_some() {
            return Err(Error::input(
                "--name: is given, and there are several recordings; \
                 expected it with one only: leave it out, and each event is \
                 called as its file",
            ));
        }
        Ok(())
    }
}

/// The name of a file as that of a folder: letters, digits, `-`, `_`, `.`.
fn folder(file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| match c {
        _ if c.is_alphanumeric() => c,
        '-' | '_' | '.' => c,
        _ => '-',
    };
    let name: String = stem.chars().map(plain).collect();
    // A dot in front hides a folder, and two lead out of it.
    match name.trim_start_matches('.') {
        "" => "recording".to_owned(),
        name => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recording_has_a_folder_of_its_own() {
        let options =
            Options::of_logs(["a/gps.txt", "b/gps.txt", "gps-2.csv", ".. x"]);
        let folders = options.folders();
        assert_eq!(folders, ["gps", "gps-2", "gps-2-2", "recording"]);
        assert!(Options::of_logs(["a.csv"]).folders().is_empty());
    }

    #[test]
    fn what_is_imported_is_named() {
        let none = Options::of_logs::<PathBuf>([]);
        let error = none.check().unwrap_err().to_string();
        assert!(error.contains("give the file of a log"), "{error}");
        let mut two = Options::of_logs(["a.csv", "b.csv"]);
        assert!(two.check().is_ok());
        two.name = Some("both".to_owned());
        let error = two.check().unwrap_err().to_string();
        assert!(error.contains("--name: is given"), "{error}");
    }
}
