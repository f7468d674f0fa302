//! Friction laws: one block a file, and their sum.
//!
//! A law says what it adds to the [`Rate`]s of a site: specific forces
//! (force per mass) sorted by how they depend on the speed. Laws add up rate
//! by rate, so a block can also change what another one does: curvature
//! changes the load under Coulomb's mu, entrainment lets the mass grow.

mod cohesion;
mod coulomb;
mod curvature;
mod entrainment;
mod law;
mod pcm;
mod sum;
mod turbulent;
mod velocity_weakening;
mod viscous;
mod voellmy;

pub use cohesion::Cohesion;
pub use coulomb::Coulomb;
pub use curvature::Curvature;
pub use entrainment::Entrainment;
pub use law::{Law, LawKind, LawSum, Laws, RateOf, Valued};
pub use pcm::Pcm;
pub use turbulent::Turbulent;
pub use velocity_weakening::VelocityWeakening;
pub use viscous::Viscous;
pub use voellmy::Voellmy;

use std::ops::Add;

pub use crate::block::Sum;
use crate::scalar::{Kind, Real};

/// Every law that an event file can name.
pub const LAWS: &[&dyn Law] = &[
    crate::law!(Coulomb),
    crate::law!(Turbulent),
    crate::law!(Voellmy),
    crate::law!(Pcm),
    crate::law!(Cohesion),
    crate::law!(Viscous),
    crate::law!(VelocityWeakening),
    crate::law!(Curvature),
    crate::law!(Entrainment),
];

/// A place on the track, as a law sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// Distance along the slope \[m\], at the middle of the piece.
    pub distance: f64,
    /// g sin(theta) \[m/s2\].
    pub pull: f64,
    /// g cos(theta) \[m/s2\].
    pub load: f64,
    /// -d theta/ds \[1/m\].
    pub curvature: f64,
    /// The mean flow depth h \[m\].
    pub depth: f64,
}

/// What resists a unit mass at a site:
///
/// r = mu max(0, g cos(theta) + pressed kappa u^2) + constant + linear u
///     + (quadratic + growth) u^2.
#[derive(Debug, Clone, Copy)]
pub struct Rate<K: Kind> {
    /// Dry friction: resistance per normal load \[1\].
    pub mu: Real<K>,
    /// What share of the centripetal force kappa u^2 adds to the load \[1\].
    pub pressed: Real<K>,
    /// Independent of load and speed \[m/s2\].
    pub constant: Real<K>,
    /// Proportional to the speed \[1/s\].
    pub linear: Real<K>,
    /// Proportional to its square \[1/m\].
    pub quadratic: Real<K>,
    /// Mass taken up, dm/ds = growth m \[1/m\]: it has to be set in motion.
    pub growth: Real<K>,
}

impl<K: Kind> Default for Rate<K> {
    #[inline(always)]
    fn default() -> Self {
        let zero = Real::new(0.0);
        Self {
            mu: zero,
            pressed: zero,
            constant: zero,
            linear: zero,
            quadratic: zero,
            growth: zero,
        }
    }
}

impl<K: Kind> Add for Rate<K> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            mu: self.mu + other.mu,
            pressed: self.pressed + other.pressed,
            constant: self.constant + other.constant,
            linear: self.linear + other.linear,
            quadratic: self.quadratic + other.quadratic,
            growth: self.growth + other.growth,
        }
    }
}

impl<K: Kind> Rate<K> {
    /// All rates, times a factor.
    #[must_use]
    pub fn scaled(self, factor: Real<K>) -> Self {
        Self {
            mu: self.mu * factor,
            pressed: self.pressed * factor,
            constant: self.constant * factor,
            linear: self.linear * factor,
            quadratic: self.quadratic * factor,
            growth: self.growth * factor,
        }
    }

    /// The resistance of a unit mass at `site` and `speed` \[m/s2\].
    pub fn resistance(&self, site: &Site, speed: Real<K>) -> Real<K> {
        let w = speed * speed;
        let load = (self.pressed * site.curvature * w + site.load).max(0.0);
        self.mu * load
            + self.constant
            + self.linear * speed
            + (self.quadratic + self.growth) * w
    }
}

/// On what a law's rates depend: this decides how the motion is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Varies {
    /// The same everywhere: asked once for a whole flow, exact solution.
    Nowhere,
    /// Constant on each piece of the track: exact solution.
    WithPlace,
    /// With the speed too, in another way than up to its square: on each leg
    /// of the motion a force of the exact family is fitted to the law.
    ///
    /// A law may jump at a speed that is known: it is met within 2e-7 of that
    /// speed, and derivatives go along. By a speed that is unknown there are no
    /// derivatives: let the law change over some speeds instead.
    WithSpeed,
}

/// A law that resists sliding.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a friction law",
    label = "this cannot resist a sliding mass",
    note = "declare a friction block, such as `friction ~ Coulomb {{ mu: \
            Gamma(9.0, 0.03) }};`, and pass it by reference: \
            `event.slide(&friction)?`",
    note = "a law of one's own computes with `Real<K>`, not with `f64`: \
            `impl<K: Kind> Friction<K> for Own<Real<K>>`"
)]
pub trait Friction<K: Kind> {
    /// On what the rates depend. Said by every law, never guessed: a law
    /// that read the speed and did not say so would be solved wrongly.
    fn varies(&self) -> Varies;

    /// What the law adds at a site. `speed` \[m/s\] is 0 unless the law
    /// varies with it.
    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K>;
}

impl<K: Kind, L: Friction<K> + ?Sized> Friction<K> for &L {
    fn varies(&self) -> Varies {
        (**self).varies()
    }
    #[inline(always)]
    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K> {
        (**self).rate(at, speed)
    }
}
