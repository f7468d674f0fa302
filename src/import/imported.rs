//! What an import ends in.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use super::case::Case;
use super::doubts::doubts;
use super::options::Options;
use super::work::work_out;
use super::{event, picture};
use crate::error::{Error, Result};
use crate::io::{parse_event, place};
use crate::physics::friction::Laws;
use crate::report::text::plain;

/// An event made of a recording.
///
/// ```no_run
/// use couloir::import::{Options, import};
/// let mut options = Options::new("gnss.txt");
/// options.terrain = Some("terrain.asc".into());
/// options.crs = Some("EPSG:31254".into());
/// let imported = import(&options)?;
/// couloir::io::write_all("event".as_ref(), &imported.files())?;
/// # Ok::<(), couloir::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Imported {
    /// The folder of its files, within the one that all are written to; none
    /// where there is one recording only.
    pub folder: String,
    /// The event.toml.
    pub event: String,
    /// The track.csv.
    pub track: String,
    /// The recording.csv.
    pub recording: String,
    /// The picture, an SVG document.
    pub picture: String,
    /// Seconds from the log's first row to t = 0.
    pub begin: f64,
    /// The horizontal distance that the recording covers \[m\].
    pub length: f64,
    /// What was done, in sentences.
    pub said: Vec<String>,
    /// What there is to doubt, in sentences.
    pub doubts: Vec<String>,
}

/// Makes an event of one recording, with a terrain model and a path where
/// there are any. Nothing is written.
///
/// # Errors
/// As [`import_all`], and where there are several recordings.
pub fn import(options: &Options) -> Result<Imported> {
    let all = import_all(options)?;
    let [one] = <[Imported; 1]>::try_from(all).map_err(|all| {
        Error::input(format!(
            "there are {} recordings; expected one: give one log or one \
             front, or use `import_all`",
            all.len()
        ))
    })?;
    Ok(one)
}

/// Makes an event of each recording, on one path and one track. Nothing is
/// written.
///
/// ```no_run
/// use couloir::import::{Options, import_all};
/// let mut options = Options::of_logs(["particle-1.csv", "particle-2.csv"]);
/// options.front = Some("front.csv".into());
/// options.terrain = Some("terrain.tif".into());
/// options.path = Some("path.shp".into());
/// for event in import_all(&options)? {
///     couloir::io::write_all("events".as_ref(), &event.files())?;
/// }
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// An input error where a file is not what it should be, or the files do not
/// belong together; its message names the file and the line, what was found,
/// what was expected, and the mend.
pub fn import_all(options: &Options) -> Result<Vec<Imported>> {
    let mut folders = options.folders().into_iter();
    let cases = work_out(options).map_err(|e| e.on_page("event"))?.into_iter();
    cases.map(|case| of(case, folders.next().unwrap_or_default())).collect()
}

/// What one recording ends in.
fn of(case: Case, folder: String) -> Result<Imported> {
    let (first, last) = case.ends();
    let told = |all: Vec<String>| -> Vec<String> {
        all.iter().map(|text| plain(text)).collect()
    };
    let mut imported = Imported {
        folder,
        event: event::toml(&case),
        track: event::track(&case),
        recording: event::recording(&case),
        picture: picture::draw(&case),
        begin: case.moving.begin(),
        length: last - first,
        said: Vec::new(),
        doubts: told(doubts(&case)),
    };
    let rows = case.moving.rows();
    let lines = rows.first().zip(rows.last()).map(|(a, b)| (a.row, b.row));
    imported.check(&case.moving.log.path, lines.unwrap_or_default())?;
    imported.said = told(said(case));
    Ok(imported)
}

/// What was done, with the size of what came out.
fn said(case: Case) -> Vec<String> {
    let top = case.recorded.iter().copied().fold(0.0, f64::max);
    let (first, last) = case.ends();
    let way = last - first;
    let ends = case.ground.at(first).zip(case.ground.at(last));
    let (from, to) = ends.unwrap_or_default();
    let mut said = case.moving.said;
    said.push(format!(
        "The recording goes {way:.1} m far and {:.1} m down, from {from:.1} \
         to {to:.1} m; its top speed is {top:.2} m/s.",
        from - to
    ));
    said
}

impl Imported {
    /// Makes sure that the event can be read as any other, and takes over
    /// what reading it warns of. It is made of these rows of a log.
    fn check(&mut self, log: &Path, (from, to): (u64, u64)) -> Result<()> {
        let open = |name: &str| match name {
            "track.csv" => Ok((Cursor::new(&self.track), PathBuf::from(name))),
            "recording.csv" => {
                Ok((Cursor::new(&self.recording), PathBuf::from(name)))
            }
            _ => Err(Error::system(format!("the event has no {name:?}"))),
        };
        let path = Path::new("event.toml");
        let file = parse_event(&self.event, path, open, &Laws::default())
            .map_err(|error| {
                error.within(format!(
                    "{}: the event that would be written of its rows {from} \
                     to {to}; mend these, take another part of the log with \
                     --from and --to, or other columns",
                    place(log)
                ))
            })?;
        self.doubts.extend(file.warnings.iter().map(|text| plain(text)));
        Ok(())
    }

    /// What was done and what is doubted, a sentence or two a line.
    pub fn told(&self) -> String {
        let mut text = String::new();
        for line in &self.said {
            text.push_str(line);
            text.push('\n');
        }
        text.push_str(match self.doubts.is_empty() {
            true => "\nNothing to doubt was found.\n",
            false => "\nTo be doubted:\n",
        });
        for line in &self.doubts {
            text.push_str(&format!("- {line}\n"));
        }
        text
    }

    /// The files of the event folder, by their names, with the recording's
    /// own folder before them where there are several.
    pub fn files(&self) -> Vec<(String, String)> {
        let texts = [
            self.event.clone(),
            self.track.clone(),
            self.recording.clone(),
            self.picture.clone(),
            self.told(),
        ];
        let name = |file: &str| match self.folder.is_empty() {
            true => file.to_owned(),
            false => format!("{}/{file}", self.folder),
        };
        FILES.into_iter().map(name).zip(texts).collect()
    }
}

/// The names of the files of an event folder.
pub const FILES: [&str; 5] =
    ["event.toml", "track.csv", "recording.csv", "import.svg", "import.txt"];
