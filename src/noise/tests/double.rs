//! Dense linear algebra with twice the digits, for processes near the edge
//! of stationarity, whose covariance a double cannot factor.

use std::ops::{Add, Div, Mul, Sub};

/// An unevaluated sum of two doubles (Dekker 1971), about 31 digits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Double(f64, f64);

fn normal(high: f64, low: f64) -> Double {
    let sum = high + low;
    Double(sum, low - (sum - high))
}

impl From<f64> for Double {
    fn from(x: f64) -> Self {
        Self(x, 0.0)
    }
}

impl Double {
    pub(super) fn rounded(self) -> f64 {
        self.0 + self.1
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, y: Self) -> Self {
        let sum = self.0 + y.0;
        let part = sum - self.0;
        let lost = (self.0 - (sum - part)) + (y.0 - part);
        normal(sum, lost + self.1 + y.1)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, y: Self) -> Self {
        self + Self(-y.0, -y.1)
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, y: Self) -> Self {
        let product = self.0 * y.0;
        let lost = self.0.mul_add(y.0, -product);
        normal(product, lost + self.0 * y.1 + self.1 * y.0)
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, y: Self) -> Self {
        let first = Self::from(self.0 / y.0);
        let rest = self - first * y;
        let second = Self::from(rest.0 / y.0);
        let rest = rest - second * y;
        first + second + Self::from(rest.0 / y.0)
    }
}

/// Solves A x = b by elimination with pivots, b as the last column.
pub(super) fn solve(mut rows: Vec<Vec<Double>>) -> Vec<Double> {
    let n = rows.len();
    for i in 0..n {
        let size = |r: &Vec<Double>| r[i].0.abs();
        let pivot = (i..n)
            .max_by(|&a, &b| size(&rows[a]).total_cmp(&size(&rows[b])))
            .unwrap();
        rows.swap(i, pivot);
        let top = rows[i].clone();
        let others = rows.iter_mut().enumerate().filter(|(j, _)| *j != i);
        for (_, row) in others {
            let factor = row[i] / top[i];
            for (x, &t) in row.iter_mut().zip(&top) {
                *x = *x - factor * t;
            }
        }
    }
    (0..n).map(|i| rows[i][n] / rows[i][i]).collect()
}

/// The coefficients of an AR from its partial autocorrelations, as the
/// polynomials A_j(z) = A_(j-1)(z) - p z^j A_(j-1)(1/z).
pub(super) fn coefficients(partials: &[f64]) -> Vec<Double> {
    let zero = Double::from(0.0);
    let mut a = vec![Double::from(1.0)];
    for &p in partials {
        let mut longer = a.clone();
        longer.push(zero);
        let mirrored: Vec<Double> = longer.iter().rev().copied().collect();
        let term = |(x, y): (Double, Double)| x - Double::from(p) * y;
        a = longer.into_iter().zip(mirrored).map(term).collect();
    }
    a[1..].iter().map(|&x| zero - x).collect()
}

/// Autocovariances from the Yule-Walker equations
/// gamma_h - sum_i c_i gamma_|h-i| = sigma2 (h = 0), h = 0 .. k.
pub(super) fn yule_walker(
    c: &[Double],
    sigma2: f64,
    lags: usize,
) -> Vec<Double> {
    let (zero, one) = (Double::from(0.0), Double::from(1.0));
    let k = c.len();
    let rows = (0..=k).map(|h| {
        let mut row = vec![zero; k + 2];
        row[h] = one;
        for (i, &c) in c.iter().enumerate() {
            let lag = h.abs_diff(i + 1);
            row[lag] = row[lag] - c;
        }
        row[k + 1] = Double::from(if h == 0 { sigma2 } else { 0.0 });
        row
    });
    let mut gamma = solve(rows.collect());
    while gamma.len() < lags {
        let terms = c.iter().zip(gamma.iter().rev()).map(|(&c, &g)| c * g);
        gamma.push(terms.fold(zero, Add::add));
    }
    gamma
}

/// The multivariate normal log density, by elimination of A = L D L'.
pub(super) fn log_density(mut a: Vec<Vec<Double>>, r: &[f64]) -> f64 {
    let n = r.len();
    let mut z: Vec<Double> = r.iter().map(|&r| r.into()).collect();
    let mut total = -0.5 * n as f64 * std::f64::consts::TAU.ln();
    for i in 0..n {
        let pivot = a[i][i];
        let top = a[i].clone();
        total -= 0.5 * (pivot.rounded().ln() + (z[i] * z[i] / pivot).0);
        for j in i + 1..n {
            let factor = a[j][i] / pivot;
            z[j] = z[j] - factor * z[i];
            for (x, &t) in a[j].iter_mut().zip(&top) {
                *x = *x - factor * t;
            }
        }
    }
    total
}
