//! Gauss and Legendre's rule, and the distribution function of a density
//! known at its nodes.

/// Nodes and weights of Gauss and Legendre's rule on \[-1, 1\], by Newton's
/// method on the polynomial (Press et al. 2007, section 4.6).
pub(in crate::infer) fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let guess = (i as f64 + 0.75) / (n as f64 + 0.5);
            let mut x = -(std::f64::consts::PI * guess).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let p = legendre(n + 1, x);
                slope = n as f64 * (x * p[n] - p[n - 1]) / (x * x - 1.0);
                let step = p[n] / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Legendre's polynomials P_0 .. P_(count - 1) at x.
fn legendre(count: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for k in 1..count.max(2) - 1 {
        let k = k as f64;
        let (last, before) = (p[p.len() - 1], p[p.len() - 2]);
        p.push(((2.0 * k + 1.0) * x * last - k * before) / (k + 1.0));
    }
    p
}

/// The distribution function of a density known at Gauss's nodes: the
/// integral of its expansion in Legendre's polynomials.
#[derive(Debug)]
pub(in crate::infer) struct Cumulative {
    coefficients: Vec<f64>,
}

impl Cumulative {
    pub(in crate::infer) fn of(rule: &[(f64, f64)], density: &[f64]) -> Self {
        let n = rule.len();
        let mut coefficients = vec![0.0; n];
        let mut total = 0.0;
        for ((x, weight), density) in rule.iter().zip(density) {
            total += weight * density;
            for (k, p) in legendre(n, *x).into_iter().take(n).enumerate() {
                let half = 0.5 * (2 * k + 1) as f64;
                coefficients[k] += half * weight * density * p;
            }
        }
        coefficients.iter_mut().for_each(|c| *c /= total);
        Self { coefficients }
    }

    /// int_-1^x P_k = (P_(k+1) - P_(k-1))/(2 k + 1).
    fn at(&self, x: f64) -> f64 {
        let p = legendre(self.coefficients.len() + 1, x);
        let mut sum = self.coefficients[0] * (x + 1.0);
        for (k, c) in self.coefficients.iter().enumerate().skip(1) {
            sum += c * (p[k + 1] - p[k - 1]) / (2 * k + 1) as f64;
        }
        sum
    }

    pub(in crate::infer) fn quantile(&self, level: f64) -> f64 {
        let (mut low, mut high) = (-1.0, 1.0);
        while high - low > 1e-9 {
            let middle = 0.5 * (low + high);
            if self.at(middle) < level { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_for_polynomials() {
        let rule = gauss_legendre(7);
        for power in 0..14 {
            let found: f64 = rule.iter().map(|(x, w)| w * x.powi(power)).sum();
            let exact =
                if power % 2 == 0 { 2.0 / f64::from(power + 1) } else { 0.0 };
            // Round-off of seven terms of size 1.
            assert!((found - exact).abs() < 1e-14, "{power}");
        }
    }

    #[test]
    fn quantiles_of_a_known_density() {
        // 3 (1 - x^2)/4: F(x) = (2 + 3 x - x^3)/4, and F(0.5) = 0.84375.
        let rule = gauss_legendre(9);
        let density: Vec<f64> =
            rule.iter().map(|(x, _)| 1.0 - x * x).collect();
        let cumulative = Cumulative::of(&rule, &density);
        assert!((cumulative.quantile(0.84375) - 0.5).abs() < 1e-8);
    }
}
