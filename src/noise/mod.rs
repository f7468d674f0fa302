//! Noise: how recorded values scatter about the motion.
//!
//! A noise is a distribution of the residuals r = recorded - predicted. All
//! of them are walked in one way, value after value, each given those before
//! it; likelihood, pointwise likelihood and standardised innovations are
//! three listeners to that walk.
//!
//! Blocks that say what an error remembers ([`Ou`], [`Matern32`], [`Ar`],
//! [`White`]), what tails it has ([`Tails`]) and how its size changes
//! ([`Growth`]) add up to a noise, in a [`Sum`](crate::block::Sum).

mod ar;
mod catalogue;
mod entry;
mod filter;
mod form;
mod gaussian;
mod grid;
mod growth;
mod iid;
mod inferred;
mod like;
mod matern32;
mod ou;
mod part;
mod student;
mod summed;
mod tails;
#[cfg(test)]
mod tests;
mod white;
mod wide;

pub use ar::Ar;
pub(crate) use catalogue::is_noise;
pub use catalogue::{names, parse};
pub use entry::{NoiseEntry, NoiseFor, NoiseKind};
pub use form::Form;
pub use grid::{Grid, Spacing};
pub use growth::Growth;
pub use iid::Iid;
pub use inferred::is_inferred;
pub(crate) use inferred::stand_in;
pub(crate) use like::noise_like;
pub use matern32::Matern32;
pub use ou::Ou;
pub use part::{Lapse, Memory, Part, Square, Transition, Whole};
pub use student::Student;
pub use tails::Tails;
pub use white::White;
pub use wide::Wide;

use crate::error::{Error, Stop};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// One residual given all before it.
#[derive(Debug, Clone, Copy)]
pub struct Conditional<K: Kind> {
    /// ln p(r_i | r_1 .. r_(i-1)).
    pub log_density: Real<K>,
    /// The innovation over its scale, as the noise's own law sees it;
    /// [`Noise::standardise`] makes it a standard normal deviate.
    pub deviate: Real<K>,
}

impl<K: Kind> Conditional<K> {
    /// A residual with its log density and its deviate.
    #[inline(always)]
    pub fn new(log_density: Real<K>, deviate: Real<K>) -> Self {
        Self { log_density, deviate }
    }
}

/// How large errors are that depend on those before them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stationary {
    /// The standard deviation of an error \[unit of the recording\].
    pub error_sd: f64,
    /// That of its innovation, what those before it do not tell.
    pub innovation_sd: f64,
}

/// A distribution of residuals.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a noise",
    label = "the last summand behind `~` has to be a noise block, such as \
             `errors` declared by `errors ~ Iid {{ .. }};`",
    note = "a noise of one's own computes with `Real<K>`, not with `f64`: \
            `impl<K: Kind> Noise<K> for Own<Real<K>>`"
)]
pub trait Noise<K: Kind> {
    /// Whether this noise is defined at those times; an input error that
    /// names the mend where it is not.
    fn check(&self, at: &Grid) -> crate::Result<()>;

    /// Visits the residuals in order, each given those before it.
    ///
    /// `Err(Stop::Reject)` where no such noise exists for these parameters
    /// (a variance below 0, an AR that is not stationary).
    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop>;

    /// Draws residuals, one per time.
    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop>;

    /// The log likelihood of the residuals.
    fn log_likelihood(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
    ) -> Result<Real<K>, Stop> {
        let mut total = Real::new(0.0);
        self.walk(at, residuals, &mut |value| total += value.log_density)?;
        Ok(total)
    }

    /// The log likelihood, while `hear` is told numbers whose derivatives,
    /// each times itself, add up to about the Fisher information of the
    /// residuals: as many of them whatever the parameters.
    ///
    /// As it stands, of innovations whose law is normal in the deviate d, or
    /// about so: with its scale s, ln p = -d^2/2 - ln s and a constant, and
    /// what informs is d and ln s.
    ///
    /// # Errors
    /// Those of [`Noise::walk`].
    fn inform(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        hear: &mut dyn FnMut(&Real<K>),
    ) -> Result<Real<K>, Stop> {
        let mut total = Real::new(0.0);
        self.walk(at, residuals, &mut |value| {
            let Conditional { log_density, deviate } = value;
            hear(&deviate);
            hear(&(-log_density - 0.5 * deviate * deviate));
            total += log_density;
        })?;
        Ok(total)
    }

    /// By what factor errors are wider where this is predicted, in the
    /// recording's unit; `None` where it does not matter. What `walk` and
    /// `draw` then see and make are errors over their width.
    ///
    /// Errors of a tenth of the speed, and of 0.2 m/s at rest, are a noise
    /// of variance 1 with the width 0.2 + 0.1 |v|.
    #[inline]
    fn width(&self, _predicted: Real<K>) -> Option<Real<K>> {
        None
    }

    /// The standard normal deviate that a [`Conditional::deviate`] stands
    /// for; the same number where the innovations are normal.
    fn standardise(&self, deviate: f64) -> f64 {
        deviate
    }

    /// How large its errors are, where each depends on those before it.
    fn stationary(&self) -> Option<Stationary> {
        None
    }

    /// The innovations as standard normal deviates: independent draws of
    /// N(0, 1) where the noise is the one that made the residuals.
    fn innovations(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
    ) -> Result<Vec<f64>, Stop> {
        let mut deviates = Vec::with_capacity(residuals.len());
        self.walk(at, residuals, &mut |value| {
            deviates.push(value.deviate.value());
        })?;
        Ok(deviates.into_iter().map(|d| self.standardise(d)).collect())
    }
}

/// Fails where there is not one residual per time.
fn one_per_time<T>(at: &Grid, residuals: &[T]) -> Result<(), Stop> {
    if residuals.len() == at.len() {
        return Ok(());
    }
    Err(Stop::Fail(Error::inference(format!(
        "{} residuals for {} recorded times",
        residuals.len(),
        at.len()
    ))))
}

/// Whether a parameter is a positive finite number.
fn is_positive<K: Kind>(x: Real<K>) -> bool {
    x > 0.0 && x.value().is_finite()
}
