//! couloir
#[macro_use]
pub mod scalar;
pub mod draws;
pub mod error;
pub mod seed;
pub use error::{Error, Result};
pub use seed::Seed;
