//! Errors have the covariance, the tails and the growth that they are said
//! to have.

use super::*;
use crate::seed::Seed;

/// How many recordings a covariance is estimated from.
const MANY: usize = 20_000;
/// How many standard errors of the estimate are allowed: 1 in 15 000 is
/// beyond.
const ALLOWED: f64 = 4.0;

fn times(count: usize) -> Vec<f64> {
    (1..=count).map(|i| 0.1 * i as f64).collect()
}

fn instrument(scatter: Scatter) -> Instrument {
    Instrument::draw(scatter, 0.3, &mut Seed::new(4).rng())
}

fn drawn(scatter: Scatter, count: usize) -> Vec<Vec<f64>> {
    let recorder = instrument(scatter).at(&times(count));
    let mut rng = Seed::new(11).rng();
    (0..MANY).map(|_| recorder.draw(&mut rng)).collect()
}

/// The covariance of two errors, each of mean 0, with its standard error.
fn covariance(all: &[Vec<f64>], i: usize, j: usize) -> (f64, f64) {
    let count = all.len() as f64;
    let mean = |of: &dyn Fn(&Vec<f64>) -> f64| {
        all.iter().map(of).sum::<f64>() / count
    };
    let found = mean(&|e| e[i] * e[j]);
    let spread = mean(&|e| (e[i] * e[j] - found).powi(2));
    (found, (spread / count).sqrt())
}

fn agrees(all: &[Vec<f64>], [i, j]: [usize; 2], expected: f64) {
    let (found, se) = covariance(all, i, j);
    let off = (found - expected).abs();
    assert!(off < ALLOWED * se, "{i} {j}: {found} {expected} {se}");
}

#[test]
fn errors_that_remember_have_their_covariance() {
    let matern = |p: Process, dt: f64| {
        let q = 3f64.sqrt() * dt / p.time;
        p.sd * p.sd * (1.0 + q) * (-q).exp()
    };
    let ou = |p: Process, dt: f64| p.sd * p.sd * (-dt / p.time).exp();
    for scatter in [Scatter::Smooth, Scatter::Drifting, Scatter::Correlated] {
        let all = drawn(scatter, 40);
        let Instrument { smooth, rough, white, .. } = instrument(scatter);
        let known = |dt: f64| match scatter {
            Scatter::Smooth => matern(smooth, dt),
            Scatter::Drifting => matern(smooth, dt) + ou(rough, dt),
            _ => ou(rough, dt),
        };
        assert!((known(0.0) + white * white - 0.09).abs() < 1e-12);
        agrees(&all, [7, 7], 0.09);
        for lag in [1, 2, 4, 8, 16, 30] {
            agrees(&all, [5, 5 + lag], known(0.1 * lag as f64));
        }
        let smallest = smooth.time.min(0.61).max(rough.time.min(6.0));
        assert!(smallest >= 0.2, "{smallest}");
    }
}

#[test]
fn errors_grow_threefold() {
    let all = drawn(Scatter::Growing, 31);
    let sd = |i: usize| covariance(&all, i, i).0.sqrt();
    // Each standard deviation is known to 1/sqrt(2 N) of itself.
    let se = 3.0 / (MANY as f64).sqrt();
    assert!((sd(30) / sd(0) - 3.0).abs() < ALLOWED * se);
    assert!((sd(15) / sd(0) - 3f64.sqrt()).abs() < ALLOWED * se);
    let square: f64 = (0..31).map(|i| covariance(&all, i, i).0).sum();
    assert!((square / 31.0 - 0.09).abs() < 0.002);
    agrees(&all, [3, 4], 0.0);
}

#[test]
fn tails_are_of_three_degrees_of_freedom() {
    let all = drawn(Scatter::Tailed, 10);
    let count = (MANY * 10) as f64;
    // Quantiles of Student's t from tables; the scale is sd/sqrt(3).
    for (quantile, beyond) in [(0.765, 0.5), (2.353, 0.1), (5.841, 0.01)] {
        let limit = quantile * 0.3 / 3f64.sqrt();
        let out =
            all.iter().flatten().filter(|e: &&f64| e.abs() > limit).count();
        let se = (beyond * (1.0 - beyond) / count).sqrt();
        let share = out as f64 / count;
        assert!((share - beyond).abs() < ALLOWED * se + 2e-4, "{share}");
    }
}

/// The density is that of the draws: the mean of its ratio to another one,
/// under that other, is 1; and of two errors it is known in closed form.
#[test]
fn densities_are_those_of_the_draws() {
    let own = instrument(Scatter::Correlated);
    let at = own.at(&times(2));
    let (v, c) = (0.09, own.rough.sd.powi(2) * (-0.1 / own.rough.time).exp());
    let (a, b) = (0.2, -0.1);
    let det: f64 = v * v - c * c;
    let square = (v * a * a - 2.0 * c * a * b + v * b * b) / det;
    let known = -0.5 * (square + det.ln()) - TAU.ln();
    assert!((at.log_density(&[a, b]) - known).abs() < 1e-12);

    let tailed = instrument(Scatter::Tailed).at(&times(1));
    let width = 1e-3;
    let area: f64 = (-40_000..40_000)
        .map(|i| tailed.log_density(&[width * f64::from(i)]).exp() * width)
        .sum();
    // Beyond 40 m/s lies next to nothing.
    assert!((area - 1.0).abs() < 1e-5, "{area}");
}
