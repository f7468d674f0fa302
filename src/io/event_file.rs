//! Event files: what somebody measured and the model to fit, read from
//! `event.toml` and the data files beside it.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Take};
use std::path::{Path, PathBuf};

use super::csv_file::{depth_of, recording_of, track_of};
use super::document::{Document, Section};
use super::doubtful::{doubts, slope_in_radians, would_fit};
use super::outside::Outside;
use super::source;
use super::words::{either, place, quoted};
use crate::error::{Error, Result, Stop};
use crate::noise::{self, Grid, NoiseEntry, NoiseFor, is_inferred, stand_in};
use crate::observe::{Event, Quantity, Series};
use crate::physics::friction::{LawSum, Laws};
use crate::physics::{Depth, Track};
use crate::prior::AnyPrior;
use crate::scalar::{Plain, Real};
use crate::spelling::nearest;

/// What may stand at the top of an event.toml.
const KEYS: [&str; 8] = [
    "name",
    "event",
    "track",
    "release",
    "flow",
    "recording",
    "model",
    "priors",
];

/// No flow is as deep [m].
const DEEPEST: f64 = 1000.0;

/// The most bytes that an event.toml may have.
pub(super) const MOST_BYTES: u64 = 1 << 20;

/// An event with the model that its file asks for.
///
/// What a file leaves out is: `event.start` 0, `track.origin` 0, `release.x`
/// the track's first point, `release.velocity` 0, `flow.depth` 1 m (then xi
/// stands for the product xi h), `recording.window` 0, `model.friction`
/// "voellmy", `model.noise` "iid", and the blocks' own priors. The noise
/// "infer" is whichever is likely.
#[derive(Debug)]
#[non_exhaustive]
pub struct EventFile {
    /// The terrain, the start, and what was recorded.
    pub event: Event,
    /// The friction law.
    pub friction: LawSum,
    /// The noise; where it is to be inferred, the one to begin with.
    pub noise: Box<dyn NoiseEntry>,
    /// Whether it is to be inferred.
    pub infers_noise: bool,
    /// Priors by the names of their parameters; whether the model has such
    /// parameters is not checked here.
    pub priors: BTreeMap<String, AnyPrior>,
    /// How a message about each begins: the file and the line.
    pub priors_at: BTreeMap<String, String>,
    /// Mechanisms that a diagnosis added, by their labels; whether there are
    /// such is not checked here.
    pub mechanisms: Vec<String>,
    /// How a message about them begins: the file, the line and the key.
    pub mechanisms_at: String,
    /// The event.toml, as the user gave it.
    pub path: PathBuf,
    /// Whether it gives a flow depth.
    pub has_depth: bool,
    /// What was read otherwise than may be expected, in sentences.
    pub notes: Vec<String>,
    /// What could be true and hardly is, each with the file.
    pub warnings: Vec<String>,
}

/// Loads an event from its folder or its event.toml.
///
/// # Errors
/// An input error for anything in the files that is not as it should be; its
/// message is one line that names the file, the line or key, what was found,
/// what was expected, and the mend.
pub fn load(path: &Path, laws: &Laws) -> Result<EventFile> {
    read(path, laws).map_err(|error| error.on_page("formats"))
}

fn read(path: &Path, laws: &Laws) -> Result<EventFile> {
    let file = find(path)?;
    let text = source::read_text(&file, MOST_BYTES)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let outside = Outside::of(folder);
    let open = |name: &str| {
        let path = folder.join(name);
        let file = source::open_data(&path)?;
        outside.note(&path);
        Ok((file, path))
    };
    parse_event::<Take<File>>(&text, &file, open, laws)
        .map_err(|error| outside.kept_to_itself(error))
}

/// The event.toml that a path given by the user means.
pub(super) fn find(path: &Path) -> Result<PathBuf> {
    let called = place(path);
    if !path.exists() {
        return Err(Error::input(format!(
            "{called}: does not exist; expected an event folder or its \
             event.toml: check the path, or write one with `couloir new \
             FOLDER`"
        )));
    }
    if path.is_dir() {
        let file = path.join("event.toml");
        if !file.exists() {
            return Err(Error::input(format!(
                "{called}: has no event.toml in it; expected an event \
                 folder: check the path, or write one with `couloir new \
                 FOLDER`"
            )));
        }
        return Ok(file);
    }
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
        return Err(Error::input(format!(
            "{called}: is a data file; expected an event folder or its \
             event.toml: give the one that names this file"
        )));
    }
    Ok(path.to_owned())
}

/// Reads the text of an event.toml. `path` is what messages call it; `open`
/// gives the source of a data file by the name in the text, and what messages
/// call that source.
///
/// # Errors
/// As in [`load`], and those of `open`.
pub fn parse_event<R: Read>(
    text: &str,
    path: &Path,
    open: impl Fn(&str) -> Result<(R, PathBuf)>,
    laws: &Laws,
) -> Result<EventFile> {
    let document = Document::parse(text, path)?;
    let top = document.top();
    top.only(&KEYS)?;
    let model = Model::read(&top, laws)?;
    let Priors { priors, at: priors_at } =
        Priors::read(&top.section("priors")?)?;
    let mut notes = Vec::new();
    let event = read_event(&top, &open, &mut notes)?;
    let slope = top.section("track")?.number("slope")?;
    let warnings = doubts(&event, slope).into_iter();
    let warnings = warnings.map(|w| format!("{}: {w}", place(path))).collect();
    let has_depth = top.section("flow")?.has("depth");
    let noise = model.noise_of(&event)?;
    let mechanisms_at = model.section.spot("mechanisms");
    let Model { friction, noise: named, mechanisms, .. } = model;
    let path = path.to_owned();
    Ok(EventFile {
        event,
        friction,
        noise,
        infers_noise: is_inferred(&named),
        priors,
        priors_at,
        mechanisms,
        mechanisms_at,
        path,
        has_depth,
        notes,
        warnings,
    })
}

type Open<'o, R> = &'o dyn Fn(&str) -> Result<(R, PathBuf)>;

/// A note on the columns of a file that are not used, where there are any.
fn note_unused(notes: &mut Vec<String>, path: &Path, unused: &[String]) {
    if !unused.is_empty() {
        let names: Vec<_> = unused.iter().map(|name| quoted(name)).collect();
        let (file, names) = (place(path), names.join(", "));
        notes.push(format!("Not used of {file}: {names}."));
    }
}

fn read_event<R: Read>(
    top: &Section,
    open: Open<R>,
    notes: &mut Vec<String>,
) -> Result<Event> {
    let depth = read_flow(&top.section("flow")?, open, notes)?;
    let track = read_track_section(top, open, notes)?;
    let still = at_rest(top, track, depth)?;
    let recording = top.section("recording")?;
    recording.only(&["file", "quantity", "window"])?;
    let quantity = read_quantity(&recording)?;
    let Some(file) = recording.text("file")? else {
        return Err(recording.missing("file", "file = \"recording.csv\""));
    };
    let (source, path) =
        open(file).map_err(|error| recording.about("file", error))?;
    let window = recording.number("window")?.unwrap_or(0.0);
    let (series, unused) = recording_of(source, quantity, &path)?;
    note_unused(notes, &path, &unused);
    let series = series
        .with_window(window)
        .map_err(|error| recording.about("window", error))?;
    // Before anything that would follow from it.
    let track = top.section("track")?;
    let slope = track.number("slope")?;
    let radians = slope.and_then(|s| slope_in_radians(&still, &series, s));
    if let Some(message) = radians {
        return Err(track.at("slope", message));
    }
    still.with_recording(series.clone()).map_err(|error| {
        let too_long = error.to_string().contains("the track has only");
        let fit = match too_long {
            true => would_fit(&still, &series, slope),
            false => String::new(),
        };
        let error = Error::input(format!("{error}{fit}"));
        recording.about("file", error.within(place(&path)))
    })
}

fn read_quantity(recording: &Section) -> Result<Quantity> {
    let names = Quantity::ALL.map(Quantity::name);
    let Some(found) = recording.text("quantity")? else {
        let mend = format!("quantity = {}", either(&names));
        return Err(recording.missing("quantity", &mend));
    };
    let known = Quantity::ALL.into_iter().find(|q| q.name() == found);
    known.ok_or_else(|| {
        let mend = match nearest(found, &names) {
            Some(name) => format!("; did you mean {name:?}?"),
            None => ": convert the recording to one of them".to_owned(),
        };
        let expected = either(&names);
        recording.at(
            "quantity",
            format!("is {}; expected {expected}{mend}", quoted(found)),
        )
    })
}

/// The track, from its file or as a constant slope.
fn read_track_section<R: Read>(
    top: &Section,
    open: Open<R>,
    notes: &mut Vec<String>,
) -> Result<Track> {
    let section = top.section("track")?;
    section.only(&["file", "slope", "length", "origin"])?;
    let origin = section.number("origin")?.unwrap_or(0.0);
    let slope = section.number("slope")?;
    let length = section.number("length")?;
    let track = match (section.text("file")?, slope, length) {
        (Some(file), None, None) => {
            let (source, path) =
                open(file).map_err(|error| section.about("file", error))?;
            let (track, unused) = track_of(source, &path)?;
            note_unused(notes, &path, &unused);
            track
        }
        (None, Some(slope), Some(length)) => incline(&section, slope, length)?,
        (Some(_), ..) => {
            return Err(section.at(
                "file",
                "stands beside track.slope or track.length; expected the one \
                 or the others: drop file, or slope and length",
            ));
        }
        (None, Some(_), None) => {
            return Err(section.missing("length", "length = METRES"));
        }
        (None, None, Some(_)) => {
            return Err(section.missing("slope", "slope = DEGREES"));
        }
        (None, None, None) => {
            return Err(section.missing(
                "file",
                "file = \"track.csv\", or slope = DEGREES and length = METRES",
            ));
        }
    };
    Ok(track.with_origin(origin))
}

fn incline(section: &Section, slope: f64, length: f64) -> Result<Track> {
    // Each on its own, so that an error names the right key.
    Track::incline(slope, 1.0)
        .map_err(|error| section.about("slope", error))?;
    Track::incline(slope, length)
        .map_err(|error| section.about("length", error))
}

/// The flow depth, a number or a file of them.
fn read_flow<R: Read>(
    flow: &Section,
    open: Open<R>,
    notes: &mut Vec<String>,
) -> Result<Depth> {
    flow.only(&["depth"])?;
    if flow.is_text("depth")
        && let Some(file) = flow.text("depth")?
    {
        if file.trim().parse::<f64>().is_ok() {
            return Err(flow.at(
                "depth",
                format!(
                    "is the text {}; expected a number or the name of a \
                     file: drop the quotes",
                    quoted(file)
                ),
            ));
        }
        let (source, path) =
            open(file).map_err(|error| flow.about("depth", error))?;
        let (depth, unused) = depth_of(source, &path)?;
        note_unused(notes, &path, &unused);
        return Ok(depth);
    }
    let depth = flow.number("depth")?.unwrap_or(1.0);
    if depth <= 0.0 {
        return Err(flow.at(
            "depth",
            format!("is {depth}; expected metres, more than 0"),
        ));
    }
    if depth >= DEEPEST {
        return Err(flow.at(
            "depth",
            format!(
                "is {depth}; expected metres, and no flow has {DEEPEST} of \
                 them: if these are millimetres, write depth = {}",
                depth / 1000.0
            ),
        ));
    }
    Ok(Depth::Even(depth))
}

/// The event before anything was recorded.
fn at_rest(top: &Section, track: Track, depth: Depth) -> Result<Event> {
    let (clock, release) = (top.section("event")?, top.section("release")?);
    clock.only(&["start"])?;
    let start = clock.number("start")?.unwrap_or(0.0);
    release.only(&["x", "velocity"])?;
    let velocity = release.number("velocity")?.unwrap_or(0.0);
    if velocity < 0.0 {
        return Err(release.at(
            "velocity",
            format!("is {velocity}; expected m/s down the track, 0 or more"),
        ));
    }
    let x = release.number("x")?.unwrap_or(track.points().0[0]);
    track.distance_at(x).map_err(|error| release.about("x", error))?;
    if let Depth::Along(rows) = &depth {
        let flow = top.section("flow")?;
        track.with_depths(rows).map_err(|error| flow.about("depth", error))?;
    }
    let name = top.text("name")?.unwrap_or("event");
    Event::on(track)
        .named(name)
        .release(x, velocity)
        .depth(depth)
        .clock(start)
        .build()
        .map_err(|error| release.about("x", error))
}

/// The section `[model]`.
struct Model<'d> {
    section: Section<'d>,
    friction: LawSum,
    noise: String,
    mechanisms: Vec<String>,
}

impl<'d> Model<'d> {
    fn read(top: &Section<'d>, laws: &Laws) -> Result<Self> {
        let section = top.section("model")?;
        section.only(&["friction", "noise", "mechanisms"])?;
        let text = section.text("friction")?.unwrap_or("voellmy");
        let friction = laws
            .parse(text)
            .map_err(|error| section.about("friction", error))?;
        let noise = section.text("noise")?.unwrap_or("iid").to_owned();
        if !is_inferred(&noise) {
            noise::parse(&noise)
                .map_err(|error| section.about("noise", error))?;
        }
        let mechanisms = section.texts("mechanisms")?;
        let mechanisms = mechanisms.into_iter().map(str::to_owned).collect();
        Ok(Self { section, friction, noise, mechanisms })
    }

    /// The noise of an event's recordings.
    fn noise_of(&self, event: &Event) -> Result<Box<dyn NoiseEntry>> {
        let name = match is_inferred(&self.noise) {
            true => stand_in(event.recordings().map(Series::grid)),
            false => &self.noise,
        };
        let noise = noise::parse(name)?;
        for series in event.recordings() {
            check_noise(noise.as_ref(), series.grid())
                .map_err(|error| self.section.about("noise", error))?;
        }
        Ok(noise)
    }
}

/// Priors by parameter, and where each stands. A name of two parts, such as
/// `coulomb.mu`, may stand bare or in quotes.
#[derive(Default)]
struct Priors {
    priors: BTreeMap<String, AnyPrior>,
    at: BTreeMap<String, String>,
}

impl Priors {
    fn read(section: &Section) -> Result<Self> {
        let mut all = Self::default();
        for key in section.keys() {
            if !section.is_section(key) {
                all.take(section, key, key.to_owned())?;
                continue;
            }
            let block = section.section(key)?;
            for field in block.keys() {
                all.take(&block, field, format!("{key}.{field}"))?;
            }
        }
        Ok(all)
    }

    fn take(
        &mut self,
        section: &Section,
        key: &str,
        name: String,
    ) -> Result<()> {
        let prior = read_prior(section, key)?;
        self.at.insert(name.clone(), section.line_of(key));
        self.priors.insert(name, prior);
        Ok(())
    }
}

fn read_prior(section: &Section, key: &str) -> Result<AnyPrior> {
    let expected = "a distribution in quotes, such as \"Gamma(9, 0.03)\"";
    let text = section.text_as(key, expected)?.unwrap_or("");
    AnyPrior::parse(text).map_err(|error| section.about(key, error))
}

/// Whether a noise is defined at the times of a recording. That hangs on how
/// many parameters it has, not on their values.
fn check_noise(noise: &dyn NoiseEntry, grid: &Grid) -> Result<()> {
    let values = vec![Real::<Plain>::new(0.1); noise.parameters().len()];
    let mut answer = Ok(());
    let asked = NoiseFor::<Plain>::with(noise, &values, &mut |noise| {
        answer = noise.check(grid);
    });
    match asked {
        Ok(()) => answer,
        Err(Stop::Fail(error)) => Err(error),
        Err(Stop::Reject(why)) => Err(Error::input(why)),
    }
}
