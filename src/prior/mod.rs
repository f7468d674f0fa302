//! Prior distributions: what is known of a parameter before the recording.
//!
//! One distribution a file, each with its density, support, quantile and
//! draws. Parameters of a distribution may be unknowns themselves
//! (hierarchies), so densities carry derivatives in both.

mod normal;

pub(crate) use normal::LN_SQRT_2PI;
mod support;

pub use normal::Normal;
pub use support::Support;

use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// A probability distribution of one real quantity.
///
/// Densities are normalised, except for [`Flat`], whose log density is 0.
pub trait Prior<K: Kind> {
    /// The natural logarithm of the density at `x`; minus infinity outside
    /// the support and where the distribution's own arguments are impossible.
    fn log_density(&self, x: Real<K>) -> Real<K>;

    /// Where the density is positive.
    fn support(&self) -> Support<K>;

    /// The value below which a draw falls with probability `p`; `None` for an
    /// improper distribution.
    fn quantile(&self, p: f64) -> Option<f64>;

    /// One draw; `None` for an improper distribution.
    fn draw(&self, rng: &mut Rng) -> Option<f64>;
}
