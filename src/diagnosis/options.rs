//! What to know of a model before it is diagnosed.

use std::sync::Arc;

use crate::diagnosis::decide::judge::Odds;
use crate::diagnosis::tell::paste::declarations;
use crate::diagnosis::together::Together;
use crate::mechanism::Mechanism;
use crate::model::Assembled;

/// What to know of a model before it is diagnosed.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Options {
    /// Where all random numbers start.
    pub seed: u64,
    /// The user's odds.
    pub odds: Odds,
    /// The friction law's name, a sum of blocks: "coulomb + turbulent".
    pub friction: String,
    /// The noise's name: "ar(1)".
    pub noise: String,
    /// What is not looked for, since the model has it: the names of its laws,
    /// of its noise (without its order) and of its mechanisms.
    pub blocks: Vec<String>,
    /// The mechanisms that the model has already.
    pub mechanisms: Vec<Arc<dyn Mechanism>>,
    /// Friction and errors as `model!` declares them, where that is known.
    pub declarations: Option<[String; 2]>,
}

impl Options {
    /// Those of a model put together from an event file.
    pub fn of(model: &Assembled, seed: u64) -> Self {
        Self {
            seed,
            odds: Odds::new(),
            friction: model.friction(),
            noise: model.noise(),
            blocks: model.blocks(),
            mechanisms: model.mechanisms().cloned().collect(),
            declarations: declarations(model),
        }
    }

    /// Those of several events under one model.
    pub fn of_all(together: &Together, seed: u64) -> Self {
        let mut all = Self { seed, ..Self::default() };
        for event in together.events() {
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
            for mechanism in event.mechanisms() {
                if !all.labels().contains(&mechanism.label()) {
                    all.mechanisms.push(Arc::clone(mechanism));
                }
            }
            all.blocks.extend(event.blocks());
        }
        all
    }

    /// The labels of the mechanisms that the model has already.
    pub(crate) fn labels(&self) -> Vec<String> {
        self.mechanisms.iter().map(|m| m.label()).collect()
    }
}
