//! Autocovariances of chains: at short lags as sums of products, at all of
//! them by a Fourier transform of our own.

use std::f64::consts::TAU;

use crate::scalar::fused;

/// A complex number, real part first.
type Complex = [f64; 2];

/// Lags up to here are summed term by term, as they are asked for; a transform
/// of as many lags as a chain has draws costs about as much as this many.
const DIRECT: usize = 256;

/// Products that are summed side by side: float sums do not commute, so it is
/// said here what may be added in which order.
const SIDES: usize = 32;

/// The sum over chains of their autocovariances, each about the chain's own
/// mean and with the chain's length as divisor; worked out lag by lag.
pub(super) struct Autocovariances {
    /// The chains less their means, of one length.
    chains: Vec<Vec<f64>>,
    /// The lags known so far, from 0 on.
    known: Vec<f64>,
}

impl Autocovariances {
    pub(super) fn new(chains: &[impl AsRef<[f64]>]) -> Self {
        let centred = |chain: &[f64]| {
            let mean = mean(chain);
            chain.iter().map(|x| x - mean).collect()
        };
        let chains = chains.iter().map(|c| centred(c.as_ref())).collect();
        Self { chains, known: Vec::new() }
    }

    /// The chains' length, and how many lags there are.
    pub(super) fn lags(&self) -> usize {
        self.chains.first().map_or(0, Vec::len)
    }

    /// The sum at a lag; NaN beyond the chains' length.
    pub(super) fn at(&mut self, lag: usize) -> f64 {
        while lag >= self.known.len() && lag < self.lags() {
            if self.known.len() >= DIRECT {
                self.known = autocovariance_sum(&self.chains);
                break;
            }
            let shift = self.known.len();
            let products = |c: &Vec<f64>| dot(c, &c[shift..]);
            let sum: f64 = self.chains.iter().map(products).sum();
            self.known.push(sum / self.lags() as f64);
        }
        self.known.get(lag).copied().unwrap_or(f64::NAN)
    }
}

/// The sum of products, as far as the shorter one goes.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let (x, y) = (&x[..y.len().min(x.len())], &y[..y.len().min(x.len())]);
    let (x_parts, y_parts) = (x.chunks_exact(SIDES), y.chunks_exact(SIDES));
    let rest = x_parts.remainder().iter().zip(y_parts.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    let mut sums = [0.0; SIDES];
    for (a, b) in x_parts.zip(y_parts) {
        for (i, sum) in sums.iter_mut().enumerate() {
            *sum = fused(a[i], b[i], *sum);
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// The sum over chains of their autocovariances at every lag, each about the
/// chain's own mean and with the chain's length as divisor.
///
/// By the theorem of Wiener and Khinchin: power spectra add up, so one
/// inverse transform serves all chains. Two chains share a transform as real
/// and imaginary part; the real part of what comes back is their sum. Zeros
/// pad to twice the length so that no lag wraps round.
///
/// Chains are of one length; the answer has that length.
pub(super) fn autocovariance_sum(chains: &[impl AsRef<[f64]>]) -> Vec<f64> {
    let n = chains.first().map_or(0, |chain| chain.as_ref().len());
    if n == 0 {
        return vec![];
    }
    let size = (2 * n).next_power_of_two();
    let roots = roots_of_unity(size);
    let mut power = vec![[0.0; 2]; size];
    let mut buffer = vec![[0.0; 2]; size];
    for pair in chains.chunks(2) {
        buffer.fill([0.0; 2]);
        for (part, chain) in pair.iter().enumerate() {
            let chain = chain.as_ref();
            let mean = mean(chain);
            for (z, x) in buffer.iter_mut().zip(chain) {
                z[part] = x - mean;
            }
        }
        forward(&mut buffer, &roots);
        for (sum, z) in power.iter_mut().zip(&buffer) {
            sum[0] += z[0] * z[0] + z[1] * z[1];
        }
    }
    inverse(&mut power, &roots);
    let scale = 1.0 / (size as f64 * n as f64);
    power.iter().take(n).map(|z| z[0] * scale).collect()
}

/// The mean, taken about the first value so that equal values have exactly
/// themselves as mean.
pub(super) fn mean(x: &[f64]) -> f64 {
    let Some(&first) = x.first() else { return f64::NAN };
    let sum: f64 = x.iter().map(|v| v - first).sum();
    first + sum / x.len() as f64
}

/// The variance with divisor n - 1; NaN below two values.
pub(super) fn variance(x: &[f64]) -> f64 {
    if x.len() < 2 {
        return f64::NAN;
    }
    let mean = mean(x);
    let sum: f64 = x.iter().map(|v| (v - mean) * (v - mean)).sum();
    sum / (x.len() - 1) as f64
}

/// exp(-2 pi i k / length) for k below length / 2, for each power of two
/// `length` from `size` down to 2: a table per stage, read from end to end.
fn roots_of_unity(size: usize) -> Vec<Vec<Complex>> {
    let root = |k: usize| {
        let (sin, cos) = (-TAU * k as f64 / size as f64).sin_cos();
        [cos, sin]
    };
    let finest: Vec<Complex> = (0..size / 2).map(root).collect();
    let stages = size.trailing_zeros();
    let every = |step| finest.iter().copied().step_by(step).collect();
    (0..stages).map(|stage| every(1 << stage)).collect()
}

/// The Fourier transform by decimation in frequency (Gentleman & Sande
/// 1966): natural order in, bit-reversed order out.
fn forward(data: &mut [Complex], roots: &[Vec<Complex>]) {
    for roots in roots {
        for block in data.chunks_exact_mut(2 * roots.len()) {
            let (low, high) = block.split_at_mut(roots.len());
            for ((a, b), w) in low.iter_mut().zip(high).zip(roots) {
                let difference = [a[0] - b[0], a[1] - b[1]];
                *a = [a[0] + b[0], a[1] + b[1]];
                *b = product(difference, *w);
            }
        }
    }
}

/// The inverse, up to a factor of the size, by decimation in time (Cooley &
/// Tukey 1965): bit-reversed order in, natural order out.
fn inverse(data: &mut [Complex], roots: &[Vec<Complex>]) {
    for roots in roots.iter().rev() {
        for block in data.chunks_exact_mut(2 * roots.len()) {
            let (low, high) = block.split_at_mut(roots.len());
            for ((a, b), w) in low.iter_mut().zip(high).zip(roots) {
                let turned = product(*b, [w[0], -w[1]]);
                *b = [a[0] - turned[0], a[1] - turned[1]];
                *a = [a[0] + turned[0], a[1] + turned[1]];
            }
        }
    }
}

fn product(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::sample;

    /// The definition, term by term.
    fn direct(chain: &[f64], lag: usize) -> f64 {
        let mean = chain.iter().sum::<f64>() / chain.len() as f64;
        let products = chain.iter().zip(&chain[lag..]);
        products.map(|(x, y)| (x - mean) * (y - mean)).sum::<f64>()
            / chain.len() as f64
    }

    #[test]
    fn transform_agrees_with_the_definition() {
        for (count, n) in [(1, 1), (1, 2), (2, 37), (3, 64), (5, 100)] {
            let chains = sample::chains(count, n, 0.7);
            let found = autocovariance_sum(&chains);
            assert_eq!(found.len(), n);
            for (lag, x) in found.iter().enumerate() {
                let expected: f64 =
                    chains.iter().map(|c| direct(c, lag)).sum();
                // Values are of order 1; round-off of the transform.
                assert!((x - expected).abs() < 1e-14, "{count} {n} {lag}");
            }
        }
    }

    #[test]
    fn lag_by_lag_is_the_transform() {
        for (count, n) in [(1, 1), (2, 37), (3, 64), (2, 700)] {
            let chains = sample::chains(count, n, 0.7);
            let all = autocovariance_sum(&chains);
            let mut found = Autocovariances::new(&chains);
            for (lag, x) in all.iter().enumerate() {
                assert!((x - found.at(lag)).abs() < 1e-14, "{n} {lag}");
            }
            assert!(found.at(n).is_nan());
        }
        assert!(Autocovariances::new(&[[0.0; 0]]).at(0).is_nan());
    }

    #[test]
    fn equal_values_have_no_variance() {
        assert_eq!(variance(&[0.1; 7]), 0.0);
        assert_eq!(mean(&[0.1; 7]), 0.1);
        assert!(mean(&[]).is_nan() && variance(&[1.0]).is_nan());
        assert!(autocovariance_sum(&[[0.0; 0]]).is_empty());
    }
}
