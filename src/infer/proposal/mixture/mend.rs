//! Adding components to a mixture where it is far too low.

use nalgebra::{DMatrix, DVector};

use super::{Component, INFLATION, Mixture, moments};
use crate::infer::log_sum_exp;
use crate::parallel;

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

impl Mixture {
    /// With components where it is far too low for a density whose logs are
    /// known at weighted draws from it: one at the largest ratio of the two,
    /// as wide as the draws around it, and so on until large ratios add little
    /// to the variance of the weights (Raftery, Bao 2010). `None` where they
    /// do so already.
    pub(in crate::infer) fn mended(
        &self,
        draws: &[Vec<f64>],
        weights: &[f64],
        targets: &[f64],
    ) -> Option<Self> {
        let points: Vec<DVector<f64>> =
            draws.iter().map(|z| DVector::from_column_slice(z)).collect();
        let (_, covariance) = moments(&points, weights)?;
        let mut logs: Vec<f64> = parallel::map(draws, |z| self.log_density(z));
        let mut mended = self.clone();
        for _ in 0..ADDED {
            let ratios: Vec<f64> =
                targets.iter().zip(&logs).map(|(p, q)| p - q).collect();
            let Some(worst) = worst(weights, &ratios) else { break };
            let added = patch(&points, weights, &points[worst], &covariance)?;
            for (log, z) in logs.iter_mut().zip(draws) {
                *log = added.beside(*log, z);
            }
            mended = mended.with(added);
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

    /// With a component more; the others make room for its weight.
    fn with(mut self, component: Component) -> Self {
        let left = 1.0 - component.weight;
        self.components.iter_mut().for_each(|c| c.weight *= left);
        self.components.push(component);
        Self::from(self.components)
    }
}

/// Where the ratio of a density to a mixture is largest, if large ratios add
/// too much to the variance of the weights: E_q[(p/q)^2] = E_p[p/q].
fn worst(weights: &[f64], ratios: &[f64]) -> Option<usize> {
    let large = (0..ratios.len())
        .filter(|&i| weights[i] > 0.0 && ratios[i] > TOO_LARGE.ln());
    let added: f64 = large.clone().map(|i| weights[i] * ratios[i].exp()).sum();
    let worst = large.max_by(|&i, &j| ratios[i].total_cmp(&ratios[j]));
    worst.filter(|_| added > TOLERATED)
}

impl Component {
    /// The log density of a mixture at a place, once this is in it.
    fn beside(&self, log: f64, z: &[f64]) -> f64 {
        let own = self.log_density_at(self.distance(z));
        log_sum_exp([log + (-self.weight).ln_1p(), own].into_iter())
    }
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
    let mut near: Vec<(f64, usize)> = parallel::map(0..points.len(), |i| {
        (whole.distance(points[i].as_slice()), i)
    });
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

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::seed::{Rng, Seed};

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
