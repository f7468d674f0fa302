//! The Poisson distribution of counts.

use rand_distr::Distribution as _;

use super::special::ln_gamma;
use super::{Distribution, impossible, positive, whole};
use crate::scalar::{Kind, Plain, Real};
use crate::seed::Rng;

/// Poisson(mean), for n = 0, 1, 2, ...: P(n) = mean^n exp(-mean) / n!.
///
/// ```
/// use couloir::prior::{Distribution, Poisson};
/// use couloir::scalar::{Plain, Real};
/// let counts = Poisson::<Plain>::new(2.0);
/// let three = counts.log_density(Real::new(3.0)).value();
/// assert!((three - (8.0_f64 / 6.0).ln() + 2.0).abs() < 1e-14);
/// assert_eq!(counts.log_density(Real::new(0.5)).value(), f64::NEG_INFINITY);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Poisson<K: Kind> {
    mean: Real<K>,
}

impl<K: Kind> Poisson<K> {
    /// From its mean.
    #[inline]
    pub fn new(mean: impl Into<Real<K>>) -> Self {
        Self { mean: mean.into() }
    }
}

impl<K: Kind> Distribution<K> for Poisson<K> {
    #[inline]
    fn log_density(&self, x: Real<K>) -> Real<K> {
        let n = x.value();
        if !(whole(n) && positive(self.mean.value())) {
            return impossible();
        }
        n * self.mean.ln() - self.mean - ln_factorial(n)
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let mean = self.mean.value();
        positive(mean).then_some(())?;
        Some(rand_distr::Poisson::new(mean).ok()?.sample(rng))
    }
}

/// ln n!.
pub(super) fn ln_factorial(n: f64) -> f64 {
    ln_gamma(Real::<Plain>::new(n + 1.0)).value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prior::{Bernoulli, Binomial, Mixture};
    use crate::scalar::Grad;
    use crate::seed::Seed;

    /// Probabilities sum to 1, and draws have the mean and the spread that
    /// these give.
    fn check(of: &impl Distribution<Plain>, most: u32) {
        let p = |n: u32| of.log_density(Real::new(f64::from(n))).value().exp();
        let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
            (0..=most).map(|n| p(n) * of(f64::from(n))).sum()
        };
        assert!((sum(&|_| 1.0) - 1.0).abs() < 1e-12);
        let mean = sum(&|n| n);
        let variance = sum(&|n| (n - mean).powi(2));
        let (mut rng, count) = (Seed::new(7).rng(), 20_000);
        let draws = (0..count).map(|_| of.draw(&mut rng).unwrap());
        let found = draws.sum::<f64>() / f64::from(count);
        // Five standard errors, and round-off.
        let se = (variance / f64::from(count)).sqrt();
        let off = (found - mean).abs();
        assert!(off < 5.0 * se + 1e-12, "{found} {mean}");
        for x in [-1.0, 0.5, f64::NAN, f64::INFINITY] {
            let log = of.log_density(Real::new(x)).value();
            assert_eq!(log, f64::NEG_INFINITY, "{x}");
        }
    }

    #[test]
    fn counts_are_what_their_probabilities_say() {
        check(&Poisson::new(0.2), 30);
        check(&Poisson::new(40.0), 200);
        check(&Binomial::new(7.0, 0.3), 7);
        check(&Binomial::new(5.0, 1.0), 5);
        check(&Bernoulli::new(0.9), 1);
        let parts = (Poisson::new(3.0), Binomial::new(9.0, 0.9));
        check(&Mixture::<Plain, _>::new([0.25, 0.75], parts), 60);
    }

    #[test]
    fn impossible_arguments_have_no_probability() {
        let none = |of: &dyn Distribution<Plain>| {
            assert_eq!(of.log_density(Real::new(0.0)).value(), -f64::INFINITY);
            assert!(of.draw(&mut Seed::new(1).rng()).is_none());
        };
        none(&Poisson::new(-1.0));
        none(&Poisson::new(f64::NAN));
        none(&Binomial::new(2.5, 0.5));
        none(&Binomial::new(2.0, 1.5));
        none(&Bernoulli::new(-0.1));
        let same = [Poisson::new(1.0), Poisson::new(2.0)];
        none(&Mixture::<Plain, _>::new([0.5, 0.6], same));
        none(&Mixture::<Plain, _>::new([1.0], same));
    }

    #[test]
    fn the_score_is_that_of_the_formula() {
        // d/dm ln P(3; m) = 3/m - 1; d/dp ln P(1 of 4) = 1/p - 3/(1 - p).
        let m = Real::<Grad<1>>::variable(2.0, 0);
        let poisson = Poisson::new(m).log_density(Real::new(3.0));
        assert!((poisson.partial(0) - 0.5).abs() < 1e-15);
        let p = Real::<Grad<1>>::variable(0.2, 0);
        let binomial = Binomial::new(4.0, p).log_density(Real::new(1.0));
        assert!((binomial.partial(0) - 1.25).abs() < 1e-14);
    }
}
