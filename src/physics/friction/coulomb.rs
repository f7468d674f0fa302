//! Coulomb's dry friction.

use super::{Friction, Rate, Site, Varies};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// r = mu g cos(theta): a share mu of the normal load, whatever the speed.
///
/// ```
/// use couloir::physics::friction::{Coulomb, Friction, Site};
/// use couloir::scalar::{Plain, Real};
/// let law = Coulomb { mu: Real::<Plain>::new(0.3) };
/// let site = Site {
///     distance: 0.0, pull: 5.0, load: 8.0, curvature: 0.0, depth: 1.0,
/// };
/// let speed = Real::new(20.0);
/// assert_eq!(law.rate(&site, speed).resistance(&site, speed), 0.3 * 8.0);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Coulomb<S> {
    /// The friction coefficient \[1\].
    pub mu: S,
}

impl<S: Copy> Block<S> for Coulomb<S> {
    const NAME: &'static str = "coulomb";
    const FIELDS: &'static [Field] =
        &[Field::new("mu", "1", "Gamma(9, 0.03)")];

    fn from_values(values: &[S]) -> Self {
        Self { mu: values[0] }
    }
}

impl<K: Kind> Friction<K> for Coulomb<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }

    #[inline(always)]
    fn rate(&self, _: &Site, _: Real<K>) -> Rate<K> {
        Rate { mu: self.mu, ..Rate::default() }
    }
}
