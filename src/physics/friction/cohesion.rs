//! Cohesion: a resistance that neither load nor speed changes.

use super::{Friction, Rate, Site, Varies};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// r = cohesion, the bed's shear strength over density and flow depth.
#[derive(Debug, Clone, Copy)]
pub struct Cohesion<S> {
    /// The specific resistance \[m/s2\].
    pub cohesion: S,
}

impl<S: Copy> Block<S> for Cohesion<S> {
    const NAME: &'static str = "cohesion";
    const FIELDS: &'static [Field] =
        &[Field::new("cohesion", "m/s2", "HalfNormal(1.5)")];

    fn from_values(values: &[S]) -> Self {
        Self { cohesion: values[0] }
    }
}

impl<K: Kind> Friction<K> for Cohesion<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }

    #[inline(always)]
    fn rate(&self, _: &Site, _: Real<K>) -> Rate<K> {
        Rate { constant: self.cohesion, ..Rate::default() }
    }
}
