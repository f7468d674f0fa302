//! From the command line to a model: the event, with what was changed of it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde_json::{Map, Value};

use super::Subject;
use super::said::Said;
use crate::error::{Error, Result};
use crate::io::{self, EventFile, place};
use crate::mechanism::catalogue::find;
use crate::model::{Assembled, Program};
use crate::noise::{self, is_inferred, stand_in};
use crate::observe::{Event, Series};
use crate::physics::friction::Laws;
use crate::report::Origin;

/// A model as it was asked for.
pub(super) struct Read {
    pub(super) model: Assembled,
    /// Whether its noise is to be inferred, and stands in for another.
    pub(super) infers_noise: bool,
    pub(super) said: Said,
}

impl Subject {
    /// What it is read from; nothing where the event is the embedded one.
    pub(super) fn paths(&self) -> &[PathBuf] {
        self.event.as_slice()
    }

    /// The checksums of the files that it is read from, by their names.
    pub(super) fn inputs(&self) -> Result<BTreeMap<String, String>> {
        io::inputs(self.event.as_deref())
    }

    /// Where a result of it comes from: the files as they are now, and the
    /// command.
    pub(super) fn origin(&self, typed: &str) -> Result<Origin> {
        let (command, inputs) = (typed.to_owned(), self.inputs()?);
        Ok(Origin { command, inputs })
    }

    /// The event, the embedded one where none was named.
    pub(super) fn load(&self, laws: &Laws) -> Result<EventFile> {
        self.load_told(laws).map(|(file, _)| file)
    }

    /// The same, and how its recordings were thinned.
    fn load_told(&self, laws: &Laws) -> Result<(EventFile, Vec<String>)> {
        let mut file = match &self.event {
            Some(path) => io::load(path, laws)?,
            None => io::coastdown(laws)?,
        };
        let at = place(&file.path);
        let thin = self.thin.apply(&file.event);
        let (event, said) = thin.map_err(|e| e.within(at))?;
        file.event = event;
        Ok((file, said))
    }

    /// The same under a noise that was named.
    pub(super) fn named(&self, laws: &Laws) -> Result<Read> {
        match self.read(laws)? {
            read if !read.infers_noise => Ok(read),
            _ => Err(Error::input(
                "the noise is to be inferred; expected one noise: name it, \
                 as in --noise \"ar(1)\"",
            )),
        }
    }

    /// The model, with the laws that the command line may have changed.
    pub(super) fn read(&self, laws: &Laws) -> Result<Read> {
        let (file, thinned) = self.load_told(laws)?;
        let own = self.friction.is_none() && self.noise.is_none();
        let friction = self.friction.clone();
        let noise = self.noise_of(&file.event);
        let infers_noise = match &self.noise {
            Some(name) => is_inferred(name),
            None => file.infers_noise,
        };
        let (priors, at) = (file.priors.clone(), file.priors_at.clone());
        let mut said = Said::of(&file);
        let depth = NoDepth::of(&file);
        let model = assemble(file, laws, friction, noise, None)?;
        said.note(depth.note(&model.friction(), laws));
        said.note(thinned);
        if own {
            let first = model.unused(&priors).first().map(|k| (*k).to_owned());
            let at = first.and_then(|key| at.get(&key));
            model.check_priors(&priors).map_err(|error| match at {
                Some(line) => error.within(line),
                None => error,
            })?;
        }
        Ok(Read { model, infers_noise, said })
    }

    /// The noise that the command line names; what stands in where it is to be
    /// inferred.
    fn noise_of(&self, event: &Event) -> Option<String> {
        let name = self.noise.as_ref()?;
        Some(match is_inferred(name) {
            true => stand_in(event.recordings().map(Series::grid)).to_owned(),
            false => name.clone(),
        })
    }

    /// The event's files with these mechanisms added to its model, as far as
    /// they apply to it, and another noise where there is one.
    pub(super) fn corrected(
        &self,
        laws: &Laws,
        added: &[String],
        other: Option<&str>,
    ) -> Result<Vec<(&'static str, String)>> {
        let (friction, noise) = (self.friction.clone(), self.noise.clone());
        let file = self.load(laws)?;
        let priors = file.priors.clone();
        let known = self.noise_of(&file.event);
        let named = assemble(file, laws, friction.clone(), known, None)?;
        let before = match other {
            Some(noise) => named.with_noise(noise)?,
            None => None,
        };
        let before = before.unwrap_or(named);
        let (extent, blocks) = (before.event().extent(), before.blocks());
        let found = added
            .iter()
            .filter_map(|label| find(label, &extent, &blocks).ok())
            .collect();
        let model = before.with_mechanisms(found, &priors)?;
        let mechanisms = model.labels();
        let unused = model.without_effect(&priors);
        let unused = unused.into_iter().map(str::to_owned).collect();
        let noise = other.map(str::to_owned).or(noise);
        let recording = model.event().recordings().next();
        let recording = recording.filter(|_| !self.thin.is_none()).cloned();
        let correction =
            io::Correction { friction, noise, mechanisms, unused, recording };
        io::corrected(self.event.as_deref(), &correction)
    }
}

/// Whether an event is without a flow depth.
#[derive(Debug, Clone, Copy)]
pub(super) struct NoDepth(bool);

impl NoDepth {
    pub(super) fn of(file: &EventFile) -> Self {
        Self(!file.has_depth)
    }

    /// What a law makes of it, where it needs a depth.
    pub(super) fn note(self, friction: &str, laws: &Laws) -> Option<String> {
        let law = laws.parse(friction).ok()?;
        if !self.0 || !law.has_depth() {
            return None;
        }
        let fields = law.terms().iter().flat_map(|term| term.fields());
        let xi = match fields.into_iter().any(|field| field.name == "xi") {
            true => ", so that xi stands for the product xi h",
            false => "",
        };
        Some(format!(
            "The event gives no flow depth, which {friction} friction needs: \
             1 m was taken{xi}; if it is known, write [flow] and depth in \
             event.toml."
        ))
    }
}

/// A model of an event's own laws, noise and mechanisms, or of others by
/// name.
pub(super) fn assemble(
    file: EventFile,
    laws: &Laws,
    friction: Option<String>,
    noise: Option<String>,
    mechanisms: Option<Vec<String>>,
) -> Result<Assembled> {
    let friction = match friction {
        Some(text) => laws.parse(&text).map_err(|e| e.within("--friction"))?,
        None => file.friction,
    };
    let noise = match noise {
        Some(text) => noise::parse(&text).map_err(|e| e.within("--noise"))?,
        None => file.noise,
    };
    let place = place(&file.path);
    if file.event.recordings().next().is_none() {
        return Err(Error::input("the event has no recording").within(place));
    }
    let (labels, at) = match mechanisms {
        Some(labels) => (labels, None),
        None => (file.mechanisms, Some(file.mechanisms_at)),
    };
    let extent = file.event.extent();
    let model = Assembled::new(file.event, friction, noise, &file.priors)
        .map_err(|e| e.within(place))?;
    let blocks = model.blocks();
    labels
        .iter()
        .map(|label| find(label, &extent, &blocks))
        .collect::<Result<Vec<_>>>()
        .and_then(|found| model.with_mechanisms(found, &file.priors))
        .map_err(|error| match at {
            Some(at) => error.within(at),
            None => error,
        })
}

/// The priors of a model's parameters as documents have them, by the
/// parameters' names.
pub(super) fn priors_of(model: &Assembled) -> Map<String, Value> {
    let all = model.priors();
    all.map(|(name, prior)| (name.to_owned(), prior.to_string().into()))
        .collect()
}
