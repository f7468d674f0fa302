//! What to know of a model before it is diagnosed.

use std::sync::Arc;

use crate::diagnosis::decide::odds::Odds;
use crate::diagnosis::declarations::declarations;
use crate::mechanism::Mechanism;
use crate::mechanism::catalogue::Catalogue;
use crate::model::{Assembled, Together};
use crate::noise::is_noise;
use crate::prior::AnyPrior;

/// What to know of a model before it is diagnosed.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Options {
    /// Where all random numbers start.
    pub seed: u64,
    /// Whether a quick look has to do: under the named noise alone, each
    /// mechanism by itself, evidences rough.
    pub quick: bool,
    /// The user's odds.
    pub odds: Odds,
    /// The friction law's name, a sum of blocks: "coulomb + turbulent"; empty
    /// for the names that the model declares.
    pub friction: String,
    /// The noise's name: "ar(1)"; empty for the one that the model declares.
    pub noise: String,
    /// Whether no noise was named, so that `noise` stands in for whichever is
    /// likely.
    pub infers_noise: bool,
    /// What is looked for: the mechanisms that come along, and further ones.
    pub catalogue: Catalogue,
    /// What is not looked for besides the laws, noises and mechanisms that
    /// the model declares, by their names.
    pub blocks: Vec<String>,
    /// The mechanisms that the model has already.
    pub mechanisms: Vec<Arc<dyn Mechanism>>,
    /// The friction law's parameters, by their names: none of a model without
    /// friction. Where they are not known, all that the model has of its own.
    pub law: Option<Vec<String>>,
    /// The priors of the model's parameters, by their names.
    pub priors: Vec<(String, String)>,
    /// Friction and errors as `model!` declares them, where that is known.
    pub declarations: Option<[String; 2]>,
}

impl Options {
    /// The same with another catalogue of mechanisms, such as one with some of
    /// the user's own.
    #[must_use]
    pub fn with_catalogue(self, catalogue: Catalogue) -> Self {
        Self { catalogue, ..self }
    }

    /// The same for a quick look.
    #[must_use]
    pub fn quickly(self) -> Self {
        Self { quick: true, ..self }
    }

    /// Those of a model put together from an event file.
    pub fn of(model: &Assembled, seed: u64) -> Self {
        Self {
            seed,
            friction: model.friction(),
            noise: model.noise(),
            mechanisms: model.mechanisms().cloned().collect(),
            law: Some(model.law_names()),
            priors: priors(model, ""),
            declarations: declarations(model),
            ..Self::default()
        }
    }

    /// Those of several events under one model.
    pub fn of_all(together: &Together<Assembled>, seed: u64) -> Self {
        let mut all = Self { seed, ..Self::default() };
        for (event, label) in together.members().iter().zip(together.labels())
        {
            all.priors.extend(priors(event, &format!("{label}.")));
            for (text, own) in [
                (&mut all.friction, event.friction()),
                (&mut all.noise, event.noise()),
            ] {
                if !text.split(" | ").any(|known| known == own) {
                    let between = if text.is_empty() { "" } else { " | " };
                    text.push_str(between);
                    text.push_str(&own);
                }
            }
            let law = all.law.get_or_insert_default();
            for name in event.law_names() {
                if !law.contains(&name) {
                    law.push(name);
                }
            }
            for mechanism in event.mechanisms() {
                if !all.labels().contains(&mechanism.label()) {
                    all.mechanisms.push(Arc::clone(mechanism));
                }
            }
        }
        all
    }

    /// The same, with what a model's own blocks say of it.
    pub(crate) fn of_blocks(&self, blocks: &[String]) -> Self {
        let mut all = self.clone();
        let (errors, laws): (Vec<_>, Vec<_>) =
            blocks.iter().cloned().partition(|name| is_noise(name));
        if all.friction.is_empty() {
            all.friction = laws.join(" + ");
        }
        if all.noise.is_empty() {
            all.noise = errors.join(" + ");
        }
        all
    }

    /// The labels of the mechanisms that the model has already.
    pub(crate) fn labels(&self) -> Vec<String> {
        self.mechanisms.iter().map(|m| m.label()).collect()
    }
}

/// The priors of a model put together from an event file, by the names of
/// their parameters after a label.
fn priors(model: &Assembled, label: &str) -> Vec<(String, String)> {
    let named = |(name, prior): (&str, &AnyPrior)| {
        (format!("{label}{name}"), prior.to_string())
    };
    model.priors().map(named).collect()
}
