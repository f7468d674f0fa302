//! The backends, one a file.

mod bridge;
mod importance;
pub(super) mod laplace_mixture;
mod legendre;
mod map;
mod memory;
mod mh;
#[cfg(feature = "nuts")]
mod nuts;
mod quadrature;
mod reciprocal;
pub(super) mod smc;

pub use bridge::Bridge;
pub use importance::ImportanceSampling;
pub use laplace_mixture::LaplaceMixture;
pub use map::Map;
pub use mh::{MetropolisHastings, Proposal};
#[cfg(feature = "nuts")]
pub use nuts::Nuts;
pub use quadrature::Quadrature;
pub use reciprocal::ReciprocalImportance;
pub use smc::Smc;
