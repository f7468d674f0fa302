//! An event.toml and the data files that it names. What is taken is then
//! put together and asked for its density, at values that priors allow.

use std::path::{Path, PathBuf};

use couloir::io::{EventFile, parse_event};
use couloir::model::{Assembled, Point, Posterior};
use couloir::physics::friction::Laws;
use couloir::{Error, Seed};

const EVENT: &str = include_str!("../corpus/event/plain.toml");
const TRACK: &str = include_str!("../corpus/track/plain.csv");
const RECORDING: &str = include_str!("../corpus/recording/plain.csv");
const DEPTH: &str = include_str!("../corpus/depth/time.csv");

/// The files of an event, of which one may be another than usual.
struct Files<'f> {
    event: &'f [u8],
    track: &'f [u8],
    recording: &'f [u8],
    depth: &'f [u8],
}

impl Default for Files<'_> {
    fn default() -> Self {
        Self {
            event: EVENT.as_bytes(),
            track: TRACK.as_bytes(),
            recording: RECORDING.as_bytes(),
            depth: DEPTH.as_bytes(),
        }
    }
}

impl<'f> Files<'f> {
    fn load(&self) -> Result<EventFile, Error> {
        let Ok(text) = std::str::from_utf8(self.event) else {
            return Err(Error::input("is no text"));
        };
        let open = |name: &str| -> Result<(&'f [u8], PathBuf), Error> {
            let bytes = match name {
                "track.csv" => self.track,
                "recording.csv" => self.recording,
                "depth.csv" => self.depth,
                _ => return Err(Error::input("there is no such file")),
            };
            Ok((bytes, PathBuf::from(name)))
        };
        parse_event(text, Path::new("event.toml"), open, &Laws::default())
    }

    fn take(&self) -> Result<(), Error> {
        asked(self.load()?)
    }
}

/// An event asked for its density at draws from its priors and elsewhere:
/// no answer is a number that is none.
fn asked(file: EventFile) -> Result<(), Error> {
    let EventFile { event, friction, noise, priors, .. } = file;
    let model = Assembled::new(event, friction, noise, &priors)?;
    model.check_priors(&priors)?;
    let posterior = Posterior::new(&model)?;
    let mut rng = Seed::new(7).rng();
    if posterior.is_proper() {
        let (density, _) = posterior.draw_prior(&mut rng)?;
        assert!(!density.natural().is_nan(), "{density:?}");
    }
    for at in [0.0, -3.0] {
        let z = vec![at; posterior.dimension()];
        let density = posterior.density(Point::Line(&z))?;
        assert!(!density.on_line().is_nan(), "{density:?}");
    }
    Ok(())
}

pub(crate) fn event(_: &Path, input: &[u8]) -> Result<(), Error> {
    Files { event: input, ..Files::default() }.take()
}

pub(crate) fn track(_: &Path, input: &[u8]) -> Result<(), Error> {
    Files { track: input, ..Files::default() }.take()
}

pub(crate) fn recording(_: &Path, input: &[u8]) -> Result<(), Error> {
    Files { recording: input, ..Files::default() }.take()
}

pub(crate) fn depth(_: &Path, input: &[u8]) -> Result<(), Error> {
    let event = EVENT.replace("depth = 1.5", "depth = \"depth.csv\"");
    let files =
        Files { event: event.as_bytes(), depth: input, ..Files::default() };
    asked(files.load()?)
}
