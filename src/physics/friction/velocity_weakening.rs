//! Dry friction that weakens as the mass speeds up.

use super::{Friction, Rate, Site, Varies};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// The resistance mu g cos(theta) (r + (1 - r) exp(-u/u0)): mu at rest, falling
/// to the share r of it at speeds well above u0.
///
/// Outside the exact family: solved in legs, to each of which a force of the
/// family is fitted.
#[derive(Debug, Clone, Copy)]
pub struct VelocityWeakening<S> {
    /// The friction coefficient at rest \[1\].
    pub mu: S,
    /// The share of it that is left at high speed \[1\].
    pub r: S,
    /// The speed over which it weakens \[m/s\].
    pub u0: S,
}

impl<S: Copy> Block<S> for VelocityWeakening<S> {
    const NAME: &'static str = "velocity-weakening";
    const FIELDS: &'static [Field] = &[
        Field::new("mu", "1", "Gamma(9, 0.03)"),
        Field::new("r", "1", "Beta(2, 2)"),
        Field::new("u0", "m/s", "Gamma(2, 5)"),
    ];

    fn from_values(values: &[S]) -> Self {
        Self { mu: values[0], r: values[1], u0: values[2] }
    }
}

impl<K: Kind> Friction<K> for VelocityWeakening<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::WithSpeed
    }

    #[inline]
    fn rate(&self, _: &Site, speed: Real<K>) -> Rate<K> {
        let weak = self.r + (1.0 - self.r) * (-speed / self.u0).exp();
        Rate { mu: self.mu * weak, ..Rate::default() }
    }
}
