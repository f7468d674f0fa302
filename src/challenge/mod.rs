//! The proof: events that hide one effect each, diagnosed without the answer,
//! and scored.
//!
//! What makes the events shares no code with what diagnoses them: no track,
//! no integrator, no friction law, no noise of the crate is used here, only
//! random numbers and the words of the file format.

mod case;
mod effects;
mod files;
mod ground;
mod motion;

pub use case::{Case, Coordinate, Interval, Mix, Recording, Truth, cases};
pub use effects::Class;
