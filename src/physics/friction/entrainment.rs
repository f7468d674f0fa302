//! Entrainment: snow taken up on the way has to be set in motion.

use super::{Friction, Rate, Site, Varies};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// dm/ds = e m, so r gains e u^2: the momentum that the mass gives to snow
/// lying at rest.
#[derive(Debug, Clone, Copy)]
pub struct Entrainment<S> {
    /// The relative growth of the mass per distance \[1/m\].
    pub e: S,
}

impl<S: Copy> Block<S> for Entrainment<S> {
    const NAME: &'static str = "entrainment";
    const FIELDS: &'static [Field] =
        &[Field::new("e", "1/m", "HalfNormal(0.005)")];

    fn from_values(values: &[S]) -> Self {
        Self { e: values[0] }
    }
}

impl<K: Kind> Friction<K> for Entrainment<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }

    #[inline(always)]
    fn rate(&self, _: &Site, _: Real<K>) -> Rate<K> {
        Rate { growth: self.e, ..Rate::default() }
    }
}
