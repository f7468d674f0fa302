//! Fitting a mixture to weighted draws.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;

use super::{Component, FREEDOM, Mixture, Shares, inflated, moments};
use crate::seed::Rng;

/// The most rounds of a fit.
const ROUNDS: usize = 60;

/// A gain of the mean log density, by a round, below which a fit ends: a
/// proposal is none the worse for what is left.
const ENOUGH: f64 = 1e-4;

impl Mixture {
    /// Fits as many components, up to `most`, as lower the Bayesian
    /// information criterion of weighted draws (rows on the real line).
    /// `None` where not even one can be fitted.
    pub fn fit(
        draws: &[Vec<f64>],
        weights: &[f64],
        most: usize,
        rng: &mut Rng,
    ) -> Option<Self> {
        let points: Vec<DVector<f64>> =
            draws.iter().map(|z| DVector::from_column_slice(z)).collect();
        let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let mut best: Option<(f64, Self)> = None;
        for count in 1..=most {
            let Some(fitted) =
                expectation_maximisation(&points, weights, count, rng)
            else {
                continue;
            };
            let score = fitted.criterion(&points, weights, effective);
            if best.as_ref().is_none_or(|(lowest, _)| score < *lowest) {
                best = Some((score, fitted));
            } else if best.as_ref().is_some_and(|(_, b)| b.few(count)) {
                break;
            }
        }
        best.and_then(|(_, fitted)| inflated(&fitted.components))
    }

    /// Whether two more components than it has, up to `count`, did not help.
    fn few(&self, count: usize) -> bool {
        count >= self.components.len() + 2
    }

    fn criterion(
        &self,
        points: &[DVector<f64>],
        weights: &[f64],
        effective: f64,
    ) -> f64 {
        let n = points[0].len() as f64;
        let count = self.components.len() as f64;
        let unknowns = count * (1.0 + n + 0.5 * n * (n + 1.0)) - 1.0;
        let fit: f64 = points
            .iter()
            .zip(weights)
            .map(|(z, w)| w * self.log_density(z.as_slice()))
            .sum();
        -2.0 * effective * fit + unknowns * effective.ln()
    }
}

/// Fits a mixture by expectation-maximisation for t components (Peel,
/// McLachlan 2000), from centres drawn far apart.
fn expectation_maximisation(
    points: &[DVector<f64>],
    weights: &[f64],
    count: usize,
    rng: &mut Rng,
) -> Option<Mixture> {
    let (mean, covariance) = moments(points, weights)?;
    let whole = Component::new(1.0, mean, &covariance)?;
    let centres = far_apart(points, weights, &whole, count, rng);
    let narrow = &covariance / (count as f64).powi(2);
    let components: Vec<Component> = centres
        .into_iter()
        .map(|m| Component::new(1.0 / count as f64, m, &narrow))
        .collect::<Option<_>>()?;
    let mut mixture = Mixture::from(components);
    let mut fit = f64::NEG_INFINITY;
    for _ in 0..ROUNDS {
        let (next, before) = maximise(points, weights, &mixture)?;
        mixture = next;
        if before - fit < ENOUGH {
            break;
        }
        fit = before;
    }
    Some(mixture)
}

/// One round: responsibilities, then weighted moments of each component. The
/// mean log density before it comes with the new mixture.
fn maximise(
    points: &[DVector<f64>],
    weights: &[f64],
    mixture: &Mixture,
) -> Option<(Mixture, f64)> {
    let (n, count) = (points.first()?.len(), mixture.components());
    let mut totals = vec![0.0; count];
    let mut masses = totals.clone();
    let mut means = vec![DVector::zeros(n); count];
    let mut squares = vec![DMatrix::zeros(n, n); count];
    let (mut fit, mut shares) = (0.0, Shares::default());
    for (z, w) in points.iter().zip(weights).filter(|(_, w)| **w > 0.0) {
        fit += w * shares.at(mixture, z.as_slice());
        for k in 0..count {
            let share = w * shares.of[k];
            // The t's latent precision, given the point.
            let precision =
                (FREEDOM + n as f64) / (FREEDOM + shares.distances[k]);
            totals[k] += share;
            masses[k] += share * precision;
            means[k].axpy(share * precision, z, 1.0);
            squares[k].ger(share * precision, z, z, 1.0);
        }
    }
    let maximised: Vec<Component> = (0..count)
        .map(|k| {
            if totals[k] < 1e-3 {
                return None;
            }
            let mean = &means[k] / masses[k];
            let second = &squares[k] / totals[k];
            let outer = &mean * mean.transpose() * (masses[k] / totals[k]);
            Component::new(totals[k], mean, &(second - outer))
        })
        .collect::<Option<_>>()?;
    Some((Mixture::from(maximised), fit))
}

/// Centres drawn with a probability that grows with the distance to those
/// already chosen (k-means++, Arthur, Vassilvitskii 2007).
fn far_apart(
    points: &[DVector<f64>],
    weights: &[f64],
    whole: &Component,
    count: usize,
    rng: &mut Rng,
) -> Vec<DVector<f64>> {
    let white = |z: &DVector<f64>| {
        let mut d = z - &whole.mean;
        whole.shape.l_dirty().solve_lower_triangular_mut(&mut d);
        d
    };
    let whitened: Vec<_> = points.iter().map(white).collect();
    let mut masses = weights.to_vec();
    let mut centres = Vec::with_capacity(count);
    for _ in 0..count {
        let chosen = draw_index(&masses, rng);
        centres.push(points[chosen].clone());
        for (i, mass) in masses.iter_mut().enumerate() {
            let d = (&whitened[i] - &whitened[chosen]).norm_squared();
            let nearest = if centres.len() == 1 {
                d
            } else {
                d.min(*mass / weights[i].max(f64::MIN_POSITIVE))
            };
            *mass = weights[i] * nearest;
        }
    }
    centres
}

fn draw_index(masses: &[f64], rng: &mut Rng) -> usize {
    let mut left = rng.random::<f64>() * masses.iter().sum::<f64>();
    for (i, mass) in masses.iter().enumerate() {
        left -= mass;
        if left < 0.0 {
            return i;
        }
    }
    masses.len() - 1
}
