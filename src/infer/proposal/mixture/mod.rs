//! A mixture of multivariate Student-t distributions, fitted to draws.
//!
//! The proposal of importance sampling and the second start of sequential
//! Monte Carlo: heavier in the tails than what it is fitted to, and with a
//! share of the prior's own draws so that no place is out of reach.

mod fit;
mod lanes;
mod mend;
mod student;

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use lanes::Lanes;
pub(crate) use student::student_constant;
use student::{Component, FREEDOM};

use crate::infer::log_sum_exp;
use crate::seed::Rng;

/// How much wider than the draws each component is made, in variance.
const INFLATION: f64 = 1.3;

/// A mixture of Student-t components on the real line.
#[derive(Debug, Clone)]
pub struct Mixture {
    components: Vec<Component>,
    /// The same side by side: densities are most of what importance sampling
    /// costs beside those of the model.
    lanes: Lanes,
}

/// How components share a place.
#[derive(Debug, Default)]
struct Shares {
    /// The squared distance of each.
    distances: Vec<f64>,
    /// The share of each in the density.
    of: Vec<f64>,
}

impl Shares {
    /// Those at a place, with the log density there.
    fn at(&mut self, mixture: &Mixture, z: &[f64]) -> f64 {
        let Self { distances, of } = self;
        distances.clear();
        of.clear();
        for (eight, densities) in mixture.lanes.at(z) {
            distances.extend(eight);
            of.extend(densities);
        }
        let components = &mixture.components;
        distances.truncate(components.len());
        of.truncate(components.len());
        let total: f64 = of.iter().sum();
        if total > 0.0 && total.is_finite() {
            of.iter_mut().for_each(|share| *share /= total);
            return total.ln();
        }
        let each = components.iter().zip(distances.iter());
        of.clear();
        of.extend(each.map(|(c, d)| c.log_density_at(*d)));
        let log = log_sum_exp(of.iter().copied());
        of.iter_mut().for_each(|share| *share = (*share - log).exp());
        log
    }
}

impl Mixture {
    /// The mixture of given parts: weight, mean and covariance of each.
    /// `None` where there are none.
    pub(crate) fn of(
        parts: impl Iterator<Item = (f64, DVector<f64>, DMatrix<f64>)>,
    ) -> Option<Self> {
        let mut components: Vec<Component> = parts
            .filter_map(|(weight, mean, covariance)| {
                Component::new(weight, mean, &covariance)
            })
            .collect();
        let total: f64 = components.iter().map(|c| c.weight).sum();
        components.iter_mut().for_each(|c| c.weight /= total);
        if components.is_empty() { None } else { inflated(&components) }
    }

    /// The same components, each weighing what weighted draws say it holds:
    /// one round of expectation and maximisation for the weights alone
    /// (Douc, Guillin, Marin, Robert 2007).
    #[must_use]
    pub(in crate::infer) fn reweighted<'z>(
        &self,
        draws: impl Iterator<Item = (&'z [f64], f64)>,
    ) -> Self {
        let mut totals = vec![0.0; self.components.len()];
        let mut shares = Shares::default();
        for (z, weight) in draws {
            shares.at(self, z);
            for (sum, share) in totals.iter_mut().zip(&shares.of) {
                *sum += weight * share;
            }
        }
        // Half of the old weight stays: a round may have missed a part.
        let mut components = self.components.clone();
        for (component, total) in components.iter_mut().zip(totals) {
            component.weight = 0.5 * (component.weight + total);
        }
        Self::from(components)
    }

    /// The components of both, either half of the weight.
    #[must_use]
    pub(in crate::infer) fn beside(mut self, other: Self) -> Self {
        self.components.extend(other.components);
        self.components.iter_mut().for_each(|c| c.weight *= 0.5);
        Self::from(self.components)
    }

    /// The middles of the components, those with the most weight first.
    pub(crate) fn middles(&self) -> Vec<&[f64]> {
        let mut all: Vec<&Component> = self.components.iter().collect();
        all.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        all.into_iter().map(|component| component.mean.as_slice()).collect()
    }

    /// How many components it has.
    pub fn components(&self) -> usize {
        self.components.len()
    }

    /// The log density at a place on the real line.
    pub fn log_density(&self, z: &[f64]) -> f64 {
        let each = self.lanes.at(z).flat_map(|(_, densities)| densities);
        let total: f64 = each.sum();
        if total > 0.0 && total.is_finite() {
            return total.ln();
        }
        let at = |c: &Component| c.log_density_at(c.distance(z));
        log_sum_exp(self.components.iter().map(at))
    }

    /// One draw, a place on the real line.
    pub fn draw(&self, rng: &mut Rng) -> Vec<f64> {
        let mut u: f64 = rng.random();
        let mut chosen = &self.components[0];
        for component in &self.components {
            chosen = component;
            u -= component.weight;
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

impl From<Vec<Component>> for Mixture {
    fn from(components: Vec<Component>) -> Self {
        Self { lanes: Lanes::of(&components), components }
    }
}

/// Components somewhat wider than they are.
fn inflated(components: &[Component]) -> Option<Mixture> {
    let wide = |c: &Component| {
        let covariance = c.shape.l() * c.shape.l().transpose() * INFLATION;
        Component::new(c.weight, c.mean.clone(), &covariance)
    };
    let components: Vec<_> =
        components.iter().map(wide).collect::<Option<_>>()?;
    Some(Mixture::from(components))
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

#[cfg(test)]
mod tests {
    use statrs::distribution::{Continuous, StudentsT};

    use super::*;
    use crate::seed::Seed;

    #[test]
    fn one_component_is_a_t_distribution_however_far() {
        let (mean, variance) = (2.0, 0.25);
        let part = (
            1.0,
            DVector::from_element(1, mean),
            DMatrix::from_element(1, 1, variance),
        );
        let mixture = Mixture::of([part].into_iter()).unwrap();
        let scale = (variance * INFLATION).sqrt();
        let known = StudentsT::new(mean, scale, FREEDOM).unwrap();
        // Where a density is below what a number can hold its log is not.
        for z in [2.0, 2.3, -1.0, 50.0, 1e8, 1e60] {
            let off = mixture.log_density(&[z]) - known.ln_pdf(z);
            assert!(off.abs() < 1e-8, "{z}: {off}");
        }
    }

    #[test]
    fn side_by_side_densities_are_those_of_each() {
        // A block and one more, of an even and of an odd power.
        for dimension in [2, 3] {
            let part = |k: usize| {
                let of = |i: usize| (1.7 * (k + 3 * i) as f64).sin();
                let mean = DVector::from_fn(dimension, |i, _| 2.0 * of(i));
                let factor = DMatrix::from_fn(dimension, dimension, |i, j| {
                    of(i + j) + if i == j { 2.0 } else { 0.0 }
                });
                (1.0 + k as f64, mean, &factor * factor.transpose())
            };
            let mixture = Mixture::of((0..9).map(part)).unwrap();
            assert_eq!(mixture.components(), 9);
            let each = |z: &[f64]| -> Vec<f64> {
                let all = mixture.components.iter();
                all.map(|c| c.log_density_at(c.distance(z))).collect()
            };
            let mut shares = Shares::default();
            for far in [0.3, 5.0, 1e3, 1e150] {
                let z = vec![far; dimension];
                let each = each(&z);
                let known = log_sum_exp(each.iter().copied());
                let off = mixture.log_density(&z) - known;
                // Round-off of some hundred in ln.
                assert!(off.abs() < 1e-11, "{dimension}, {far}: {off}");
                assert!((shares.at(&mixture, &z) - known).abs() < 1e-11);
                assert_eq!(shares.of.len(), 9);
                for (share, log) in shares.of.iter().zip(each) {
                    assert!((share - (log - known).exp()).abs() < 1e-11);
                }
            }
        }
    }

    /// Two components, of a quarter and three quarters of the weight.
    fn two() -> Mixture {
        let part = |weight, mean, variance| {
            let mean = DVector::from_element(1, mean);
            (weight, mean, DMatrix::from_element(1, 1, variance))
        };
        let parts = [part(1.0, -4.0, 0.5), part(3.0, 3.0, 2.0)];
        Mixture::of(parts.into_iter()).unwrap()
    }

    /// The density's integral above 0, to the right of the first component,
    /// by the midpoint rule in z = tan(x), which takes in the tails.
    fn above_zero(mixture: &Mixture) -> f64 {
        const STEPS: usize = 20_000;
        let step = std::f64::consts::FRAC_PI_2 / STEPS as f64;
        let at = |i: usize| {
            let z = ((i as f64 + 0.5) * step).tan();
            mixture.log_density(&[z]).exp() * (1.0 + z * z) * step
        };
        (0..STEPS).map(at).sum()
    }

    #[test]
    fn the_density_is_that_of_the_draws_in_every_component() {
        const DRAWS: usize = 40_000;
        let mixture = two();
        let mut rng = Seed::new(3).rng();
        let above = (0..DRAWS).filter(|_| mixture.draw(&mut rng)[0] > 0.0);
        let share = above.count() as f64 / DRAWS as f64;
        let se = (share * (1.0 - share) / DRAWS as f64).sqrt();
        let z = |mixture: &Mixture| (above_zero(mixture) - share) / se;
        assert!(z(&mixture).abs() < 4.0, "{}", z(&mixture));
        // A factor of one component's density is seen.
        let mut planted = two().components;
        planted[1].log_constant += 1.1_f64.ln();
        let planted = Mixture::from(planted);
        assert!(z(&planted) > 4.0, "{}", z(&planted));
    }
}
