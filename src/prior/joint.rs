//! Distributions of several numbers at once.

use super::Prior;
use crate::block::List;
use crate::error::Result;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// A distribution of several numbers that depend on each other, told one
/// after the other: the density of all is the product of each one's given
/// those before it, and so is the Jacobian of the way to the real line.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a distribution of several numbers",
    label = "`name[n] ~ ..` takes a distribution of one number for each, or \
             one of several, such as `Ordered(..)`"
)]
pub trait Joint<K: Kind> {
    /// An input error unless there can be `count` numbers.
    ///
    /// # Errors
    /// What was found, and what was expected.
    fn check(&self, count: usize) -> Result<()>;

    /// The prior of the next of `count` numbers, given those before it.
    fn next(&self, count: usize, before: &[Real<K>]) -> impl Prior<K>;

    /// Whether those before it determine the last number, which then is no
    /// unknown.
    fn determines_last(&self) -> bool;

    /// The last number, where those before it determine it.
    fn last(&self, before: &[Real<K>]) -> Real<K>;

    /// One draw of `count` numbers; `None` as [`Distribution::draw`].
    ///
    /// [`Distribution::draw`]: super::Distribution::draw
    fn draw(&self, count: usize, rng: &mut Rng) -> Option<List<f64>>;
}
