//! Turbulent drag, the second term of Voellmy's law.

use super::{Friction, Rate, Site, Varies};
use crate::block::{Block, Field};
use crate::physics::GRAVITY;
use crate::scalar::{Kind, Real};

/// r = g u^2 / (xi h), h the flow depth (Voellmy 1955).
#[derive(Debug, Clone, Copy)]
pub struct Turbulent<S> {
    /// The turbulence coefficient \[m/s2\].
    pub xi: S,
}

impl<S: Copy> Block<S> for Turbulent<S> {
    const NAME: &'static str = "turbulent";
    const FIELDS: &'static [Field] =
        &[Field::new("xi", "m/s2", "Gamma(2.5, 400)")];

    fn from_values(values: &[S]) -> Self {
        Self { xi: values[0] }
    }
}

impl<K: Kind> Friction<K> for Turbulent<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }

    #[inline(always)]
    fn rate(&self, at: &Site, _: Real<K>) -> Rate<K> {
        let quadratic = GRAVITY / (self.xi * at.depth);
        Rate { quadratic, ..Rate::default() }
    }
}
