//! Independent normal errors, as a summand.

use super::part::{Part, Whole};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// Independent errors N(0, sigma2) beside others: what [`Iid`](super::Iid) is
/// by itself.
///
/// ```
/// use couloir::block::Sum;
/// use couloir::noise::{Grid, Noise, Ou, White};
/// use couloir::scalar::{Plain, Real};
/// let x = Real::<Plain>::new;
/// let slow = Ou { sd_ou: x(1.0), time_ou: x(2.0) };
/// let noise = Sum::new(slow, White { sigma2: x(3.0) });
/// let at = Grid::new(vec![0.0], None);
/// let total = noise.log_likelihood(&at, &[x(2.0)]).unwrap();
/// // N(2; 0, 1 + 3).
/// let density = (-0.5_f64).exp() / (8.0 * std::f64::consts::PI).sqrt();
/// assert!((total.value() - density.ln()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct White<S> {
    /// The variance, in the squared unit of the recording.
    pub sigma2: S,
}

impl<S: Clone> Block<S> for White<S> {
    const NAME: &'static str = "white";
    const FIELDS: &'static [Field] =
        &[Field::new("sigma2", "value2", "LogNormal(ln 1e-4 size2, 2)")];

    fn from_values(values: &[S]) -> Self {
        Self { sigma2: values[0].clone() }
    }
}

impl<K: Kind> Part<K> for White<Real<K>> {
    fn join<'a>(&'a self, whole: &mut Whole<'a, K>) {
        whole.scatter(self.sigma2);
    }
}
