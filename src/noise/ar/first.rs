//! The autoregression of order 1 at any times, with known errors.

use rand_distr::{Distribution, StandardNormal};

use super::levinson::one_minus_square;
use crate::error::Stop;
use crate::noise::gaussian::Gaussian;
use crate::noise::{Grid, Spacing};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// AR(1), or on uneven times the Ornstein-Uhlenbeck process that it samples.
///
/// Over d steps, r moves to a r + N(0, q) with a = phi^d and
/// q = sigma2 (1 - phi^(2 d)) / (1 - phi^2).
#[derive(Debug, Clone, Copy)]
pub(super) struct First<K: Kind> {
    phi: Real<K>,
    sigma2: Real<K>,
    stationary: Real<K>,
    /// The last distance asked for, with its a and q.
    last: (f64, Real<K>, Real<K>),
}

impl<K: Kind> First<K> {
    /// From phi and the innovation variance of one step.
    pub(super) fn new(phi: Real<K>, sigma2: Real<K>) -> Self {
        let stationary = sigma2 / one_minus_square(phi);
        Self { phi, sigma2, stationary, last: (1.0, phi, sigma2) }
    }

    /// a and q over `distance` steps.
    fn over(&mut self, distance: f64) -> (Real<K>, Real<K>) {
        if distance != self.last.0 {
            let (a, q) = self.transition(distance);
            self.last = (distance, a, q);
        }
        (self.last.1, self.last.2)
    }

    pub(super) fn transition(&self, distance: f64) -> (Real<K>, Real<K>) {
        if distance == 1.0 {
            return (self.phi, self.sigma2);
        }
        if self.phi == 0.0 {
            // Below one step the slope in phi is infinite here, and a sampler
            // is better served by none.
            return (Real::new(0.0), self.sigma2);
        }
        let size = self.phi.abs();
        let a = size.powf(distance);
        let odd = self.phi < 0.0 && distance % 2.0 == 1.0;
        let lost = -(2.0 * distance * size.ln()).exp_m1();
        (if odd { -a } else { a }, self.stationary * lost)
    }

    /// The scalar Kalman filter: visits each residual's error of prediction
    /// with its law.
    pub(super) fn filter(
        mut self,
        at: &Grid,
        residuals: &[Real<K>],
        mut visit: impl FnMut(&Gaussian<K>, Real<K>),
    ) -> Result<(), Stop> {
        let errors = at.standard_errors();
        let (mut mean, mut variance) = (Real::new(0.0), self.stationary);
        for (i, &r) in residuals.iter().enumerate() {
            if i > 0 {
                let (a, q) = self.over(at.distance(i));
                mean *= a;
                variance = a * a * variance + q;
            }
            let known = errors.map_or(0.0, |s| s[i] * s[i]);
            let total = variance + known;
            if total <= 0.0 {
                return Err(Stop::Reject("two values have the same time"));
            }
            visit(&Gaussian::new(total), r - mean);
            if known > 0.0 {
                let gain = variance / total;
                mean += gain * (r - mean);
                variance = gain * known;
            } else {
                (mean, variance) = (r, Real::new(0.0));
            }
        }
        Ok(())
    }

    /// Draws the process, without errors of measurement.
    pub(super) fn draw(mut self, at: &Grid, rng: &mut Rng) -> Vec<f64> {
        let mut r = 0.0;
        (0..at.len())
            .map(|i| {
                let (a, q) = match i {
                    0 => (Real::new(0.0), self.stationary),
                    _ => self.over(at.distance(i)),
                };
                let z: f64 = StandardNormal.sample(rng);
                r = a.value() * r + q.value().sqrt() * z;
                r
            })
            .collect()
    }

    /// Rejects the sign that has no process between the steps.
    pub(super) fn admit(&self, at: &Grid) -> Result<(), Stop> {
        if *at.spacing() == Spacing::Uneven && self.phi < 0.0 {
            return Err(Stop::Reject(
                "on uneven times ar(1) has no process with phi below 0",
            ));
        }
        Ok(())
    }
}
