//! The load that a bend of the track adds.

use super::{Friction, Rate, Site, Varies};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// The normal load becomes g cos(theta) + c kappa u^2, never below 0:
/// the centripetal force presses the mass on where the track flattens out
/// and lifts it where it steepens. By itself it resists nothing; it acts
/// through the mu of the law it is added to.
#[derive(Debug, Clone, Copy)]
pub struct Curvature<S> {
    /// The share of the centripetal force that reaches the bed \[1\].
    pub c: S,
}

impl<S: Copy> Block<S> for Curvature<S> {
    const NAME: &'static str = "curvature";
    const FIELDS: &'static [Field] =
        &[Field::new("c", "1", "LogNormal(0, 0.25)")];

    fn from_values(values: &[S]) -> Self {
        Self { c: values[0] }
    }
}

impl<K: Kind> Friction<K> for Curvature<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }

    #[inline(always)]
    fn rate(&self, _: &Site, _: Real<K>) -> Rate<K> {
        Rate { pressed: self.c, ..Rate::default() }
    }
}
