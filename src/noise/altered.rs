//! A noise with a change made to it from outside.
//!
//! The residuals are divided by a spread of their own, then filtered as an
//! autoregression's are, and what is left is the noise that it was before;
//! its innovations may be given heavier tails. Each of the three leaves any
//! noise as it was where its amplitude is 0.

use rand_distr::{ChiSquared, Distribution};
use smallvec::SmallVec;

use super::student::{log_peak, normal_score};
use super::{Conditional, Grid, Noise, Stationary};
use crate::error::Stop;
use crate::prior::LN_SQRT_2PI;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// What is changed about a noise.
#[derive(Debug, Clone, Copy)]
pub struct Alteration<K: Kind> {
    /// The autocorrelation of neighbours, one median step apart.
    pub phi: Real<K>,
    /// One over the degrees of freedom of the innovations.
    pub tail: Real<K>,
    /// How the logarithm of the spread rises with the covariate.
    pub spread: Real<K>,
}

impl<K: Kind> Default for Alteration<K> {
    fn default() -> Self {
        let zero = Real::new(0.0);
        Self { phi: zero, tail: zero, spread: zero }
    }
}

impl<K: Kind> Alteration<K> {
    /// Whether it changes nothing.
    pub fn is_none(&self) -> bool {
        self.phi.is_constantly_zero()
            && self.tail.is_constantly_zero()
            && self.spread.is_constantly_zero()
    }
}

/// A noise as an alteration leaves it.
#[derive(Debug, Clone, Copy)]
pub struct Altered<'a, K: Kind, N: ?Sized> {
    /// The noise as it was.
    pub base: &'a N,
    /// What is changed.
    pub change: Alteration<K>,
    /// Along what the spread rises, one number for each value.
    pub covariate: &'a [Real<K>],
}

/// Innovations over what the base takes them for, and ln of that ratio.
type Filtered<K> = SmallVec<[Real<K>; 128]>;

/// A tail below which the innovations are normal to round-off.
const NORMAL: f64 = 1e-8;

impl<K: Kind, N: ?Sized> Altered<'_, K, N> {
    fn log_spread(&self, i: usize) -> Real<K> {
        match self.covariate.get(i) {
            Some(x) => self.change.spread * *x,
            None => Real::new(0.0),
        }
    }

    /// The autocorrelation over a distance of steps, and by what factor the
    /// innovations are wider than over one: (1 - phi^(2 d))/(1 - phi^2).
    fn over(&self, distance: f64) -> (Real<K>, Real<K>) {
        let phi = self.change.phi;
        if distance == 1.0 {
            return (phi, Real::new(1.0));
        }
        if phi <= 0.0 {
            // Between two steps there is none with phi below 0.
            return (Real::new(0.0), Real::new(1.0));
        }
        let a = phi.powf(distance);
        let wider = (1.0 - a * a) / (1.0 - phi * phi);
        (a, wider.sqrt())
    }

    fn filter(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
    ) -> (Filtered<K>, Filtered<K>) {
        let mut before = Real::new(0.0);
        let mut filtered = Filtered::new();
        let mut logs = Filtered::new();
        for (i, &r) in residuals.iter().enumerate() {
            let log_spread = self.log_spread(i);
            let r = r * (-log_spread).exp();
            let (a, wider) = match i {
                0 => {
                    let phi = self.change.phi;
                    (Real::new(0.0), 1.0 / (1.0 - phi * phi).sqrt())
                }
                _ => self.over(at.distance(i)),
            };
            filtered.push((r - a * before) / wider);
            logs.push(log_spread + wider.ln());
            before = r;
        }
        (filtered, logs)
    }

    /// The same innovation with a heavier tail: its scale s is read off the
    /// normal density, ln s = -ln p - d^2/2 - ln sqrt(2 pi).
    fn tailed(&self, value: Conditional<K>) -> Real<K> {
        let d = value.deviate;
        let log_scale = -value.log_density - 0.5 * d * d - LN_SQRT_2PI;
        let tail = self.change.tail;
        let dof = 1.0 / tail;
        log_peak(dof) - 0.5 * (dof + 1.0) * (d * d * tail).ln_1p() - log_scale
    }

    fn is_tailed(&self) -> bool {
        self.change.tail > NORMAL
    }
}

impl<K: Kind, N: Noise<K> + ?Sized> Noise<K> for Altered<'_, K, N> {
    fn check(&self, at: &Grid) -> crate::Result<()> {
        self.base.check(at)
    }

    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        let (filtered, logs) = self.filter(at, residuals);
        let mut logs = logs.into_iter();
        self.base.walk(at, &filtered, &mut |mut value| {
            if self.is_tailed() {
                value.log_density = self.tailed(value);
            }
            value.log_density -= logs.next().unwrap_or(Real::new(0.0));
            visit(value);
        })
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        let mut drawn = self.base.draw(at, rng)?;
        let tail = self.change.tail.value();
        let mut before = 0.0;
        for (i, r) in drawn.iter_mut().enumerate() {
            if self.is_tailed()
                && let Ok(law) = ChiSquared::new(1.0 / tail)
            {
                *r *= (1.0 / (tail * law.sample(rng))).sqrt();
            }
            let (a, wider) = match i {
                0 => {
                    (0.0, 1.0 / (1.0 - self.change.phi.value().powi(2)).sqrt())
                }
                _ => {
                    let (a, wider) = self.over(at.distance(i));
                    (a.value(), wider.value())
                }
            };
            before = a * before + wider * *r;
            *r = before * self.log_spread(i).value().exp();
        }
        Ok(drawn)
    }

    fn stationary(&self) -> Option<Stationary> {
        self.base.stationary()
    }

    fn width(&self, predicted: Real<K>) -> Option<Real<K>> {
        self.base.width(predicted)
    }

    fn standardise(&self, deviate: f64) -> f64 {
        if self.is_tailed() {
            normal_score(deviate, 1.0 / self.change.tail.value())
        } else {
            self.base.standardise(deviate)
        }
    }
}
