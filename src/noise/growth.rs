//! Errors that grow along a recording.

use super::part::{Part, Whole};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// Errors are exp(growth (x - 1/2)) times as large, x the share of the
/// recording's time that has passed: the others' parameters are those in its
/// middle. Known standard errors are not changed.
///
/// ```
/// use couloir::block::Sum;
/// use couloir::noise::{Grid, Growth, Iid, Noise, White};
/// use couloir::scalar::{Plain, Real};
/// let x = Real::<Plain>::new;
/// let growth = Growth { growth: x(9f64.ln()) };
/// let noise = Sum::new(White { sigma2: x(1.0) }, growth);
/// let at = Grid::new(vec![0.0, 5.0, 10.0], None);
/// // A third, one, three.
/// let found = noise.log_likelihood(&at, &[x(1.0 / 3.0), x(1.0), x(3.0)]);
/// let even = Iid { sigma2: x(1.0) }.log_likelihood(&at, &[x(1.0); 3]);
/// assert!((found.unwrap().value() - even.unwrap().value()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Growth<S> {
    /// The logarithm of the last standard deviation over the first.
    pub growth: S,
}

impl<S: Clone> Block<S> for Growth<S> {
    const NAME: &'static str = "growth";
    const FIELDS: &'static [Field] =
        &[Field::new("growth", "1", "Normal(0, 1)")];

    fn from_values(values: &[S]) -> Self {
        Self { growth: values[0].clone() }
    }
}

impl<K: Kind> Part<K> for Growth<Real<K>> {
    fn join<'a>(&'a self, whole: &mut Whole<'a, K>) {
        whole.grow(self.growth);
    }
}
