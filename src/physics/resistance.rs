//! What resists on every piece alike, and the ground that it acts on.

use super::exact::Force;
use super::forces::{Moment, Term};
use super::friction::Rate;
use super::track::Piece;
use crate::scalar::{Kind, Plain, Real};

/// A resistance mu load + constant + linear u + c u^2.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Resistance<K: Kind> {
    mu: Real<K>,
    constant: Real<K>,
    linear: Real<K>,
    c: Real<K>,
}

impl<K: Kind> Resistance<K> {
    /// `None` where a bend of the track changes the load too.
    pub(crate) fn of(rate: &Rate<K>) -> Option<Self> {
        rate.pressed.is_constantly_zero().then(|| Self {
            mu: rate.mu,
            constant: rate.constant,
            linear: rate.linear,
            c: rate.quadratic + rate.growth,
        })
    }

    pub(crate) fn is_linear(&self) -> bool {
        !self.linear.is_constantly_zero()
    }

    /// The same with a term in a state.
    #[inline(always)]
    pub(crate) fn and(self, term: &Term<K>, at: &Moment<K>) -> Self {
        let (rate, part) = (&term.rate, term.strength(at));
        Self {
            mu: self.mu + rate.mu * part,
            constant: self.constant + rate.constant * part,
            linear: self.linear + rate.linear * part,
            c: self.c + (rate.quadratic + rate.growth) * part,
        }
    }

    /// The force at speed `u` as du/dt = a - c u^2: a and c.
    #[inline(always)]
    pub(crate) fn at_speed(
        &self,
        piece: &Piece,
        tilt: &Tilt<K>,
        u: Real<K>,
    ) -> (Real<K>, Real<K>) {
        let (pull, load) = tilt.ground(piece);
        let dry = self.mu.max(0.0) * load + self.constant;
        (pull - dry - self.linear * u, self.c)
    }
}

/// The force on every piece alike, du/dt = along pull - across load -
/// constant - c u^2. On ground tilted by delta, pull and load turn by it:
/// along = cos(delta) + mu sin(delta), across = mu cos(delta) - sin(delta).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Even<K: Kind> {
    pub(super) along: Real<K>,
    pub(super) across: Real<K>,
    pub(super) constant: Real<K>,
    pub(super) c: Real<K>,
}

impl<K: Kind> Even<K> {
    /// On the ground as it is; `None` where the rate has more to it.
    pub(crate) fn untilted(rate: &Rate<K>) -> Option<Self> {
        let base = Resistance::of(rate).filter(|base| !base.is_linear())?;
        let Resistance { mu, constant, c, .. } = base;
        Some(Self { along: Real::new(1.0), across: mu, constant, c })
    }

    /// `None` where the resistance has more to it.
    pub(crate) fn of(from: &Resistance<K>, tilt: &Tilt<K>) -> Option<Self> {
        let mu = from.mu.max(0.0);
        (!from.is_linear()).then(|| Self {
            along: tilt.cos + mu * tilt.sin,
            across: mu * tilt.cos - tilt.sin,
            constant: from.constant,
            c: from.c,
        })
    }

    /// The force on a piece.
    #[inline(always)]
    pub(crate) fn on(&self, piece: &Piece) -> Force<K> {
        let Piece { pull, load, .. } = *piece;
        let a = self.along * pull - self.across * load - self.constant;
        Force { a, b: Real::new(0.0), c: self.c }
    }

    /// The same without derivatives.
    #[inline(always)]
    pub(crate) fn values(&self) -> Even<Plain> {
        let value = |x: Real<K>| Real::new(x.value());
        Even {
            along: value(self.along),
            across: value(self.across),
            constant: value(self.constant),
            c: value(self.c),
        }
    }
}

/// How the ground is tilted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tilt<K: Kind> {
    sin: Real<K>,
    cos: Real<K>,
}

impl<K: Kind> Tilt<K> {
    /// By an angle \[radians\], positive where the ground is steeper.
    pub(crate) fn by(angle: Real<K>) -> Self {
        Self { sin: angle.sin(), cos: angle.cos() }
    }

    /// Whether every piece still carries the mass: none is beyond the
    /// vertical.
    pub(crate) fn carries(&self, pieces: &[Piece]) -> bool {
        let (sin, cos) = (self.sin.value(), self.cos.value());
        sin == 0.0 || pieces.iter().all(|p| cos * p.load > sin * p.pull)
    }

    /// Pull and load of a piece on the tilted ground.
    #[inline(always)]
    pub(crate) fn ground(&self, piece: &Piece) -> (Real<K>, Real<K>) {
        let Piece { pull, load, .. } = *piece;
        let Self { sin, cos } = *self;
        (cos * pull + sin * load, cos * load - sin * pull)
    }
}
