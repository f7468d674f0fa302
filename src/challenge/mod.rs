//! The proof: events that hide one effect each, diagnosed without the answer,
//! and scored.
//!
//! What makes the events shares no code with what diagnoses them: no track,
//! no integrator, no friction law, no noise of the crate is used here, only
//! random numbers and the words of the file format.
//!
//! - [`cases`] draws events; [`power_cases`] one effect at given sizes.
//! - [`run`] puts them to a diagnosis and scores its [`Answer`]s.
//! - [`words`], [`page`], [`challenge_json`] and [`PowerTable`] tell it.

mod case;
mod cases;
mod clock;
mod effects;
mod errors;
mod files;
mod ground;
mod json;
mod moments;
mod motion;
mod page;
mod power;
mod scatter;
mod scenery;
mod score;
mod trial;
mod visible;

pub use case::{Case, Coordinate, Interval, Mix, Recording, Truth};
pub use cases::cases;
pub use effects::Class;
pub use json::challenge_json;
pub use page::{page, power_page, words};
pub use power::{PowerTable, mechanisms, power_cases};
pub use scatter::{Errors, Scatter};
pub use score::{
    Answer, CalibrationBin, EffectScore, Outcome, OutsideScore, Score, Share,
};
pub use trial::{Diagnose, Scored, run};
