//! Errors as real recordings have them, drawn from their covariance.
//!
//! Written for the challenge alone: one dense matrix and its root, where the
//! engine filters. A slip in either shows as a noise that is not recognised.

use std::f64::consts::{PI, TAU};

use rand::RngExt;
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use super::scatter::Scatter;
use crate::seed::Rng;

/// Degrees of freedom of errors with tails.
const FREEDOM: f64 = 3.0;
/// By how much errors grow from the first to the last.
const GROWTH: f64 = 3.0;

/// A part of the errors that remembers: its standard deviation \[m/s\] and
/// the time it remembers for \[s\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Process {
    sd: f64,
    time: f64,
}

/// What makes the errors of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Instrument {
    pub(super) scatter: Scatter,
    /// Matern's process of smoothness 3/2.
    smooth: Process,
    /// That of Ornstein and Uhlenbeck.
    rough: Process,
    /// The standard deviation of independent errors \[m/s\].
    white: f64,
}

impl Instrument {
    /// An instrument whose errors have, over the recording, the variance
    /// `sd` squared.
    pub(super) fn draw(scatter: Scatter, sd: f64, rng: &mut Rng) -> Self {
        let mut between = |low: f64, high: f64| rng.random_range(low..high);
        let none = Process::default();
        let even = Self { scatter, smooth: none, rough: none, white: sd };
        match scatter {
            Scatter::Smooth => {
                let (time, part) = (between(0.2, 0.6), between(0.01, 0.1));
                let smooth = Process { sd: sd * (1.0 - part).sqrt(), time };
                Self { smooth, white: sd * part.sqrt(), ..even }
            }
            Scatter::Drifting => {
                let (time, part) = (between(0.2, 0.6), between(0.3, 0.7));
                let smooth = Process { sd: sd * (1.0 - part).sqrt(), time };
                let time = between(2.0, 6.0);
                let rough = Process { sd: sd * part.sqrt(), time };
                Self { smooth, rough, white: 0.0, ..even }
            }
            Scatter::Correlated => {
                let (time, part) = (between(0.5, 2.0), between(0.2, 0.5));
                let rough = Process { sd: sd * (1.0 - part).sqrt(), time };
                Self { rough, white: sd * part.sqrt(), ..even }
            }
            _ => even,
        }
    }

    /// The covariance \[m2/s2\] of what remembers, of errors so many seconds
    /// apart.
    fn remembered(&self, apart: f64) -> f64 {
        let Self { smooth, rough, .. } = *self;
        let part = |process: Process, of: &dyn Fn(f64) -> f64| {
            if process.sd == 0.0 {
                return 0.0;
            }
            process.sd.powi(2) * of(apart / process.time)
        };
        let matern = |x: f64| {
            let q = 3f64.sqrt() * x;
            (1.0 + q) * (-q).exp()
        };
        part(smooth, &matern) + part(rough, &|x| (-x).exp())
    }

    /// The same instrument at the times of a recording \[s\].
    pub(super) fn at(self, times: &[f64]) -> Recorder {
        let sizes = self.sizes(times);
        let covariance = |i: usize, j: usize| {
            let own = if i == j { self.white.powi(2) } else { 0.0 };
            let apart = (times[i] - times[j]).abs();
            sizes[i] * sizes[j] * (own + self.remembered(apart))
        };
        Recorder { scatter: self.scatter, root: root(times.len(), covariance) }
    }

    /// How large each error is against the instrument's standard deviation,
    /// 1 in the mean of the squares.
    fn sizes(&self, times: &[f64]) -> Vec<f64> {
        if self.scatter != Scatter::Growing {
            return vec![1.0; times.len()];
        }
        let [first, last] = [0, times.len() - 1].map(|i| times[i]);
        let size = |t: &f64| GROWTH.powf((t - first) / (last - first));
        let all: Vec<f64> = times.iter().map(size).collect();
        let square = all.iter().map(|x| x * x).sum::<f64>();
        let mean = (square / all.len() as f64).sqrt();
        all.into_iter().map(|x| x / mean).collect()
    }
}

/// An instrument at the times of one recording.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Recorder {
    scatter: Scatter,
    /// The lower triangular root of the covariance, row by row.
    root: Vec<Vec<f64>>,
}

impl Recorder {
    /// Errors \[m/s\], one for each time.
    pub(super) fn draw(&self, rng: &mut Rng) -> Vec<f64> {
        let fresh: Vec<f64> =
            self.root.iter().map(|_| self.fresh(rng)).collect();
        let sum = |row: &Vec<f64>| {
            row.iter().zip(&fresh).map(|(a, z)| a * z).sum::<f64>()
        };
        self.root.iter().map(sum).collect()
    }

    /// A number of variance 1: Student's t over its standard deviation, or a
    /// normal one.
    fn fresh(&self, rng: &mut Rng) -> f64 {
        let z: f64 = StandardNormal.sample(rng);
        match ChiSquared::new(FREEDOM) {
            Ok(chi) if self.scatter == Scatter::Tailed => {
                z * ((FREEDOM - 2.0) / chi.sample(rng)).sqrt()
            }
            _ => z,
        }
    }

    /// The logarithm of the density of errors.
    pub(super) fn log_density(&self, errors: &[f64]) -> f64 {
        let mut fresh: Vec<f64> = Vec::with_capacity(errors.len());
        let mut total = 0.0;
        for (row, error) in self.root.iter().zip(errors) {
            let known: f64 = row.iter().zip(&fresh).map(|(a, z)| a * z).sum();
            let size = row[fresh.len()];
            let z = (error - known) / size;
            total += self.log_fresh(z) - size.ln();
            fresh.push(z);
        }
        total
    }

    /// The logarithm of the density of a fresh number.
    fn log_fresh(&self, z: f64) -> f64 {
        if self.scatter == Scatter::Tailed {
            // t of three degrees of freedom over the root of 3, its standard
            // deviation: 2/(pi (1 + z2)2).
            return (2.0 / PI).ln() - 2.0 * (z * z).ln_1p();
        }
        -0.5 * (z * z + TAU.ln())
    }
}

/// The lower triangular root of a positive definite matrix (Cholesky's).
fn root(
    count: usize,
    covariance: impl Fn(usize, usize) -> f64,
) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(count);
    for i in 0..count {
        let mut row: Vec<f64> = Vec::with_capacity(i + 1);
        for (j, other) in rows.iter().enumerate() {
            let common: f64 = row.iter().zip(other).map(|(a, b)| a * b).sum();
            row.push((covariance(i, j) - common) / other[j]);
        }
        let told: f64 = row.iter().map(|a| a * a).sum();
        row.push((covariance(i, i) - told).sqrt());
        rows.push(row);
    }
    rows
}

#[cfg(test)]
mod tests;
