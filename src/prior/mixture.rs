//! A mixture of distributions.

use rand_distr::{Distribution as _, Open01};

use super::parts::{Parts, PriorParts};
use super::{Distribution, Prior, Support, impossible};
use crate::block::List;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Mixture(\[w, ..\], \[D, ..\]): p(x) = sum(w_i p_i(x)), where the weights
/// are not below 0 and sum to 1.
///
/// Distributions of one type are an array or a vector of them, others a tuple;
/// `model!` takes them between brackets.
///
/// ```
/// use couloir::prior::{Distribution, Mixture, Normal, Uniform};
/// use couloir::scalar::{Plain, Real};
/// let parts = (Normal::<Plain>::new(0.0, 1.0), Uniform::new(5.0, 9.0));
/// let mixed = Mixture::<Plain, _>::new([0.9, 0.1], parts);
/// let x = Real::new(7.0);
/// assert!((mixed.log_density(x).value() - 0.025_f64.ln()).abs() < 1e-8);
/// ```
#[derive(Debug, Clone)]
pub struct Mixture<K: Kind, C> {
    weights: List<Real<K>>,
    parts: C,
}

impl<K: Kind, C: Parts<K>> Mixture<K, C> {
    /// Weights and as many distributions.
    #[inline]
    pub fn new<W: Into<Real<K>>>(
        weights: impl IntoIterator<Item = W>,
        parts: C,
    ) -> Self {
        let weights = weights.into_iter().map(Into::into).collect();
        Self { weights, parts }
    }

    /// Whether the weights are some.
    fn exists(&self) -> bool {
        let total: f64 = self.weights.iter().map(|w| w.value()).sum();
        self.weights.len() == self.parts.count()
            && self.weights.iter().all(|w| *w >= 0.0)
            && (total - 1.0).abs() < ROUND_OFF
    }
}

/// How far from 1 weights may sum, as those that were written in decimals do.
const ROUND_OFF: f64 = 1e-9;

impl<K: Kind, C: Parts<K>> Distribution<K> for Mixture<K, C> {
    /// By the largest term, so that no exponential underflows alone.
    fn log_density(&self, x: Real<K>) -> Real<K> {
        if !self.exists() {
            return impossible();
        }
        let mut terms = List::<Real<K>>::new();
        let mut largest = f64::NEG_INFINITY;
        for (i, weight) in self.weights.iter().enumerate() {
            if *weight > 0.0 {
                let term = weight.ln() + self.parts.log_density(i, x);
                largest = largest.max(term.value());
                terms.push(term);
            }
        }
        if largest == f64::NEG_INFINITY {
            return impossible();
        }
        let possible = terms.iter().filter(|t| **t > f64::NEG_INFINITY);
        let sum: Real<K> = possible.map(|t| (*t - largest).exp()).sum();
        sum.ln() + largest
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        self.exists().then_some(())?;
        let mut left: f64 = Open01.sample(rng);
        let mut chosen = 0;
        for (i, weight) in self.weights.iter().enumerate() {
            if *weight > 0.0 && left > 0.0 {
                chosen = i;
            }
            left -= weight.value();
        }
        self.parts.draw(chosen, rng)
    }
}

impl<K: Kind, C: PriorParts<K>> Prior<K> for Mixture<K, C> {
    /// From the lowest end of a part's to the highest.
    fn support(&self) -> Support<K> {
        let mut all = (0..self.parts.count()).map(|i| self.parts.support(i));
        let first = all.next().unwrap_or(Support::Line);
        all.fold(first, |all, one| all.joined(&one))
    }

    fn is_proper(&self) -> bool {
        (0..self.parts.count()).all(|i| self.parts.is_proper(i))
    }

    /// Nobody knows it, but for the ends.
    fn quantile(&self, p: f64) -> Option<f64> {
        let (low, high) = self.support().ends();
        match p {
            0.0 => Some(low),
            1.0 => Some(high),
            _ => None,
        }
    }
}
