//! A mixture of multivariate Student-t distributions, fitted to draws.
//!
//! The proposal of importance sampling and the second start of sequential
//! Monte Carlo: heavier in the tails than what it is fitted to, and with a
//! share of the prior's own draws so that no place is out of reach.

mod fit;
mod mend;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand::RngExt;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use smallvec::SmallVec;
use statrs::function::gamma::ln_gamma;

use super::log_sum_exp;
use crate::seed::Rng;

/// Degrees of freedom of each component: heavy enough to bound the weights
/// of a posterior whose tails are those of its prior.
const FREEDOM: f64 = 5.0;

/// How much wider than the draws each component is made, in variance.
const INFLATION: f64 = 1.3;

/// A mixture of Student-t components on the real line.
#[derive(Debug, Clone)]
pub struct Mixture {
    components: Vec<Component>,
}

#[derive(Debug, Clone)]
struct Component {
    log_weight: f64,
    mean: DVector<f64>,
    shape: Cholesky<f64, Dyn>,
    log_constant: f64,
}

impl Component {
    fn new(
        weight: f64,
        mean: DVector<f64>,
        covariance: &DMatrix<f64>,
    ) -> Option<Self> {
        let n = mean.len() as f64;
        let shape = Cholesky::new(nudged(covariance))?;
        let log_det = 2.0 * shape.l().diagonal().map(f64::ln).sum();
        let log_constant = ln_gamma(0.5 * (FREEDOM + n))
            - ln_gamma(0.5 * FREEDOM)
            - 0.5 * n * (FREEDOM * std::f64::consts::PI).ln()
            - 0.5 * log_det;
        Some(Self { log_weight: weight.ln(), mean, shape, log_constant })
    }

    /// The squared distance from the mean, in units of the shape.
    fn distance(&self, z: &DVector<f64>) -> f64 {
        let factor = self.shape.l_dirty();
        let mut solved = SmallVec::<[f64; 16]>::new();
        for i in 0..self.mean.len() {
            let before = solved.iter().enumerate();
            let known: f64 = before.map(|(j, x)| factor[(i, j)] * x).sum();
            solved.push((z[i] - self.mean[i] - known) / factor[(i, i)]);
        }
        solved.iter().map(|x| x * x).sum()
    }

    fn log_density(&self, z: &DVector<f64>) -> f64 {
        self.log_density_at(self.distance(z))
    }

    /// The log density at such a squared distance.
    fn log_density_at(&self, distance: f64) -> f64 {
        let n = self.mean.len() as f64;
        self.log_weight + self.log_constant
            - 0.5 * (FREEDOM + n) * (distance / FREEDOM).ln_1p()
    }
}

/// A covariance made surely positive definite.
fn nudged(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let mut c = covariance.clone();
    let trace = c.trace().max(1e-12) / c.nrows() as f64;
    for i in 0..c.nrows() {
        c[(i, i)] = c[(i, i)] * (1.0 + 1e-9) + 1e-9 * trace;
    }
    c
}

impl Mixture {
    /// The mixture of given parts: weight, mean and covariance of each.
    /// `None` where there are none.
    pub(super) fn of(
        parts: impl Iterator<Item = (f64, DVector<f64>, DMatrix<f64>)>,
    ) -> Option<Self> {
        let mut components: Vec<Component> = parts
            .filter_map(|(weight, mean, covariance)| {
                Component::new(weight, mean, &covariance)
            })
            .collect();
        let logs = components.iter().map(|c| c.log_weight);
        let total = log_sum_exp(logs.collect::<Vec<_>>().into_iter());
        components.iter_mut().for_each(|c| c.log_weight -= total);
        let mixture = (!components.is_empty()).then_some(Self { components });
        mixture.and_then(|mixture| mixture.inflated())
    }

    /// The same components, each weighing what weighted draws say it holds:
    /// one round of expectation and maximisation for the weights alone
    /// (Douc, Guillin, Marin, Robert 2007).
    #[must_use]
    pub(super) fn reweighted<'z>(
        &self,
        draws: impl Iterator<Item = (&'z [f64], f64)>,
    ) -> Self {
        let mut totals = vec![0.0; self.components.len()];
        for (z, weight) in draws {
            let z = DVector::from_column_slice(z);
            let logs: Vec<f64> =
                self.components.iter().map(|c| c.log_density(&z)).collect();
            let total = log_sum_exp(logs.iter().copied());
            for (sum, log) in totals.iter_mut().zip(logs) {
                *sum += weight * (log - total).exp();
            }
        }
        // Half of the old weight stays: a round may have missed a part.
        let mut components = self.components.clone();
        for (component, total) in components.iter_mut().zip(totals) {
            let before = component.log_weight.exp();
            component.log_weight = (0.5 * (before + total)).ln();
        }
        Self { components }
    }

    /// The components of both, either half of the weight.
    #[must_use]
    pub(super) fn beside(mut self, other: Self) -> Self {
        self.components.extend(other.components);
        for component in &mut self.components {
            component.log_weight -= std::f64::consts::LN_2;
        }
        self
    }

    fn inflated(&self) -> Option<Self> {
        let wide = |c: &Component| {
            let covariance = c.shape.l() * c.shape.l().transpose() * INFLATION;
            Component::new(c.log_weight.exp(), c.mean.clone(), &covariance)
        };
        let components =
            self.components.iter().map(wide).collect::<Option<_>>()?;
        Some(Self { components })
    }

    /// How many components it has.
    pub fn components(&self) -> usize {
        self.components.len()
    }

    /// The log density at a place on the real line.
    pub fn log_density(&self, z: &[f64]) -> f64 {
        self.log_density_at(&DVector::from_column_slice(z))
    }

    fn log_density_at(&self, z: &DVector<f64>) -> f64 {
        log_sum_exp(self.components.iter().map(|c| c.log_density(z)))
    }

    /// One draw, a place on the real line.
    pub fn draw(&self, rng: &mut Rng) -> Vec<f64> {
        let mut u: f64 = rng.random();
        let mut chosen = &self.components[0];
        for component in &self.components {
            chosen = component;
            u -= component.log_weight.exp();
            if u < 0.0 {
                break;
            }
        }
        let n = chosen.mean.len();
        let normal = DVector::from_fn(n, |_, _| StandardNormal.sample(rng));
        let shrink = match ChiSquared::new(FREEDOM) {
            Ok(law) => (FREEDOM / law.sample(rng)).sqrt(),
            Err(_) => 1.0,
        };
        let step = chosen.shape.l() * normal * shrink;
        (&chosen.mean + step).as_slice().to_vec()
    }
}

fn moments(
    points: &[DVector<f64>],
    weights: &[f64],
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = points.first()?.len();
    let mut mean = DVector::zeros(n);
    for (z, w) in points.iter().zip(weights) {
        mean.axpy(*w, z, 1.0);
    }
    let mut covariance = DMatrix::zeros(n, n);
    for (z, w) in points.iter().zip(weights) {
        let d = z - &mean;
        covariance.ger(*w, &d, &d, 1.0);
    }
    Some((mean, covariance))
}
