//! From the command line to a model: the event, with what was changed of it.

use super::Subject;
use crate::error::{Error, Result};
use crate::io::{self, EventFile};
use crate::mechanism::catalogue::find;
use crate::model::{Assembled, Program};
use crate::noise;
use crate::physics::friction::Laws;

impl Subject {
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
        let place = file.path.display();
        let thin = self.thin.apply(&file.event);
        let (event, said) = thin.map_err(|e| e.within(place))?;
        file.event = event;
        Ok((file, said))
    }

    /// The model, with the laws that the command line may have changed.
    pub(super) fn model(&self, laws: &Laws) -> Result<Assembled> {
        self.model_told(laws).map(|(model, _)| model)
    }

    /// The same, and how its recordings were thinned.
    pub(super) fn model_told(
        &self,
        laws: &Laws,
    ) -> Result<(Assembled, Vec<String>)> {
        let (file, said) = self.load_told(laws)?;
        let own = self.friction.is_none() && self.noise.is_none();
        let place = file.path.display().to_string();
        let friction = self.friction.clone();
        let noise = self.noise.clone();
        let priors = file.priors.clone();
        let model = assemble(file, laws, friction, noise, None)?;
        if own {
            model.check_priors(&priors).map_err(|e| e.within(place))?;
        }
        Ok((model, said))
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
        let named =
            assemble(file, laws, friction.clone(), noise.clone(), None)?;
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
    let place = file.path.display().to_string();
    if file.event.recordings().next().is_none() {
        return Err(Error::input("the event has no recording").within(place));
    }
    let (labels, at) = match mechanisms {
        Some(labels) => (labels, "--model".to_owned()),
        None => (file.mechanisms, file.mechanisms_at),
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
        .map_err(|e| e.within(at))
}
