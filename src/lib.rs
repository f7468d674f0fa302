//! couloir
#![warn(clippy::print_stdout, clippy::print_stderr)]

pub mod block;
pub mod calibrate;
pub mod cli;
pub mod context;
pub mod declared;
pub mod draws;
pub mod error;
pub mod infer;
pub mod io;
pub mod model;
pub mod noise;
pub mod observe;
pub mod physics;
pub mod predict;
pub mod prelude;
pub mod prior;
pub mod report;
pub mod scalar;
pub mod seed;

pub use couloir_macros::model;
pub use declared::Declared;
pub use error::{Error, Outcome, Result, Stop};
pub use model::{Label, Model, Number, Program, Run};
pub use observe::{Event, Flow, Series};
pub use scalar::Real;
pub use seed::Seed;
