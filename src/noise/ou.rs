//! Errors that are forgotten steadily.

use smallvec::smallvec;

use super::part::{
    Lapse, Memory, Part, Square, Transition, Whole, check_increasing,
};
use super::{Grid, is_positive};
use crate::block::{Block, Field};
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// The process of Ornstein and Uhlenbeck (1930): errors dt apart have the
/// covariance sd^2 exp(-|dt|/time). The continuous form of AR(1), with
/// phi = exp(-step/time).
///
/// ```
/// use couloir::noise::{Ar, Grid, Noise, Ou};
/// use couloir::scalar::{Plain, Real};
/// let x = Real::<Plain>::new;
/// let at = Grid::new(vec![0.0, 0.5, 1.0], None);
/// let values = [x(1.0), x(0.3), x(-0.2)];
/// let ou = Ou { sd_ou: x(2.0), time_ou: x(1.5) };
/// let phi = (-0.5_f64 / 1.5).exp();
/// let sigma2 = x(4.0 * (1.0 - phi * phi));
/// let ar = Ar { phi: [x(phi)].into_iter().collect(), sigma2 };
/// let [ou, ar] = [ou.log_likelihood(&at, &values), ar.log_likelihood(&at, &values)];
/// assert!((ou.unwrap().value() - ar.unwrap().value()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Ou<S> {
    /// The standard deviation, in the unit of the recording.
    pub sd_ou: S,
    /// The time after which the correlation has fallen to 1/e \[s\].
    pub time_ou: S,
}

impl<S: Clone> Block<S> for Ou<S> {
    const NAME: &'static str = "ou";
    const FIELDS: &'static [Field] = &[
        Field::new("sd_ou", "value", "LogNormal(ln 0.02 size, 1)"),
        Field::new("time_ou", "s", "LogNormal(ln 0.03 duration, 1)"),
    ];

    fn from_values(values: &[S]) -> Self {
        Self { sd_ou: values[0].clone(), time_ou: values[1].clone() }
    }
}

impl<K: Kind> Part<K> for Ou<Real<K>> {
    fn join<'a>(&'a self, whole: &mut Whole<'a, K>) {
        whole.remember(self);
    }
}

impl<K: Kind> Memory<K> for Ou<Real<K>> {
    fn states(&self) -> usize {
        1
    }

    fn exists(&self, at: &Grid) -> crate::Result<()> {
        check_increasing("ou", at)
    }

    fn allows(&self, _: &Grid) -> Result<(), Stop> {
        if is_positive(self.sd_ou) && is_positive(self.time_ou) {
            return Ok(());
        }
        Err(Stop::Reject("sd_ou or time_ou is not positive"))
    }

    fn covariance(&self) -> Square<K> {
        smallvec![self.sd_ou.squared()]
    }

    fn over(&self, lapse: Lapse) -> Transition<K> {
        let gone = Real::new(lapse.seconds) / self.time_ou;
        let lost = -(-2.0 * gone).exp_m1();
        Transition {
            matrix: smallvec![(-gone).exp()],
            noise: smallvec![self.sd_ou.squared() * lost],
        }
    }
}
