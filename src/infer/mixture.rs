//! A mixture of multivariate Student-t distributions, fitted to draws.
//!
//! The proposal of importance sampling and the second start of sequential
//! Monte Carlo: heavier in the tails than what it is fitted to, and with a
//! share of the prior's own draws so that no place is out of reach.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand::RngExt;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use rayon::prelude::*;
use smallvec::SmallVec;
use statrs::function::gamma::ln_gamma;

use super::log_sum_exp;
use crate::seed::Rng;

/// Degrees of freedom of each component: heavy enough to bound the weights
/// of a posterior whose tails are those of its prior.
const FREEDOM: f64 = 5.0;

/// How much wider than the draws each component is made, in variance.
const INFLATION: f64 = 1.3;

/// A ratio of densities above which a place may need a component of its own,
/// how much such places may add to the relative variance of the weights before
/// they get any, and how many at once.
const TOO_LARGE: f64 = 10.0;
const TOLERATED: f64 = 0.1;
const ADDED: usize = 8;

/// The weight of an added component, and of the draws that tell its shape.
const PATCH: f64 = 0.03;

/// How often all are weighed anew when some were added.
const REWEIGHTED: usize = 3;

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
        best.and_then(|(_, fitted)| fitted.inflated())
    }

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

    /// With components where it is far too low for a density whose logs are
    /// known at weighted draws from it: one at the largest ratio of the two,
    /// as wide as the draws around it, and so on until large ratios add little
    /// to the variance of the weights (Raftery, Bao 2010). `None` where they
    /// do so already.
    pub(super) fn mended(
        &self,
        draws: &[Vec<f64>],
        weights: &[f64],
        targets: &[f64],
    ) -> Option<Self> {
        let points: Vec<DVector<f64>> =
            draws.iter().map(|z| DVector::from_column_slice(z)).collect();
        let (_, covariance) = moments(&points, weights)?;
        let mut mended = self.clone();
        for _ in 0..ADDED {
            let Some(worst) = mended.worst(&points, weights, targets) else {
                break;
            };
            let place = &points[worst];
            mended.add(patch(&points, weights, place, &covariance)?);
        }
        if mended.components() == self.components() {
            return None;
        }
        for _ in 0..REWEIGHTED {
            let places = draws.iter().map(Vec::as_slice);
            let weighted = places.zip(weights.iter().copied());
            mended = mended.reweighted(weighted);
        }
        Some(mended)
    }

    /// Where the ratio of a density to this is largest, if large ratios add
    /// too much to the variance of the weights: E_q[(p/q)^2] = E_p[p/q].
    fn worst(
        &self,
        points: &[DVector<f64>],
        weights: &[f64],
        targets: &[f64],
    ) -> Option<usize> {
        let ratios: Vec<f64> = points
            .par_iter()
            .zip(targets)
            .map(|(z, target)| target - self.log_density_at(z))
            .collect();
        let large: Vec<usize> = (0..points.len())
            .filter(|&i| weights[i] > 0.0 && ratios[i] > TOO_LARGE.ln())
            .collect();
        let added: f64 =
            large.iter().map(|&i| weights[i] * ratios[i].exp()).sum();
        let worst =
            large.into_iter().max_by(|&i, &j| ratios[i].total_cmp(&ratios[j]));
        worst.filter(|_| added > TOLERATED)
    }

    /// Adds a component; the others make room for its weight.
    fn add(&mut self, component: Component) {
        let left = (-component.log_weight.exp()).ln_1p();
        self.components.iter_mut().for_each(|c| c.log_weight += left);
        self.components.push(component);
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
            .map(|(z, w)| w * self.log_density_at(z))
            .sum();
        -2.0 * effective * fit + unknowns * effective.ln()
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

/// The most rounds of a fit.
const ROUNDS: usize = 60;

/// A gain of the mean log density, by a round, below which a fit ends: a
/// proposal is none the worse for what is left.
const ENOUGH: f64 = 1e-4;

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
    let mut components: Vec<Component> = centres
        .into_iter()
        .map(|m| Component::new(1.0 / count as f64, m, &narrow))
        .collect::<Option<_>>()?;
    let mut fit = f64::NEG_INFINITY;
    for _ in 0..ROUNDS {
        let (next, before) = maximise(points, weights, &components)?;
        components = next;
        if before - fit < ENOUGH {
            break;
        }
        fit = before;
    }
    Some(Mixture { components })
}

/// One round: responsibilities, then weighted moments of each component. The
/// mean log density before it comes with the new components.
fn maximise(
    points: &[DVector<f64>],
    weights: &[f64],
    components: &[Component],
) -> Option<(Vec<Component>, f64)> {
    let n = points.first()?.len();
    let mut totals = vec![0.0; components.len()];
    let mut masses = totals.clone();
    let mut means = vec![DVector::zeros(n); components.len()];
    let mut squares = vec![DMatrix::zeros(n, n); components.len()];
    let mut fit = 0.0;
    for (z, w) in points.iter().zip(weights).filter(|(_, w)| **w > 0.0) {
        let distances: Vec<f64> =
            components.iter().map(|c| c.distance(z)).collect();
        let at = components.iter().zip(&distances);
        let logs: Vec<f64> = at.map(|(c, d)| c.log_density_at(*d)).collect();
        let total = log_sum_exp(logs.iter().copied());
        fit += w * total;
        for k in 0..components.len() {
            let share = w * (logs[k] - total).exp();
            // The t's latent precision, given the point.
            let precision = (FREEDOM + n as f64) / (FREEDOM + distances[k]);
            totals[k] += share;
            masses[k] += share * precision;
            means[k].axpy(share * precision, z, 1.0);
            squares[k].ger(share * precision, z, z, 1.0);
        }
    }
    let maximised = (0..components.len())
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
    Some((maximised, fit))
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

/// A component about a place, as wide as the nearest draws: distances are in
/// units of the covariance of all.
fn patch(
    points: &[DVector<f64>],
    weights: &[f64],
    place: &DVector<f64>,
    covariance: &DMatrix<f64>,
) -> Option<Component> {
    let whole = Component::new(1.0, place.clone(), covariance)?;
    let mut near: Vec<(f64, usize)> = (0..points.len())
        .into_par_iter()
        .map(|i| (whole.distance(&points[i]), i))
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut mass = 0.0;
    let mut spread = DMatrix::zeros(place.len(), place.len());
    for (_, i) in near {
        let d = &points[i] - place;
        spread.ger(weights[i], &d, &d, 1.0);
        mass += weights[i];
        if mass > PATCH {
            break;
        }
    }
    Component::new(PATCH, place.clone(), &(spread * (INFLATION / mass)))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    /// A bent ridge: x ~ N(0, 1), y given x ~ N(2 x^2, 0.3^2).
    fn bent(rng: &mut Rng) -> Vec<f64> {
        let x: f64 = StandardNormal.sample(rng);
        let error: f64 = StandardNormal.sample(rng);
        vec![x, 2.0 * x * x + 0.3 * error]
    }

    fn log_bent(z: &[f64]) -> f64 {
        let error = (z[1] - 2.0 * z[0] * z[0]) / 0.3;
        -0.5 * (z[0] * z[0] + error * error)
            - (2.0 * std::f64::consts::PI * 0.3).ln()
    }

    fn many(rng: &mut Rng) -> Vec<Vec<f64>> {
        (0..2000).map(|_| bent(rng)).collect()
    }

    #[test]
    fn components_are_added_where_it_is_too_low() {
        let mut rng = Seed::new(1).rng();
        let (draws, others) = (many(&mut rng), many(&mut rng));
        let even = vec![1.0 / 2000.0; 2000];
        let targets: Vec<f64> = draws.iter().map(|z| log_bent(z)).collect();
        let before = Mixture::fit(&draws, &even, 2, &mut rng).unwrap();
        let after = before.mended(&draws, &even, &targets).unwrap();
        assert!(after.components() > before.components());
        // The largest ratio at draws that neither has seen.
        let largest = |mixture: &Mixture| {
            let ratios =
                others.iter().map(|z| log_bent(z) - mixture.log_density(z));
            ratios.fold(f64::NEG_INFINITY, f64::max).exp()
        };
        assert!(largest(&after) < 0.2 * largest(&before));
        // Still a density: the mean of p/q over its own draws is 1.
        let n = 20_000;
        let ratio = |_| {
            let z = after.draw(&mut rng);
            (log_bent(&z) - after.log_density(&z)).exp()
        };
        let ratios: Vec<f64> = (0..n).map(ratio).collect();
        let mean = ratios.iter().sum::<f64>() / n as f64;
        let square = ratios.iter().map(|r| r * r).sum::<f64>() / n as f64;
        let se = ((square - mean * mean) / n as f64).sqrt();
        assert!((mean - 1.0).abs() < 4.0 * se, "{mean} +- {se}");
    }

    #[test]
    fn a_mixture_that_fits_is_left_as_it_is() {
        let mut rng = Seed::new(2).rng();
        let draw = |_| vec![StandardNormal.sample(&mut rng)];
        let draws: Vec<Vec<f64>> = (0..2000).map(draw).collect();
        let even = vec![1.0 / 2000.0; 2000];
        let targets: Vec<f64> = draws
            .iter()
            .map(|z| -0.5 * (z[0] * z[0] + std::f64::consts::TAU.ln()))
            .collect();
        let mixture = Mixture::fit(&draws, &even, 2, &mut rng).unwrap();
        assert!(mixture.mended(&draws, &even, &targets).is_none());
    }
}
