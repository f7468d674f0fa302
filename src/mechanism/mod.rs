//! Mechanisms: what a model may lack, as changes from outside.
//!
//! A [`Mechanism`] has a name, one plain sentence, unknown amounts with
//! priors, and the [`Change`] that given amounts make. The [`catalogue`] holds
//! those that come along. Several events have an amount each, or amounts
//! about a common one.

pub mod catalogue;

mod candidate;
mod change;
mod extent;
mod of_events;
mod per_event;
mod pooled;

pub use candidate::{
    Candidate, ChangeKind, ChangeOf, Concern, Family, Mechanism, Missing,
    Noun, Reach, Role, Unknown,
};
pub use change::Change;
pub use extent::Extent;
pub(crate) use per_event::PerEvent;
pub(crate) use pooled::Pooled;
