//! What is imported, and how.

use std::path::{Path, PathBuf};

use super::particle::Particle;
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
    /// A project of AvaFrame, with the tables that com1DFA wrote of its
    /// particles. Its terrain model and its path stand in for those that are
    /// not given.
    pub avaframe: Option<PathBuf>,
    /// The simulation of the project, where there are several.
    pub simulation: Option<String>,
    /// What is taken of its particles; where there is none, their mean.
    pub particles: Vec<Particle>,
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
            avaframe: None,
            simulation: None,
            particles: Vec::new(),
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
        let files = self.logs.iter().chain(&self.front);
        let files = files.map(|file| folder(file));
        let particles = self.particles().iter().map(Particle::to_string);
        let all: Vec<String> = files.chain(particles).collect();
        if all.len() < 2 {
            return Vec::new();
        }
        let mut folders: Vec<String> = Vec::new();
        for name in all {
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

    /// The particles that are taken of a project of AvaFrame.
    pub(super) fn particles(&self) -> &[Particle] {
        match (&self.avaframe, self.particles.is_empty()) {
            (None, _) => &[],
            (Some(_), true) => &[Particle::Mean],
            (Some(_), false) => &self.particles,
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
        let files = self.logs.iter().chain(&self.front).count();
        let count = files + self.particles().len();
        let of_project = [
            ("--simulation", self.simulation.is_some()),
            ("--particle", !self.particles.is_empty()),
        ];
        for (name, _) in of_project.iter().filter(|(_, is_given)| *is_given) {
            if self.avaframe.is_none() {
                return Err(Error::input(format!(
                    "{name}: is given, and there is no simulation; expected \
                     a project of AvaFrame with it: add --avaframe DIR, or \
                     leave it out"
                )));
            }
        }
        if count == 0 {
            return Err(Error::input(
                "there is no recording; expected a log, a front, or a \
                 simulation: give the file of a log, --front FILE, or \
                 --avaframe DIR",
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
