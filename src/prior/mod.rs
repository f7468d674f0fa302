//! Prior distributions: what is known of a parameter before the recording.
//!
//! One distribution a file, each with its density, support, quantile and
//! draws. Parameters of a distribution may be unknowns themselves
//! (hierarchies), so densities carry derivatives in both.
//!
//! A new distribution is one file, its `mod` and `pub use` here, and one line
//! in the list of `any.rs`, which makes it known to texts.

mod any;
mod beta;
mod cauchy;
mod exponential;
mod flat;
mod gamma;
mod half_cauchy;
mod half_normal;
mod inverse_gamma;
mod log_normal;
mod normal;
mod special;
mod student_t;
mod support;
#[cfg(test)]
mod tests;
mod uniform;

pub use any::{AnyPrior, NAMES};
pub use beta::Beta;
pub use cauchy::Cauchy;
pub use exponential::Exponential;
pub use flat::Flat;
pub use gamma::Gamma;
pub use half_cauchy::HalfCauchy;
pub use half_normal::HalfNormal;
pub use inverse_gamma::InverseGamma;
pub use log_normal::LogNormal;
pub(crate) use normal::LN_SQRT_2PI;
pub use normal::Normal;
pub use student_t::StudentT;
pub use support::Support;
pub use uniform::Uniform;

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

    /// Whether the density has an integral, which is then 1: what is improper
    /// has no draws, and a model with it no evidence. Said by every
    /// distribution, never guessed from what else it can do.
    fn is_proper(&self) -> bool;

    /// The value below which a draw falls with probability `p`: inside the
    /// support for 0 < p < 1, its ends for 0 and 1. `None` for an improper
    /// distribution, impossible arguments, a `p` that is no probability, or
    /// where nobody knows it.
    fn quantile(&self, p: f64) -> Option<f64>;

    /// One draw, strictly inside the support; `None` for an improper
    /// distribution or impossible arguments.
    fn draw(&self, rng: &mut Rng) -> Option<f64>;
}

/// A quantile from its formula `inside`, which is asked for 0 < p < 1 alone.
fn quantile_of<K: Kind>(
    support: &Support<K>,
    p: f64,
    inside: impl FnOnce(f64) -> f64,
) -> Option<f64> {
    let (low, high) = support.ends();
    if p == 0.0 {
        Some(low)
    } else if p == 1.0 {
        Some(high)
    } else if p > 0.0 && p < 1.0 {
        Some(support.nearest(inside(p)))
    } else {
        None
    }
}

/// What a log density is where there is no density.
#[inline(always)]
fn impossible<K: Kind>() -> Real<K> {
    Real::new(f64::NEG_INFINITY)
}

/// Whether `x` is finite and above 0, as scales, shapes and most supports
/// want it.
#[inline(always)]
fn positive(x: f64) -> bool {
    x > 0.0 && x < f64::INFINITY
}
