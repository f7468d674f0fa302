//! The PCM law: dry friction and drag without a flow depth.

use super::{Friction, Rate, Site, Varies};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// r = mu g cos(theta) + u^2 / (M/D) (Perla, Cheng, McClung 1980).
#[derive(Debug, Clone, Copy)]
pub struct Pcm<S> {
    /// The friction coefficient \[1\].
    pub mu: S,
    /// The mass-to-drag ratio M/D \[m\].
    pub md: S,
}

impl<S: Copy> Block<S> for Pcm<S> {
    const NAME: &'static str = "pcm";
    const FIELDS: &'static [Field] = &[
        Field::new("mu", "1", "Gamma(9, 0.03)"),
        Field::new("md", "m", "LogNormal(5.7, 0.8)"),
    ];

    fn from_values(values: &[S]) -> Self {
        Self { mu: values[0], md: values[1] }
    }
}

impl<K: Kind> Friction<K> for Pcm<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }

    #[inline(always)]
    fn rate(&self, _: &Site, _: Real<K>) -> Rate<K> {
        Rate { mu: self.mu, quadratic: 1.0 / self.md, ..Rate::default() }
    }
}
