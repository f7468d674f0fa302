//! couloir
#[macro_use]
pub mod scalar;
pub mod error;
pub mod seed;
pub use error::{Error, Result};
pub use seed::Seed;
