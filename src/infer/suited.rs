//! Which backend suits a model, where none was asked for.

use super::{Backend, Effort, backend};
use crate::error::Result;
use crate::model::Assembled;

/// A backend with the reason why it is the one.
#[derive(Debug)]
#[non_exhaustive]
pub struct Suited {
    /// The backend.
    pub backend: Box<dyn Backend>,
    /// Why, as the end of "picked since ..".
    pub why: &'static str,
}

/// The backend that suits a model put together from an event file.
///
/// A law and a noise alone have one mode, and chains follow whatever shape it
/// has. A mechanism that acts from some place on, or for some time, may do so
/// at several, and so may a noise of several parts: chains that begin at one of
/// them hardly ever reach another.
///
/// # Errors
/// As [`backend`].
pub fn suited(
    model: &Assembled,
    infers_noise: bool,
    effort: &Effort,
) -> Result<Suited> {
    let has_mechanisms = model.mechanisms().next().is_some();
    let is_proper = model.priors().all(|(_, prior)| prior.is_proper());
    let (name, why) = match (has_mechanisms, infers_noise, is_proper) {
        (false, false, _) => ("mh", "the model has no mechanisms"),
        (_, _, false) => ("mh", "it needs no proper priors"),
        (true, ..) => ("laplace-mixture", "mechanisms may have several modes"),
        (false, ..) => ("laplace-mixture", "noises may have several modes"),
    };
    Ok(Suited { backend: backend(name, effort)?, why })
}
