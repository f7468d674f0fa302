//! Distributions of several numbers at once: shares, and numbers in order.

use statrs::function::gamma::ln_gamma;

use crate::block::List;
use crate::prior::{
    Beta, Dirichlet, Distribution, Flat, Joint, Normal, Ordered, Prior,
    Uniform,
};
use crate::scalar::{Plain, Real};
use crate::seed::Seed;

type Number = Real<Plain>;

/// ln of the density of numbers, each given those before it; the last one is
/// left out where the others determine it.
fn log_density(joint: &impl Joint<Plain>, x: &[f64]) -> f64 {
    let x: Vec<Number> = x.iter().map(|&x| Real::new(x)).collect();
    let free = x.len() - usize::from(joint.determines_last());
    let each = (0..free)
        .map(|i| joint.next(x.len(), &x[..i]).log_density(x[i]).value());
    each.sum()
}

/// The mean of each number over so many draws, and of its square.
fn moments(
    joint: &impl Joint<Plain>,
    count: usize,
    draws: usize,
) -> Vec<[f64; 2]> {
    let mut rng = Seed::new(7).rng();
    let mut sums = vec![[0.0; 2]; count];
    for _ in 0..draws {
        let drawn: List<f64> = joint.draw(count, &mut rng).unwrap();
        assert_eq!(drawn.len(), count);
        for (sum, x) in sums.iter_mut().zip(drawn) {
            sum[0] += x / draws as f64;
            sum[1] += x * x / draws as f64;
        }
    }
    sums
}

/// Checks the moments of so many draws of Beta(a, b).
fn check_beta([mean, square]: [f64; 2], [a, b]: [f64; 2], draws: usize) {
    let known = a / (a + b);
    let variance = known * (1.0 - known) / (a + b + 1.0);
    // Four and a half standard errors of the mean; more of them of the
    // variance, since fourth powers of numbers below 1 are below their squares.
    let error = 4.5 * (variance / draws as f64).sqrt();
    assert!((mean - known).abs() < error, "{mean} for {known}");
    let spread = square - mean * mean;
    assert!((spread - variance).abs() < error, "{spread} for {variance}");
}

#[test]
fn shares_have_dirichlets_density() {
    let weights = [2.0, 0.7, 3.0, 1.2];
    let shares = Dirichlet::<Plain>::new(weights);
    let sum: f64 = weights.iter().sum();
    let constant =
        ln_gamma(sum) - weights.iter().map(|a| ln_gamma(*a)).sum::<f64>();
    for x in [[0.1_f64, 0.2, 0.3, 0.4], [0.6, 0.05, 0.3, 0.05]] {
        let powers = weights.iter().zip(x).map(|(a, x)| (a - 1.0) * x.ln());
        let known = constant + powers.sum::<f64>();
        // Round-off of a few logarithms of order 1.
        let off = log_density(&shares, &x) - known;
        assert!(off.abs() < 1e-12, "{x:?}: {off}");
        let before = x.map(Real::new);
        let last = shares.last(&before[..3]).value();
        assert!((last - x[3]).abs() < 1e-15, "{last}");
    }
}

#[test]
fn draws_of_shares_have_dirichlets_moments() {
    let weights = [2.0, 0.7, 3.0, 1.2];
    let sum: f64 = weights.iter().sum();
    let draws = 20_000;
    let shares = Dirichlet::<Plain>::new(weights);
    let found = moments(&shares, weights.len(), draws);
    for (&a, moments) in weights.iter().zip(found) {
        check_beta(moments, [a, sum - a], draws);
    }
}

#[test]
fn shares_of_tiny_weights_are_all_or_nothing() {
    // ln of a gamma number of shape 1e-4 is about -1e4: none but the largest
    // is above 0, and by itself even that is not.
    let shares = Dirichlet::<Plain>::new([1e-4; 3]);
    let mut rng = Seed::new(3).rng();
    for _ in 0..50 {
        let drawn = shares.draw(3, &mut rng).unwrap();
        assert!((drawn.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert!(drawn.iter().any(|x| *x > 0.99), "{drawn:?}");
    }
    let impossible = Dirichlet::<Plain>::new([1.0, 0.0]);
    assert!(impossible.draw(2, &mut rng).is_none());
}

#[test]
fn a_share_is_a_part_of_what_is_left() {
    let shares = Dirichlet::<Plain>::new([2.0, 0.7, 3.0]);
    let before = [Real::new(0.6)];
    let second = shares.next(3, &before);
    assert!(second.is_proper());
    assert_eq!(second.support().ends(), (0.0, 1.0 - 0.6));
    let of = Beta::<Plain>::new(0.7, 3.0);
    for p in [0.1, 0.5, 0.9] {
        let known = 0.4 * of.quantile(p).unwrap();
        let off = second.quantile(p).unwrap() / known - 1.0;
        assert!(off.abs() < 1e-14, "{p}: {off}");
    }
    let (draws, mut rng) = (20_000, Seed::new(5).rng());
    let sum: f64 = (0..draws).map(|_| second.draw(&mut rng).unwrap()).sum();
    let (mean, known) = (sum / f64::from(draws), 0.4 * 0.7 / 3.7);
    // Four and a half standard errors.
    let sd = 0.4 * (0.7 * 3.0_f64 / (3.7 * 3.7 * 4.7)).sqrt();
    let error = 4.5 * sd / f64::from(draws).sqrt();
    assert!((mean - known).abs() < error, "{mean} for {known}");
}

#[test]
fn shares_are_as_many_as_weights() {
    let check = |weights: usize, count| {
        Dirichlet::<Plain>::new(vec![1.0; weights]).check(count)
    };
    assert!(check(3, 3).is_ok() && check(2, 2).is_ok());
    for (weights, count, says) in [
        (1, 1, "has 1 shares; expected two"),
        (0, 0, "has 0 shares; expected two"),
        (2, 3, "2 weights for 3 shares"),
        (3, 2, "3 weights for 2 shares"),
    ] {
        let said = check(weights, count).unwrap_err().to_string();
        assert!(said.contains(says), "{said}");
    }
}

#[test]
fn numbers_in_order_have_the_density_of_all_their_orders() {
    let normal = Normal::<Plain>::new(0.5, 2.0);
    let ordered = Ordered::<Plain, _>::new(normal);
    let x = [-1.0, 0.3, 0.4, 5.0];
    let each = x.map(|x| normal.log_density(Real::new(x)).value());
    let known = 24.0_f64.ln() + each.iter().sum::<f64>();
    assert!((log_density(&ordered, &x) - known).abs() < 1e-13);
    for x in [[0.3, 0.3], [0.3, -1.0]] {
        assert_eq!(log_density(&ordered, &x), f64::NEG_INFINITY);
    }
    let before = [Real::new(0.3)];
    let next = ordered.next(2, &before);
    assert_eq!(next.support().ends(), (0.3, f64::INFINITY));
    // Only all of them together have draws.
    assert!(next.draw(&mut Seed::new(1).rng()).is_none());
    assert!(next.quantile(0.5).is_none());
    assert!(next.is_proper());
    assert!(!Ordered::new(Flat::<Plain>::new()).next(2, &before).is_proper());
}

#[test]
fn draws_in_order_are_order_statistics() {
    let ordered = Ordered::new(Uniform::<Plain>::new(0.0, 1.0));
    let (n, draws) = (4, 20_000);
    let found = moments(&ordered, n, draws);
    for (i, moments) in (1..).zip(found) {
        // The i-th of n is Beta(i, n + 1 - i).
        let (a, all) = (f64::from(i), (n + 1) as f64);
        check_beta(moments, [a, all - a], draws);
    }
}
