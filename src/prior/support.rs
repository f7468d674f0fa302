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
            Self::Between(low, high) => between(z, low, high),
        }
    }

    /// The place on the real line of `x`; not finite outside the support.
    pub fn to_line(&self, x: f64) -> f64 {
        match *self {
            Self::Line => x,
            Self::Above(low) => (x - low.value()).ln(),
            Self::Between(low, high) => {
                (x - low.value()).ln() - (high.value() - x).ln()
            }
        }
    }

    /// The two ends.
    pub(super) fn ends(&self) -> (f64, f64) {
        match *self {
            Self::Line => (f64::NEG_INFINITY, f64::INFINITY),
            Self::Above(low) => (low.value(), f64::INFINITY),
            Self::Between(low, high) => (low.value(), high.value()),
        }
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
