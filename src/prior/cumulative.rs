//! Distributions whose probabilities have derivatives, as truncation needs.

use super::Prior;
use crate::scalar::{Kind, Real};

/// A prior that knows how likely a draw falls below a number, with the
/// derivatives of that: what [`Truncated`](super::Truncated) can cut off.
///
/// ```
/// use couloir::prior::{Cumulative, Normal};
/// use couloir::scalar::{Plain, Real};
/// let tail = Normal::<Plain>::new(0.0, 1.0).log_above(Real::new(10.0));
/// // Abramowitz and Stegun 1964, table 26.2: -log10 Q(10) = 23.11805.
/// assert!((tail.value() / 10.0_f64.ln() + 23.11805).abs() < 5e-6);
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be truncated",
    label = "the probability of a range needs a formula with derivatives \
             (`couloir::prior::Cumulative`): all real distributions have one \
             but `Flat`, `Mixture` and `Truncated`"
)]
pub trait Cumulative<K: Kind>: Prior<K> {
    /// ln of the probability of a draw below `x`, a number of the support.
    fn log_below(&self, x: Real<K>) -> Real<K>;

    /// ln of the probability of a draw above `x`, a number of the support.
    fn log_above(&self, x: Real<K>) -> Real<K>;

    /// Both at once, which is less work where one follows from the other.
    fn log_parts(&self, x: Real<K>) -> (Real<K>, Real<K>) {
        (self.log_below(x), self.log_above(x))
    }
}

/// ln(1 - e^x) for x < 0, accurate near both ends (Maechler 2012).
pub(super) fn ln_1m_exp<K: Kind>(x: Real<K>) -> Real<K> {
    if x > -std::f64::consts::LN_2 {
        (-x.exp_m1()).ln()
    } else {
        (-x.exp()).ln_1p()
    }
}
