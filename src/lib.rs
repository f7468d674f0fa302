//! couloir
#[macro_use]
pub mod scalar;
pub mod block;
pub mod error;
pub mod noise;
pub mod physics;
pub mod prior;
pub mod seed;
pub use error::{Error, Outcome, Result, Stop};
pub use seed::Seed;
