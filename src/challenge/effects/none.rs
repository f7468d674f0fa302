//! Nothing hidden: the baseline is the truth.

use super::{Class, Effect, Kind, Scene, Void};
use crate::seed::Rng;

pub(super) const KIND: Kind = Kind {
    name: "none",
    class: Class::None,
    range: (0.0, 0.0),
    signed: false,
    unit: "1",
    coulomb_only: false,
    void: Void::Never,
    make,
};

/// No effect.
#[derive(Debug)]
pub(in crate::challenge) struct Nothing;

fn make(_: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Nothing))
}

impl Effect for Nothing {}
