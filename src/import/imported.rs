//! What an import ends in.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use super::case::Case;
use super::doubts::doubts;
use super::options::Options;
use super::work::work_out;
use super::{event, picture};
use crate::error::{Error, Result};
use crate::io::parse_event;
use crate::physics::friction::Laws;
use crate::report::text::plain;

/// An event made of a log.
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

/// Makes an event of a log, with a terrain model and a path where there are
/// any. Nothing is written.
///
/// # Errors
/// An input error where a file is not what it should be, or the files do not
/// belong together; its message names the file and the line, what was found,
/// what was expected, and the mend.
pub fn import(options: &Options) -> Result<Imported> {
    let case = work_out(options).map_err(|e| e.on_page("event"))?;
    let lines = |all: Vec<String>| -> Vec<String> {
        all.iter().map(|text| plain(text)).collect()
    };
    let mut imported = Imported {
        event: event::toml(&case),
        track: event::track(&case),
        recording: event::recording(&case),
        picture: picture::draw(&case),
        begin: case.begin(),
        length: case.distances().last().copied().unwrap_or(0.0),
        said: Vec::new(),
        doubts: lines(doubts(&case)),
    };
    imported.check()?;
    imported.said = lines(said(case));
    Ok(imported)
}

/// What was done, with the size of what came out.
fn said(case: Case) -> Vec<String> {
    let top = case.recorded.iter().copied().fold(0.0, f64::max);
    let way = case.distances().last().copied().unwrap_or(0.0);
    let ends = case.ground.at(0.0).zip(case.ground.at(way));
    let (from, to) = ends.unwrap_or_default();
    let mut said = case.said;
    said.push(format!(
        "The recording goes {way:.1} m far and {:.1} m down, from {from:.1} \
         to {to:.1} m; its top speed is {top:.2} m/s.",
        from - to
    ));
    said
}

impl Imported {
    /// Makes sure that the event can be read as any other, and takes over
    /// what reading it warns of.
    fn check(&mut self) -> Result<()> {
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
                error.within(
                    "the event that would be written; take another part of \
                     the log with --from and --to, or other columns",
                )
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

    /// The files of the event folder, by their names.
    pub fn files(&self) -> Vec<(&'static str, String)> {
        let texts = [
            self.event.clone(),
            self.track.clone(),
            self.recording.clone(),
            self.picture.clone(),
            self.told(),
        ];
        FILES.into_iter().zip(texts).collect()
    }
}

/// The names of the files of an event folder.
pub const FILES: [&str; 5] =
    ["event.toml", "track.csv", "recording.csv", "import.svg", "import.txt"];
