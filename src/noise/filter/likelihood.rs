//! The log likelihood of values, each given those before it.
//!
//! With e the error of a prediction, S its variance and d^2 = e^2/S, a value
//! has the weight w: 1 where errors are normal, (nu + 1)/(nu + d^2) where they
//! have tails (Lange, Little and Taylor 1989). Its log density changes with e
//! by -w e/S, and with S by (w d^2 - 1)/(2 S): what is carried along many
//! directions is one sum for both, and S only where it changes.

use super::innovation::Innovation;
use crate::noise::student::log_peak;
use crate::prior::LN_SQRT_2PI;
use crate::scalar::{Kind, Real};

/// The log likelihood of the values so far.
pub(super) struct LogLikelihood<K: Kind> {
    /// The degrees of freedom, where there are tails, and one over them.
    nu: Option<Real<K>>,
    over: f64,
    count: usize,
    /// What errors, their variances and sizes say, by its derivatives alone.
    slopes: Real<K>,
    /// The logarithms of the sizes.
    log_sizes: f64,
    /// The logarithms of the variances.
    log_variances: LogSum,
    /// The squares d^2, where errors are normal.
    squares: f64,
    /// ln(1 + d^2/nu), where they have tails, and d^2/(nu + d^2).
    log_tails: LogSum,
    outer: f64,
    /// The variance of the last value, one over it, and the slope by it of all
    /// values that have it.
    variance: Real<K>,
    precision: f64,
    slope: f64,
}

impl<K: Kind> LogLikelihood<K> {
    /// Of no value yet.
    pub(super) fn new(nu: Option<Real<K>>) -> Self {
        Self {
            nu,
            over: nu.map_or(0.0, |nu| 1.0 / nu.value()),
            count: 0,
            slopes: Real::new(0.0),
            log_sizes: 0.0,
            log_variances: LogSum::new(),
            squares: 0.0,
            log_tails: LogSum::new(),
            outer: 0.0,
            variance: Real::new(1.0),
            precision: 1.0,
            slope: 0.0,
        }
    }

    /// Adds a value.
    #[inline(always)]
    pub(super) fn add(&mut self, next: &Innovation<'_, K>) {
        if !next.is_same {
            self.settle();
            self.variance = *next.variance;
            self.precision = 1.0 / self.variance.value();
        }
        let scaled = next.error.value() * self.precision;
        let square = next.error.value() * scaled;
        let weight = self.weigh(square);
        self.count += 1;
        self.log_variances.add(self.variance.value());
        if K::DIFFERENTIATES {
            self.slope += 0.5 * self.precision * (weight * square - 1.0);
            self.slopes.accumulate(0.0, [(&next.error, -weight * scaled)]);
        }
        if let Some(log_size) = &next.log_size {
            self.log_sizes += log_size.value();
            self.slopes.accumulate(0.0, [(log_size, -1.0)]);
        }
    }

    /// Adds how far out a value lies, and says with which weight.
    #[inline(always)]
    fn weigh(&mut self, square: f64) -> f64 {
        let Some(nu) = &self.nu else {
            self.squares += square;
            return 1.0;
        };
        self.log_tails.add(1.0 + square * self.over);
        if !K::DIFFERENTIATES {
            return 1.0;
        }
        let nu = nu.value();
        let over = 1.0 / (nu + square);
        self.outer += square * over;
        (nu + 1.0) * over
    }

    /// Adds what the values of one variance say of it.
    #[inline(always)]
    fn settle(&mut self) {
        if K::DIFFERENTIATES {
            self.slopes.accumulate(0.0, [(&self.variance, self.slope)]);
            self.slope = 0.0;
        }
    }

    pub(super) fn total(mut self) -> Real<K> {
        self.settle();
        let n = self.count as f64;
        let base = -0.5 * self.log_variances.total() - self.log_sizes;
        let Some(nu) = self.nu else {
            let value = base - 0.5 * self.squares - LN_SQRT_2PI * n;
            return self.slopes.chain(value, 1.0);
        };
        let (dof, logs) = (nu.value(), self.log_tails.total());
        let value = base - 0.5 * (dof + 1.0) * logs;
        let slope = 0.5 * ((dof + 1.0) / dof * self.outer - logs);
        let terms = [(&self.slopes, 1.0), (&nu, slope)];
        Real::combine(value, terms) + log_peak(nu) * n
    }
}

/// The sum of logarithms, by that of the product as far as a number holds it.
struct LogSum {
    sum: f64,
    product: f64,
}

impl LogSum {
    const fn new() -> Self {
        Self { sum: 0.0, product: 1.0 }
    }

    #[inline(always)]
    fn add(&mut self, x: f64) {
        // Of either as far from 1 as this the product is a number.
        const FAR: f64 = 1e140;
        let far = |x: f64| !(1.0 / FAR..=FAR).contains(&x);
        if far(x) || far(self.product) {
            self.sum += self.product.ln();
            self.product = 1.0;
        }
        self.product *= x;
    }

    fn total(&self) -> f64 {
        self.sum + self.product.ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_logarithm_of_a_product_beyond_all_numbers_is_a_sum() {
        let (mut sum, mut known) = (LogSum::new(), 0.0);
        for i in 0..4000 {
            let x = [3.0, 1e200, 0.7, 1e-250, 2e3, 5.0][i % 6];
            sum.add(x);
            known += x.ln();
        }
        // Round-off of some thousand additions to numbers of some 1e5.
        assert!((sum.total() - known).abs() < 1e-8, "{known}");
    }
}
