//! Smooth errors.

use smallvec::smallvec;

use super::part::{
    Lapse, Memory, Part, Square, Transition, Whole, check_increasing,
};
use super::{Grid, is_positive};
use crate::block::{Block, Field};
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// Matern's process of smoothness 3/2: errors dt apart have the covariance
/// sd^2 (1 + q) exp(-q), q = sqrt(3) |dt|/time. They change steadily, as what
/// a receiver's filter leaves does.
///
/// The state is (x, x'/k) with k = sqrt(3)/time, so that its covariance is
/// sd^2 times the identity (Hartikainen and Sarkka 2010).
///
/// ```
/// use couloir::noise::{Grid, Matern32, Noise};
/// use couloir::scalar::{Plain, Real};
/// let x = Real::<Plain>::new;
/// let smooth = Matern32 { sd_matern: x(2.0), time_matern: x(1.0) };
/// let at = Grid::new(vec![0.0, 0.5], None);
/// let total = smooth.log_likelihood(&at, &[x(1.0), x(0.5)]).unwrap();
/// // N(1; 0, 4) N(0.5; c, 4 (1 - c^2)), c = (1 + q) exp(-q).
/// let q = 3f64.sqrt() * 0.5;
/// let c = (1.0 + q) * (-q).exp();
/// let normal = |r: f64, v: f64| -0.5 * (r * r / v + (std::f64::consts::TAU * v).ln());
/// let known = normal(1.0, 4.0) + normal(0.5 - c, 4.0 * (1.0 - c * c));
/// assert!((total.value() - known).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Matern32<S> {
    /// The standard deviation, in the unit of the recording.
    pub sd_matern: S,
    /// The time over which errors are alike \[s\]: they have a correlation of
    /// 0.48 after it.
    pub time_matern: S,
}

impl<S: Clone> Block<S> for Matern32<S> {
    const NAME: &'static str = "matern32";
    const FIELDS: &'static [Field] = &[
        Field::new("sd_matern", "value", "LogNormal(ln 0.02 size, 1)"),
        Field::new("time_matern", "s", "LogNormal(ln 0.03 duration, 1)"),
    ];

    fn from_values(values: &[S]) -> Self {
        Self { sd_matern: values[0].clone(), time_matern: values[1].clone() }
    }
}

impl<K: Kind> Part<K> for Matern32<Real<K>> {
    fn join<'a>(&'a self, whole: &mut Whole<'a, K>) {
        whole.remember(self);
    }
}

impl<K: Kind> Memory<K> for Matern32<Real<K>> {
    fn states(&self) -> usize {
        2
    }

    fn exists(&self, at: &Grid) -> crate::Result<()> {
        check_increasing("matern32", at)
    }

    fn allows(&self, _: &Grid) -> Result<(), Stop> {
        if is_positive(self.sd_matern) && is_positive(self.time_matern) {
            return Ok(());
        }
        Err(Stop::Reject("sd_matern or time_matern is not positive"))
    }

    fn covariance(&self) -> Square<K> {
        let (zero, variance) = (Real::new(0.0), self.sd_matern.squared());
        smallvec![variance, zero, zero, variance]
    }

    /// With x = k dt: F = exp(-x) \[\[1 + x, x\], \[-x, 1 - x\]\] and
    /// Q = sd^2 (1 - F F').
    fn over(&self, lapse: Lapse) -> Transition<K> {
        let x = Real::new(3f64.sqrt() * lapse.seconds) / self.time_matern;
        let decay = (-x).exp();
        let (y, square) = (2.0 * x, decay * decay);
        let variance = self.sd_matern.squared();
        let across = variance * (0.5 * y * y * square);
        let speed = square * (y - 0.5 * y * y) - (-y).exp_m1();
        Transition {
            matrix: smallvec![
                decay * (x + 1.0),
                decay * x,
                -(decay * x),
                decay * (1.0 - x),
            ],
            noise: smallvec![
                variance * lost(y),
                across,
                across,
                variance * speed
            ],
        }
    }
}

/// 1 - exp(-y) (1 + y + y^2/2), by exp(-y) (y^3/3! + y^4/4! + ..) where the
/// difference would lose its digits.
fn lost<K: Kind>(y: Real<K>) -> Real<K> {
    if y > 1.0 {
        return 1.0 - (-y).exp() * (0.5 * y * y + y + 1.0);
    }
    let mut factorial = 2.0;
    let series: [f64; 16] = std::array::from_fn(|n| {
        factorial *= (n + 3) as f64;
        1.0 / factorial
    });
    (-y).exp() * y * y * y * y.polynomial(&series)
}
