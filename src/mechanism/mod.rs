//! Mechanisms: what a model may lack, as changes from outside.
//!
//! A [`Mechanism`] has a name, one plain sentence, unknown amounts with
//! priors, and the [`Change`] that given amounts make. The [`catalogue`] holds
//! those that come along; several events have one each ([`PerEvent`]) or
//! amounts about a common one ([`Pooled`]).

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
pub use change::{Change, Covariate};
pub use extent::Extent;
pub use per_event::PerEvent;
pub use pooled::Pooled;
