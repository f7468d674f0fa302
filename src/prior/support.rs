//! Where a density is positive, and the way from there to the real line.
//!
//! Samplers and optimisers that need an unbounded space work with z, the
//! image of x on the real line; a density of x becomes one of z by adding
//! ln |dx/dz|.

use crate::scalar::{Kind, Real};

/// The support of a distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support<K: Kind> {
    /// All real numbers; z = x.
    Line,
    /// Above a bound; z = ln(x - low).
    Above(Real<K>),
    /// Below a bound; z = -ln(high - x).
    Below(Real<K>),
    /// Between two bounds; z = logit((x - low)/(high - low)).
    Between(Real<K>, Real<K>),
}

impl<K: Kind> Support<K> {
    /// Whether `x` lies inside.
    #[inline]
    pub fn contains(&self, x: f64) -> bool {
        match *self {
            Self::Line => x.is_finite(),
            Self::Above(low) => x > low.value() && x.is_finite(),
            Self::Below(high) => x < high.value() && x.is_finite(),
            Self::Between(low, high) => x > low.value() && x < high.value(),
        }
    }

    /// x at the place `z` of the real line, with ln |dx/dz|.
    ///
    /// ```
    /// use couloir::prior::Support;
    /// use couloir::scalar::{Plain, Real};
    /// let positive = Support::<Plain>::Above(0.0.into());
    /// let (x, log_jacobian) = positive.from_line(Real::new(1.0));
    /// assert_eq!(x.value(), 1.0_f64.exp());
    /// assert_eq!(log_jacobian.value(), 1.0);
    /// ```
    #[inline(always)]
    pub fn from_line(&self, z: Real<K>) -> (Real<K>, Real<K>) {
        match *self {
            Self::Line => (z, Real::new(0.0)),
            Self::Above(low) => (low + z.exp(), z),
            Self::Below(high) => (high - (-z).exp(), -z),
            Self::Between(low, high) => between(z, low, high),
        }
    }

    /// The place on the real line of `x`; not finite outside the support.
    pub fn to_line(&self, x: f64) -> f64 {
        match *self {
            Self::Line => x,
            Self::Above(low) => (x - low.value()).ln(),
            Self::Below(high) => -(high.value() - x).ln(),
            Self::Between(low, high) => {
                (x - low.value()).ln() - (high.value() - x).ln()
            }
        }
    }

    /// The two ends; infinite where there is none.
    pub fn ends(&self) -> (f64, f64) {
        let (low, high) = self.bounds();
        (
            low.map_or(f64::NEG_INFINITY, Real::value),
            high.map_or(f64::INFINITY, Real::value),
        )
    }

    /// The lower and the upper bound, where there is one.
    pub(super) fn bounds(&self) -> (Option<Real<K>>, Option<Real<K>>) {
        match *self {
            Self::Line => (None, None),
            Self::Above(low) => (Some(low), None),
            Self::Below(high) => (None, Some(high)),
            Self::Between(low, high) => (Some(low), Some(high)),
        }
    }

    /// Between two bounds, where there are such.
    pub(super) fn within(low: Option<Real<K>>, high: Option<Real<K>>) -> Self {
        match (low, high) {
            (None, None) => Self::Line,
            (Some(low), None) => Self::Above(low),
            (None, Some(high)) => Self::Below(high),
            (Some(low), Some(high)) => Self::Between(low, high),
        }
    }

    /// The part of it that lies between two bounds.
    pub(super) fn cut(
        &self,
        low: Option<Real<K>>,
        high: Option<Real<K>>,
    ) -> Self {
        let own = self.bounds();
        let low = match (own.0, low) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
        let high = match (own.1, high) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        Self::within(low, high)
    }

    /// All from the lower of two lower bounds to the higher of two upper ones.
    pub(super) fn joined(&self, other: &Self) -> Self {
        let (own, theirs) = (self.bounds(), other.bounds());
        let low = own.0.zip(theirs.0).map(|(a, b)| a.min(b));
        let high = own.1.zip(theirs.1).map(|(a, b)| a.max(b));
        Self::within(low, high)
    }

    /// The number nearest to `x` that lies strictly inside, where there is
    /// one; above 0 the smallest of full precision, so that 1/x is finite.
    pub(super) fn nearest(&self, x: f64) -> f64 {
        let (low, high) = self.ends();
        let least = low.next_up().max(low + f64::MIN_POSITIVE);
        x.max(least).min(high.next_down())
    }
}

/// The place between two ends, with ln |dx/dz|.
fn between<K: Kind>(
    z: Real<K>,
    low: Real<K>,
    high: Real<K>,
) -> (Real<K>, Real<K>) {
    // The smaller of s = logistic(z) and 1 - s, so that nothing cancels and no
    // exponential overflows.
    let a = -z.abs();
    let e = a.exp();
    let width = high - low;
    let part = width * (e / (1.0 + e));
    let x = if z < 0.0 { low + part } else { high - part };
    // ln(s (1 - s)) = -|z| - 2 ln(1 + e^-|z|).
    (x, a - 2.0 * e.ln_1p() + width.ln())
}
