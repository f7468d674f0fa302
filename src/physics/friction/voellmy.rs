//! Voellmy's law: Coulomb friction and turbulent drag.

use super::{Coulomb, Friction, Rate, Site, Turbulent, Varies};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// r = mu g cos(theta) + g u^2 / (xi h) (Heredia et al. 2020, equation 2).
///
/// Meant for dense snow avalanches; mu about 0.15 to 0.5, xi from a few
/// hundred to some thousand m/s2.
#[derive(Debug, Clone, Copy)]
pub struct Voellmy<S> {
    /// The friction coefficient \[1\].
    pub mu: S,
    /// The turbulence coefficient \[m/s2\].
    pub xi: S,
}

impl<S: Copy> Block<S> for Voellmy<S> {
    const NAME: &'static str = "voellmy";
    const FIELDS: &'static [Field] = &[
        Field::new("mu", "1", "Gamma(9, 0.03)"),
        Field::new("xi", "m/s2", "Gamma(2.5, 400)"),
    ];

    fn from_values(values: &[S]) -> Self {
        Self { mu: values[0], xi: values[1] }
    }
}

impl<K: Kind> Friction<K> for Voellmy<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }

    #[inline(always)]
    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K> {
        Coulomb { mu: self.mu }.rate(at, speed)
            + Turbulent { xi: self.xi }.rate(at, speed)
    }
}
