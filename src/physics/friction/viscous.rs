//! Viscous drag, proportional to the speed.

use super::{Friction, Rate, Site, Varies};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// r = k u.
#[derive(Debug, Clone, Copy)]
pub struct Viscous<S> {
    /// The drag per speed \[1/s\].
    pub k: S,
}

impl<S: Copy> Block<S> for Viscous<S> {
    const NAME: &'static str = "viscous";
    const FIELDS: &'static [Field] =
        &[Field::new("k", "1/s", "HalfNormal(0.1)")];

    fn from_values(values: &[S]) -> Self {
        Self { k: values[0] }
    }
}

impl<K: Kind> Friction<K> for Viscous<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }

    #[inline(always)]
    fn rate(&self, _: &Site, _: Real<K>) -> Rate<K> {
        Rate { linear: self.k, ..Rate::default() }
    }
}
