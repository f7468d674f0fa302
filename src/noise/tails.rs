//! Heavy tails of what errors do not remember.

use super::part::{Part, Whole};
use crate::block::{Block, Field};
use crate::scalar::{Kind, Real};

/// What of an error is not told by those before it is t distributed with nu
/// degrees of freedom:
///
///   r_i ~ t_nu(m_i, v_i),
///
/// m_i the mean and v_i the variance given all before, which is here the
/// squared scale (Lange, Little and Taylor 1989, for each value in turn). The
/// other blocks' variances are then those of the core: of errors without their
/// outliers, which nu hardly changes. A variance of all, nu/(nu - 2) times as
/// large, would be as uncertain as nu is. By default nu has its median at 5 and
/// nine tenths between 1.6 and 16: with more a noise without tails does.
///
/// ```
/// use couloir::block::Sum;
/// use couloir::noise::{Grid, Noise, Student, Tails, White};
/// use couloir::scalar::{Plain, Real};
/// let x = Real::<Plain>::new;
/// let noise = Sum::new(White { sigma2: x(3.0) }, Tails { nu: x(6.0) });
/// let same = Student { dof: x(6.0), scale: x(3f64.sqrt()) };
/// let (at, r) = (Grid::new(vec![0.0], None), [x(2.0)]);
/// let [a, b] = [noise.log_likelihood(&at, &r), same.log_likelihood(&at, &r)];
/// assert!((a.unwrap().value() - b.unwrap().value()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Tails<S> {
    /// The degrees of freedom, a positive pure number.
    pub nu: S,
}

impl<S: Clone> Block<S> for Tails<S> {
    const NAME: &'static str = "tails";
    const FIELDS: &'static [Field] =
        &[Field::new("nu", "1", "LogNormal(1.6, 0.7)")];

    fn from_values(values: &[S]) -> Self {
        Self { nu: values[0].clone() }
    }
}

impl<K: Kind> Part<K> for Tails<Real<K>> {
    fn join<'a>(&'a self, whole: &mut Whole<'a, K>) {
        whole.tail(self.nu);
    }
}
