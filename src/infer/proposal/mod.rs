//! Proposals of importance sampling: mixtures with a share of the prior.

mod component;
mod mixture;
mod particle;

pub(super) use component::Part;
pub use mixture::Mixture;
pub(crate) use mixture::student_constant;
pub(super) use particle::{
    Base, PRIOR_SHARE, Particle, blended, log_target, population,
};
