//! Proposals of importance sampling: mixtures with a share of the prior.

mod component;
mod mixture;
mod particle;

pub(super) use component::Component;
pub use mixture::Mixture;
pub(crate) use mixture::student_constant;
pub(crate) use particle::Particle;
pub(super) use particle::{
    Base, PRIOR_SHARE, blended, log_target, population,
};
