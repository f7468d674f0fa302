//! The exact filter of a noise that is a sum of parts.
//!
//! The state of all its processes is normal given the values so far (Kalman
//! 1960); the likelihood is that of each value given those before it
//! (prediction error decomposition, Harvey 1989, chapter 3). Cost is linear in
//! the number of values, for any times.

mod even;
mod kalman;
mod state;

use rand_distr::{Distribution, StandardNormal, StudentT};

use self::even::Even;
use self::kalman::Kalman;
use self::state::{Expected, Follows};
use super::gaussian::Gaussian;
use super::like::noise_like;
use super::part::{Lapse, MOST_STATES, Part, Whole};
use super::student::{Known, Law, log_peak, normal_score};
use super::{
    Conditional, Grid, Matern32, Noise, Ou, Spacing, White, one_per_time,
};
use crate::block::Sum;
use crate::error::Stop;
use crate::prior::LN_SQRT_2PI;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Residuals to be looked at, or none yet: to be drawn.
enum Residuals<'r, K: Kind> {
    Seen(&'r [Real<K>]),
    Drawn(&'r mut Rng, &'r mut Vec<f64>),
}

/// The prediction error of a value over its size.
struct Innovation<K: Kind> {
    error: Real<K>,
    /// Its variance, and one over that.
    variance: Real<K>,
    precision: Real<K>,
    /// Whether that is the variance of the value before.
    is_same: bool,
    /// The logarithm of the value's size.
    log_size: Option<Real<K>>,
}

/// The sum of logarithms, by that of the product as far as a number holds it.
struct LogSum<K: Kind> {
    sum: Real<K>,
    product: Real<K>,
}

impl<K: Kind> LogSum<K> {
    fn new() -> Self {
        Self { sum: Real::new(0.0), product: Real::new(1.0) }
    }

    #[inline(always)]
    fn add(&mut self, x: Real<K>) {
        // Of either as far from 1 as this the product is a number.
        const FAR: f64 = 1e140;
        let far = |x: Real<K>| !(1.0 / FAR..=FAR).contains(&x.value());
        if far(x) || far(self.product) {
            self.sum += self.product.ln();
            self.product = Real::new(1.0);
        }
        self.product *= x;
    }

    fn total(self) -> Real<K> {
        self.sum + self.product.ln()
    }
}

impl<K: Kind> Whole<'_, K> {
    /// Visits each value's prediction error.
    fn each(
        &self,
        at: &Grid,
        residuals: Residuals<'_, K>,
        visit: impl FnMut(&Innovation<K>),
    ) -> Result<(), Stop> {
        self.admit(at)?;
        let is_even = *at.spacing() == Spacing::Regular
            && at.standard_errors().is_none();
        match self.states() {
            0..=1 => self.filtered::<1>(at, is_even, residuals, visit),
            2 => self.filtered::<2>(at, is_even, residuals, visit),
            3 => self.filtered::<3>(at, is_even, residuals, visit),
            4..=6 => self.filtered::<6>(at, is_even, residuals, visit),
            _ => self.filtered::<MOST_STATES>(at, is_even, residuals, visit),
        }
    }

    /// The same for all but the likelihood: one copy of the filters serves it,
    /// which calls `visit` for each value.
    fn shown(
        &self,
        at: &Grid,
        residuals: Residuals<'_, K>,
        visit: &mut dyn FnMut(&Innovation<K>),
    ) -> Result<(), Stop> {
        self.each(at, residuals, visit)
    }

    #[inline(always)]
    fn filtered<const N: usize>(
        &self,
        at: &Grid,
        is_even: bool,
        residuals: Residuals<'_, K>,
        visit: impl FnMut(&Innovation<K>),
    ) -> Result<(), Stop> {
        if is_even {
            let lapse = Lapse { seconds: at.step(), steps: 1.0 };
            let filter = Even::<K, N>::new(self, lapse);
            self.followed(at, filter, residuals, visit)
        } else {
            let filter = Kalman::<K, N>::new(self);
            self.followed(at, filter, residuals, visit)
        }
    }

    #[inline(always)]
    fn followed(
        &self,
        at: &Grid,
        mut filter: impl Follows<K>,
        mut residuals: Residuals<'_, K>,
        mut visit: impl FnMut(&Innovation<K>),
    ) -> Result<(), Stop> {
        let errors = at.standard_errors();
        let white = self.white();
        let mut precision = Real::new(f64::NAN);
        for i in 0..at.len() {
            let log_size = self.log_size(at, i);
            let over = log_size.map(|log| (-log).exp());
            let known = errors.map_or(0.0, |s| s[i] * s[i]);
            let own = white + over.map_or(known.into(), |o| o * o * known);
            let expected = filter.expect(Lapse::before(at, i), own);
            let Expected { mean, variance, is_same } = expected;
            if variance <= 0.0 || variance.value().is_nan() {
                return Err(Stop::Reject("a value has no error of its own"));
            }
            let error = match &mut residuals {
                Residuals::Seen(all) => {
                    over.map_or(all[i], |over| all[i] * over) - mean
                }
                Residuals::Drawn(rng, drawn) => {
                    let error = variance.value().sqrt() * self.deviate(rng)?;
                    let size = log_size.map_or(1.0, |log| log.value().exp());
                    drawn.push((mean.value() + error) * size);
                    Real::new(error)
                }
            };
            if !is_same {
                precision = 1.0 / variance;
            }
            let next =
                Innovation { error, variance, precision, is_same, log_size };
            visit(&next);
            filter.learn(error, precision);
        }
        Ok(())
    }

    /// A draw of unit scale with the tails there are.
    fn deviate(&self, rng: &mut Rng) -> Result<f64, Stop> {
        let Some(nu) = self.tails() else {
            return Ok(StandardNormal.sample(rng));
        };
        let nu = nu.value();
        let law = StudentT::new(nu)
            .map_err(|_| Stop::Reject("nu is not positive"))?;
        Ok(law.sample(rng))
    }
}

impl<K: Kind> Noise<K> for Whole<'_, K> {
    fn check(&self, at: &Grid) -> crate::Result<()> {
        self.check(at)
    }

    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        one_per_time(at, residuals)?;
        let seen = Residuals::Seen(residuals);
        let Some(nu) = self.tails() else {
            let mut law = Gaussian::new(Real::new(1.0));
            return self.shown(at, seen, &mut |next| {
                if !next.is_same {
                    law = Gaussian::new(next.variance);
                }
                visit(law.sized(next.error, next.log_size));
            });
        };
        let (peak, known) = (log_peak(nu), Known::of(nu.value()));
        let mut law = Law::new(nu, peak, Real::new(1.0));
        self.shown(at, seen, &mut |next| {
            if !next.is_same {
                law = Law::new(nu, peak, next.variance);
            }
            visit(law.at(next.error, next.log_size, &known));
        })
    }

    fn log_likelihood(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
    ) -> Result<Real<K>, Stop> {
        one_per_time(at, residuals)?;
        let mut total = Real::new(0.0);
        let (mut squares, mut logs) = (total, LogSum::new());
        // One plus each square over nu, where there are tails.
        let mut tails = LogSum::new();
        let over = self.tails().map(|nu| 1.0 / nu);
        self.each(at, Residuals::Seen(residuals), |next| {
            let square = next.error * next.error * next.precision;
            match over {
                None => squares += square,
                Some(over) => tails.add(square * over + 1.0),
            }
            logs.add(next.variance);
            if let Some(log_size) = next.log_size {
                total -= log_size;
            }
        })?;
        total -= 0.5 * logs.total();
        let n = at.len() as f64;
        Ok(match self.tails() {
            None => total - 0.5 * squares - LN_SQRT_2PI * n,
            Some(nu) => {
                total - 0.5 * (nu + 1.0) * tails.total() + log_peak(nu) * n
            }
        })
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        let mut drawn = Vec::with_capacity(at.len());
        self.shown(at, Residuals::Drawn(rng, &mut drawn), &mut |_| {})?;
        Ok(drawn)
    }

    fn standardise(&self, deviate: f64) -> f64 {
        match self.tails() {
            None => deviate,
            Some(nu) => normal_score(deviate, nu.value()),
        }
    }
}

// A block, or a sum of blocks, is the noise that its parts say.
noise_like!(impl[] White<Real<K>>, self => Whole::<K>::of(self));
noise_like!(impl[] Ou<Real<K>>, self => Whole::<K>::of(self));
noise_like!(impl[] Matern32<Real<K>>, self => Whole::<K>::of(self));
noise_like! {
    impl[A: Part<K>, B: Part<K>] Sum<A, B>, self => Whole::<K>::of(self)
}
