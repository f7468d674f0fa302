//! A system of equations as a block.

use super::solver::solve;
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// A system of `N` ordinary differential equations whose parameters are the
/// fields of a block: y' = rate(t, y).
///
/// ```
/// use couloir::ode::System;
/// use couloir::prelude::*;
///
/// /// y' = r y (1 - y / capacity) (Verhulst 1838).
/// struct Logistic<S> {
///     r: S,
///     capacity: S,
/// }
/// impl<S: Copy> Block<S> for Logistic<S> {
///     const NAME: &'static str = "logistic";
///     const FIELDS: &'static [Field] = &[
///         Field::new("r", "1/s", "LogNormal(0, 1)"),
///         Field::new("capacity", "1", "LogNormal(0, 1)"),
///     ];
///     fn from_values(values: &[S]) -> Self {
///         Self { r: values[0], capacity: values[1] }
///     }
/// }
/// impl<K: Kind> System<K, 1> for Logistic<Real<K>> {
///     fn rate(&self, _: f64, [y]: [Real<K>; 1]) -> [Real<K>; 1] {
///         [self.r * y * (1.0 - y / self.capacity)]
///     }
/// }
/// model! {
///     struct Growth { times: Vec<f64>, seen: Vec<f64> }
///     growth ~ Logistic { r: LogNormal(0.0, 1.0), capacity = 1.0 };
///     likelihood {
///         let path = growth.solve((0.0, [0.01.into()]), times)?;
///         for (seen, [y]) in seen.iter().zip(path) {
///             seen ~ Normal(y, 0.1);
///         }
///     }
/// }
/// let growth = Growth::new(vec![2.0, 6.0], vec![0.1, 0.8]);
/// assert_eq!(Posterior::new(&growth)?.parameters()[0].name, "r");
/// # Ok::<(), Error>(())
/// ```
pub trait System<K: Kind, const N: usize> {
    /// The derivatives of the state by time.
    fn rate(&self, time: f64, state: [Real<K>; N]) -> [Real<K>; N];

    /// The states at `times`, from one at a time before them; see
    /// [`solve`](super::solve()).
    ///
    /// # Errors
    /// As [`solve`](super::solve()).
    fn solve(
        &self,
        start: (f64, [Real<K>; N]),
        times: &[f64],
    ) -> Result<Vec<[Real<K>; N]>, Stop> {
        solve(|time, state| self.rate(time, state), start, times)
    }
}
