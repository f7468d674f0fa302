//! Distributions: what is known of a parameter before the recording, and what
//! data may come from.
//!
//! One distribution a file. A [`Distribution`] scores a number and draws one;
//! a [`Prior`] has a density besides, with support and quantile. Parameters of
//! a distribution may be unknowns themselves (hierarchies), so densities carry
//! derivatives in both. [`Truncated`] and [`Mixture`] are made of others;
//! [`Ordered`] and [`Dirichlet`] are of several numbers ([`Joint`]).
//!
//! A new distribution is one file, its `mod` and `pub use` here, and one line
//! in the list of `any.rs`, which makes it known to texts.

mod any;
mod bernoulli;
mod beta;
mod binomial;
mod cauchy;
mod cumulative;
mod dirichlet;
mod exponential;
mod flat;
mod gamma;
mod half_cauchy;
mod half_normal;
mod incomplete;
mod inverse_gamma;
mod joint;
mod log_normal;
mod mixture;
mod normal;
mod ordered;
mod parts;
mod poisson;
mod special;
mod student_t;
mod support;
#[cfg(test)]
mod tests;
mod truncated;
mod uniform;

pub use any::{AnyPrior, NAMES};
pub use bernoulli::Bernoulli;
pub use beta::Beta;
pub use binomial::Binomial;
pub use cauchy::Cauchy;
pub use cumulative::Cumulative;
pub use dirichlet::Dirichlet;
pub use exponential::Exponential;
pub use flat::Flat;
pub use gamma::Gamma;
pub use half_cauchy::HalfCauchy;
pub use half_normal::HalfNormal;
pub use inverse_gamma::InverseGamma;
pub use joint::Joint;
pub use log_normal::LogNormal;
pub use mixture::Mixture;
pub use normal::Normal;
pub use ordered::Ordered;
pub use parts::{Parts, PriorParts};
pub use poisson::Poisson;
pub(crate) use special::LN_SQRT_2PI;
pub use student_t::StudentT;
pub use support::Support;
pub use truncated::Truncated;
pub use uniform::Uniform;

use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// A probability distribution of one quantity: what data may come from.
///
/// Densities are normalised, except for [`Flat`], whose log density is 0.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a distribution of one number",
    label = "data are compared with a distribution of one number"
)]
pub trait Distribution<K: Kind> {
    /// The natural logarithm of the density at `x`, of a distribution of
    /// whole numbers that of the probability; minus infinity outside the
    /// support and where the distribution's own arguments are impossible.
    fn log_density(&self, x: Real<K>) -> Real<K>;

    /// One draw, strictly inside the support; `None` for an improper
    /// distribution or impossible arguments.
    fn draw(&self, rng: &mut Rng) -> Option<f64>;
}

/// A distribution of a real quantity, which an unknown may have: it has a
/// density, and says where that is positive.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be the prior of an unknown",
    label = "an unknown is a real number: it needs a distribution with a \
             density"
)]
pub trait Prior<K: Kind>: Distribution<K> {
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
}

impl<K: Kind, P: Distribution<K> + ?Sized> Distribution<K> for &P {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        (**self).log_density(x)
    }
    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        (**self).draw(rng)
    }
}

impl<K: Kind, P: Prior<K> + ?Sized> Prior<K> for &P {
    fn support(&self) -> Support<K> {
        (**self).support()
    }
    fn is_proper(&self) -> bool {
        (**self).is_proper()
    }
    fn quantile(&self, p: f64) -> Option<f64> {
        (**self).quantile(p)
    }
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
        // Where its formula overflows, nobody knows it.
        Some(support.nearest(inside(p))).filter(|x| !x.is_nan())
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

/// Whether `x` is one of the numbers 0, 1, 2, ...
#[inline(always)]
fn whole(x: f64) -> bool {
    x >= 0.0 && x.fract() == 0.0
}
