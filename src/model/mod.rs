//! Models: what is unknown, and what follows from given values.
//!
//! A [`Program`] is one generic function, written by the `model!` macro or by
//! hand: it declares parameters and scores data. Everything that is asked of
//! a model (log density, gradient, pointwise likelihood, replicates) is the
//! same run with another listener. [`Model`] is the object-safe face of a
//! program; every program has it.

mod added;
mod alone;
mod along;
mod amount;
mod any_program;
mod assembled;
mod blocks;
mod by_event;
mod data;
mod default_prior;
mod density;
mod face;
mod fisher;
mod given;
mod gradient;
mod information;
mod jacobian;
mod keep;
mod label;
mod labels;
mod listener;
mod number;
mod of_program;
mod pass;
mod posterior;
mod program;
mod run;
mod slice;
mod together;
mod with;

pub(crate) use along::unit_directions;
pub use any_program::{AnyProgram, RunOf};
pub use assembled::Assembled;
pub use blocks::declared_blocks;
pub(crate) use by_event::ByEvent;
pub use data::Data;
pub use density::{Density, Weights};
pub use face::{Model, Point};
pub use given::Given;
pub use information::Information;
pub use keep::Keep;
pub use label::Label;
pub use listener::{Collected, Collector, Declaration, Listener, Replicates};
pub use number::Number;
pub use posterior::{Cost, Parameter, Posterior};
pub use program::Program;
pub use run::Run;
pub use slice::Slice;
pub use together::{Member, Together};
pub use with::With;
