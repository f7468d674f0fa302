//! The noises against dense linear algebra and against statrs.

use nalgebra::{Cholesky, DMatrix, DVector};
use rand::RngExt;
use statrs::distribution::{
    Continuous, ContinuousCDF, Normal as StatrsNormal, StudentsT,
};

mod defaults;
mod double;
mod informing;
mod sums;

use self::double::Double;
use super::*;
use crate::block::{Block, Sum};
use crate::scalar::{Grad, Plain};
use crate::seed::Seed;

type Number = Real<Plain>;

fn ar(phi: &[f64], sigma2: f64) -> Ar<Number> {
    let phi = phi.iter().map(|&p| Real::new(p)).collect();
    Ar { phi, sigma2: Real::new(sigma2) }
}

fn lifted<K: Kind>(values: &[f64]) -> Vec<Real<K>> {
    values.iter().map(|&x| Real::new(x)).collect()
}

/// Grids with and without gaps, with and without known errors.
fn grids() -> Vec<Grid> {
    let full: Vec<f64> = (0..14).map(|i| f64::from(i) * 0.04).collect();
    let places = [0, 1, 2, 5, 6, 7, 8, 9, 20, 21, 22, 30, 70, 71, 72, 73];
    let gaps: Vec<f64> = places.map(|i| f64::from(i) * 0.04).to_vec();
    [full, gaps]
        .into_iter()
        .flat_map(|times| {
            let errors = (0..times.len())
                .map(|i| [0.3, 0.0, 2.0, 1e-4][i % 4] + 0.01 * i as f64 % 0.05)
                .collect();
            let plain = Grid::new(times.clone(), None);
            [plain, Grid::new(times, Some(errors))]
        })
        .collect()
}

/// Autocovariances by the sums of the infinite moving average,
/// gamma_h = sigma2 sum_j psi_j psi_(j+h).
fn moving_average(c: &[f64], sigma2: f64, lags: usize) -> Vec<f64> {
    let mut psi = vec![1.0_f64];
    let (mut largest, mut small) = (1.0_f64, 0);
    while small < 50 {
        let next: f64 =
            c.iter().zip(psi.iter().rev()).map(|(c, p)| c * p).sum();
        psi.push(next);
        largest = largest.max(next.abs());
        small = if next.abs() < 1e-17 * largest { small + 1 } else { 0 };
    }
    (0..lags)
        .map(|h| {
            let pairs = psi.iter().zip(psi.iter().skip(h));
            sigma2 * pairs.map(|(a, b)| a * b).sum::<f64>()
        })
        .collect()
}

/// The covariance of the recorded values of an AR on a grid.
fn covariance(noise: &Ar<Number>, at: &Grid) -> DMatrix<f64> {
    let c: Vec<f64> = noise.coefficients().iter().map(|c| c.value()).collect();
    let place = |i: usize| (at.times()[i] / at.step()).round() as usize;
    let lags = place(at.len() - 1) + 1;
    let gamma = moving_average(&c, noise.sigma2.value(), lags);
    with_errors(at, |i, j| gamma[place(i).abs_diff(place(j))])
}

fn with_errors(at: &Grid, f: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
    let mut matrix = DMatrix::from_fn(at.len(), at.len(), f);
    for (i, s) in at.standard_errors().unwrap_or_default().iter().enumerate() {
        matrix[(i, i)] += s * s;
    }
    matrix
}

/// The dense multivariate normal log density.
fn dense(covariance: DMatrix<f64>, r: &[f64]) -> f64 {
    let r = DVector::from_column_slice(r);
    let cholesky = Cholesky::new(covariance).unwrap();
    let scaled = cholesky.l().solve_lower_triangular(&r).unwrap();
    let half_log_det: f64 = cholesky.l().diagonal().map(f64::ln).sum();
    -0.5 * scaled.norm_squared()
        - half_log_det
        - r.len() as f64 * 0.5 * std::f64::consts::TAU.ln()
}

fn close(found: f64, expected: f64, tolerance: f64) {
    let limit = tolerance * (1.0 + expected.abs());
    assert!((found - expected).abs() < limit, "{found} for {expected}");
}

#[test]
fn ar_is_the_dense_normal_density() {
    let mut rng = Seed::new(1).rng();
    for k in (1..=5).cycle().take(20) {
        let phi: Vec<f64> =
            (0..k).map(|_| rng.random_range(-0.9..0.9)).collect();
        let noise = ar(&phi, rng.random_range(0.3..3.0));
        for at in grids() {
            let r = noise.draw(&at, &mut rng).unwrap();
            let expected = dense(covariance(&noise, &at), &r);
            let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
            close(found.value(), expected, 1e-9);
        }
    }
}

/// The density of an AR on a grid with twice the digits.
fn twice_the_digits(noise: &Ar<Number>, at: &Grid, r: &[f64]) -> f64 {
    let phi: Vec<f64> = noise.phi.iter().map(|p| p.value()).collect();
    let c = double::coefficients(&phi);
    let place = |i: usize| (at.times()[i] / at.step()).round() as usize;
    let lags = place(at.len() - 1) + 1;
    let gamma = double::yule_walker(&c, noise.sigma2.value(), lags);
    let entry = |i: usize, j: usize| {
        let known = at.standard_errors().filter(|_| i == j);
        let s = Double::from(known.map_or(0.0, |s| s[i]));
        gamma[place(i).abs_diff(place(j))] + s * s
    };
    let row = |i| (0..at.len()).map(|j| entry(i, j)).collect();
    double::log_density((0..at.len()).map(row).collect(), r)
}

#[test]
fn ar_is_exact_at_the_edge_of_stationarity() {
    let mut rng = Seed::new(8).rng();
    for k in (1..=5).cycle().take(30) {
        let mut phi: Vec<f64> =
            (0..k).map(|_| rng.random_range(-0.9..0.9)).collect();
        // One or two of them, of either sign.
        phi[rng.random_range(0..k)] = 0.9999;
        phi[rng.random_range(0..k)] = -0.9999;
        phi[rng.random_range(0..k)] *= -1.0;
        let noise = ar(&phi, rng.random_range(0.3..3.0));
        for at in grids() {
            let r = noise.draw(&at, &mut rng).unwrap();
            let expected = twice_the_digits(&noise, &at, &r);
            let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
            close(found.value(), expected, 1e-10);
        }
    }
}

#[test]
fn partial_autocorrelations_are_what_they_are_called() {
    let phi = [0.7, -0.5, 0.3, 0.8];
    let noise = ar(&phi, 1.3);
    let c: Vec<f64> = noise.coefficients().iter().map(|c| c.value()).collect();
    let gamma = moving_average(&c, 1.3, 12);
    // phi_jj is the last coefficient of the projection on j values.
    for j in 1..=4 {
        let toeplitz = DMatrix::from_fn(j, j, |a, b| gamma[a.abs_diff(b)]);
        let right = DVector::from_column_slice(&gamma[1..=j]);
        let projection = toeplitz.lu().solve(&right).unwrap();
        close(projection[j - 1], phi[j - 1], 1e-12);
    }
    for (found, &expected) in noise.autocovariances(12).iter().zip(&gamma) {
        close(found.value(), expected, 1e-12);
    }
    close(noise.stationary_sd().value(), gamma[0].sqrt(), 1e-12);
    assert!(noise.autocovariances(0).is_empty());
}

#[test]
fn ar1_is_equation_7() {
    let (phi, sigma2) = (0.83_f64, 0.7_f64);
    let r = [0.4, -1.2, 0.1, 2.3, 1.9];
    let normal =
        |x: f64, v: f64| StatrsNormal::new(0.0, v.sqrt()).unwrap().ln_pdf(x);
    let first = normal(r[0], sigma2 / (1.0 - phi * phi));
    let others = r.windows(2).map(|w| normal(w[1] - phi * w[0], sigma2));
    let expected = first + others.sum::<f64>();
    let at = Grid::new(vec![0.0, 0.1, 0.2, 0.3, 0.4], None);
    let found = ar(&[phi], sigma2).log_likelihood(&at, &lifted(&r)).unwrap();
    close(found.value(), expected, 1e-14);
}

fn uneven(errors: bool) -> Grid {
    let times =
        vec![0.0, 0.13, 0.9, 1.02, 1.021, 2.7, 3.3, 9.1, 9.35, 9.8, 40.0];
    let known = times.iter().map(|t| 0.1 + 0.02 * t).collect();
    Grid::new(times, errors.then_some(known))
}

fn uneven_covariance(phi: f64, sigma2: f64, at: &Grid) -> DMatrix<f64> {
    let gamma = sigma2 / (1.0 - phi * phi);
    let t = at.times();
    with_errors(at, |i, j| gamma * phi.powf((t[i] - t[j]).abs() / at.step()))
}

#[test]
fn uneven_times_are_the_dense_ornstein_uhlenbeck_density() {
    let mut rng = Seed::new(2).rng();
    for phi in [0.01, 0.4, 0.95, 0.9999] {
        let noise = ar(&[phi], 0.6);
        for at in [uneven(false), uneven(true)] {
            assert_eq!(*at.spacing(), Spacing::Uneven);
            noise.check(&at).unwrap();
            let r = noise.draw(&at, &mut rng).unwrap();
            let expected = dense(uneven_covariance(phi, 0.6, &at), &r);
            let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
            close(found.value(), expected, 1e-9);
        }
    }
}

#[test]
fn order_20_starts_and_runs() {
    let phi: Vec<f64> = (1..=20).map(|i| 0.5 / f64::from(i)).collect();
    let noise = ar(&phi, 1.0);
    let mut rng = Seed::new(3).rng();
    for at in grids() {
        let r = noise.draw(&at, &mut rng).unwrap();
        let expected = dense(covariance(&noise, &at), &r);
        let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
        close(found.value(), expected, 1e-9);
    }
}

#[test]
fn long_gaps_are_as_exact_as_their_steps() {
    let n = 1_000_000;
    let long = |n: u32| {
        let places = [0, 1, 2, n + 2, n + 3].map(f64::from);
        Grid::new(places.to_vec(), None)
    };
    let r = [1.0, -0.4, 0.7, 2.0, 1.1];
    for phi in [&[0.5][..], &[0.5, -0.3], &[0.9999, -0.9, 0.2], &[-0.9999]] {
        let noise = ar(phi, 1.0);
        let at = long(n);
        let x: Vec<Real<Grad<4>>> = lifted(&r);
        let values: Vec<Real<Grad<4>>> = phi
            .iter()
            .chain(&[1.0])
            .enumerate()
            .map(|(i, &p)| Real::variable(p, i))
            .collect();
        let found = Ar::from_values(&values).log_likelihood(&at, &x).unwrap();
        assert!(found.is_finite());
        // exp(-100) is left of the correlation.
        let part = |range: std::ops::Range<usize>| {
            let at = Grid::new(at.times()[range.clone()].to_vec(), None);
            let values = lifted(&r[range]);
            noise.log_likelihood(&at, &values).unwrap().value()
        };
        close(found.value(), part(0..3) + part(3..5), 1e-9);
    }
    // Where the correlation survives the gap, against the dense density; with
    // odd and even numbers of steps.
    for phi in [&[0.9999][..], &[-0.9999], &[0.999, 0.2], &[-0.999, 0.2]] {
        for steps in [1000, 1001] {
            let (noise, at) = (ar(phi, 1.0), long(steps));
            let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
            let expected = dense(covariance(&noise, &at), &r);
            close(found.value(), expected, 1e-9);
        }
    }
}

/// Every noise on every grid where it is defined.
fn cases() -> Vec<(Box<dyn Noise<Plain>>, Grid)> {
    let mut cases: Vec<(Box<dyn Noise<Plain>>, Grid)> = Vec::new();
    for at in grids().into_iter().chain([uneven(false), uneven(true)]) {
        let x = Number::new;
        cases.push((Box::new(Iid { sigma2: x(0.8) }), at.clone()));
        let student = Student { dof: x(3.5), scale: x(0.8) };
        cases.push((Box::new(student), at.clone()));
        let smooth = Matern32 { sd_matern: x(0.9), time_matern: x(0.3) };
        let white = White { sigma2: x(0.2) };
        let both = Sum::new(smooth, white);
        cases.push((Box::new(both), at.clone()));
        let shaped = Sum::new(Tails { nu: x(5.0) }, Growth { growth: x(0.7) });
        cases.push((Box::new(Sum::new(both, shaped)), at.clone()));
        for phi in [&[0.6][..], &[0.7, -0.4], &[0.2, 0.3, -0.6]] {
            let noise = ar(phi, 0.8);
            if noise.check(&at).is_ok() {
                cases.push((Box::new(noise), at.clone()));
            }
        }
    }
    cases
}

#[test]
fn conditionals_sum_to_the_total() {
    let mut rng = Seed::new(4).rng();
    for (noise, at) in cases() {
        let r = lifted(&noise.draw(&at, &mut rng).unwrap());
        let mut sum = 0.0;
        noise.walk(&at, &r, &mut |c| sum += c.log_density.value()).unwrap();
        let total = noise.log_likelihood(&at, &r).unwrap().value();
        close(sum, total, 1e-12);
    }
}

#[test]
fn innovations_of_draws_are_standard_normal() {
    let mut rng = Seed::new(5).rng();
    for (noise, at) in cases() {
        let (mut n, mut squares, mut inside) = (0.0, 0.0, 0.0);
        while n < 40_000.0 {
            let r = lifted(&noise.draw(&at, &mut rng).unwrap());
            for z in noise.innovations(&at, &r).unwrap() {
                n += 1.0;
                squares += z * z;
                inside += f64::from(u8::from(z.abs() < 1.0));
            }
        }
        // Variance 1 and P(|z| < 1) = 0.6827, to 4.5 Monte Carlo errors.
        assert!((squares / n - 1.0).abs() < 4.5 * (2.0 / n).sqrt());
        let error = (0.6827 * 0.3173 / n).sqrt();
        assert!((inside / n - 0.682_689_5).abs() < 4.5 * error);
    }
}

#[test]
fn draws_have_the_covariance_of_the_process() {
    const DRAWS: usize = 20_000;
    let mut rng = Seed::new(6).rng();
    let mut agree = |noise: &Ar<Number>, at: &Grid, c: &DMatrix<f64>| {
        let mut sum = DMatrix::zeros(at.len(), at.len());
        for _ in 0..DRAWS {
            let r = DVector::from_vec(noise.draw(at, &mut rng).unwrap());
            sum.ger(1.0 / DRAWS as f64, &r, &r, 1.0);
        }
        for i in 0..at.len() {
            for j in 0..=i {
                let square = c[(i, i)] * c[(j, j)] + c[(i, j)].powi(2);
                let error = (square / DRAWS as f64).sqrt();
                assert!((sum[(i, j)] - c[(i, j)]).abs() < 4.8 * error);
            }
        }
    };
    for phi in [&[-0.8][..], &[0.9], &[0.7, -0.6], &[0.3, 0.5, 0.7]] {
        let noise = ar(phi, 1.4);
        for at in grids() {
            agree(&noise, &at, &covariance(&noise, &at));
        }
    }
    for at in [uneven(false), uneven(true)] {
        agree(&ar(&[0.7], 1.4), &at, &uneven_covariance(0.7, 1.4, &at));
    }
}

/// Central difference of eighth order.
fn difference(f: impl Fn(f64) -> f64, h: f64) -> f64 {
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let pair = |i: usize| {
        let d = h * (i + 1) as f64;
        weights[i] * (f(d) - f(-d))
    };
    (0..4).map(pair).sum::<f64>() / h
}

/// Compares the gradient in up to three parameters and in a direction of the
/// residuals with differences.
fn gradient_agrees<const P: usize>(
    text: &str,
    at: &Grid,
    values: [f64; P],
    r: &[f64],
) {
    let entry = parse(text).unwrap();
    let way = |i: usize| (1.7 * i as f64).cos();
    let plain = |moved: usize, d: f64| {
        let mut x: Vec<Number> = lifted(&values);
        let mut r: Vec<Number> = lifted(r);
        match x.get_mut(moved) {
            Some(x) => *x += d,
            None => {
                r.iter_mut().enumerate().for_each(|(i, r)| *r += d * way(i));
            }
        }
        let mut total = 0.0;
        let mut add = |noise: &dyn Noise<Plain>| {
            total = noise.log_likelihood(at, &r).unwrap().value();
        };
        entry.with(&x, &mut add).unwrap();
        total
    };
    let direction = Real::<Grad<4>>::variable(0.0, P);
    let r: Vec<_> =
        r.iter().enumerate().map(|(i, &r)| r + direction * way(i)).collect();
    let x: Vec<_> = (0..P).map(|i| Real::variable(values[i], i)).collect();
    let mut found = Real::<Grad<4>>::new(0.0);
    entry
        .with(&x, &mut |noise| found = noise.log_likelihood(at, &r).unwrap())
        .unwrap();
    for moved in 0..=P {
        let expected = difference(|d| plain(moved, d), 2e-3);
        close(found.partial(moved), expected, 1e-7);
    }
}

#[test]
fn gradients_are_differences() {
    let r: Vec<f64> = (0..16).map(|i| (f64::from(i) * 1.3).sin()).collect();
    for at in grids() {
        let r = &r[..at.len()];
        for phi in [-0.9, 0.0, 0.4] {
            gradient_agrees("ar(1)", &at, [phi, 0.8], r);
            gradient_agrees("ar(2)", &at, [phi, -0.5, 0.8], r);
            gradient_agrees("ar(2)", &at, [0.6, phi, 0.8], r);
        }
        gradient_agrees("iid", &at, [0.8], r);
        gradient_agrees("student", &at, [4.2, 0.8], r);
        gradient_agrees("student", &at, [230.0, 0.8], r);
    }
    for at in [uneven(false), uneven(true)] {
        gradient_agrees("ar(1)", &at, [0.6, 0.8], &r[..at.len()]);
    }
}

#[test]
fn what_is_no_process_is_rejected() {
    let at = Grid::new(vec![0.0, 1.0, 2.0], None);
    let r = lifted(&[1.0, 2.0, 3.0]);
    let rejects = |noise: &dyn Noise<Plain>, at: &Grid, r: &[Number]| {
        let rejected = |e| matches!(e, Err(Stop::Reject(_)));
        rejected(noise.log_likelihood(at, r).map(|_| ()))
            && rejected(noise.walk(at, r, &mut |_| {}))
            && rejected(noise.draw(at, &mut Seed::new(7).rng()).map(|_| ()))
    };
    let bad = [0.0, -1.0, f64::NAN, f64::INFINITY];
    for x in bad.map(Number::new) {
        let one = Number::new(1.0);
        assert!(rejects(&Iid { sigma2: x }, &at, &r));
        assert!(rejects(&ar(&[0.5], x.value()), &at, &r));
        assert!(rejects(&Student { dof: x, scale: one }, &at, &r));
        assert!(rejects(&Student { dof: one, scale: x }, &at, &r));
    }
    for phi in [1.0, -1.0, 1.5, f64::NAN] {
        assert!(rejects(&ar(&[phi], 1.0), &at, &r));
        assert!(rejects(&ar(&[0.2, phi], 1.0), &at, &r));
        assert!(rejects(&ar(&[phi, phi], 1.0), &at, &r));
    }
    let at = uneven(false);
    assert!(rejects(&ar(&[-0.1], 1.0), &at, &lifted(&[0.0; 11])));
}

#[test]
fn what_a_user_has_to_mend_is_said() {
    let input = |noise: &Ar<Number>, at: &Grid, words: &str| {
        let error = noise.check(at).unwrap_err();
        assert!(error.is_input() && error.to_string().contains(words));
        let r = vec![Number::new(0.1); at.len()];
        noise.log_likelihood(at, &r).unwrap_err()
    };
    let stop = input(
        &ar(&[0.1, 0.2], 1.0),
        &uneven(false),
        "ar(2) needs times on a regular grid",
    );
    assert!(matches!(stop, Stop::Fail(_)));
    let stop = input(
        &ar(&[], 1.0),
        &Grid::new(vec![0.0, 1.0], None),
        "at least one phi",
    );
    assert!(matches!(stop, Stop::Fail(_)));
    let repeated = Grid::new(vec![0.0, 1.0, 1.0, 2.0], None);
    let stop = input(&ar(&[0.1], 1.0), &repeated, "1 s follows 1 s");
    assert!(matches!(stop, Stop::Reject(_)));
    let short = ar(&[0.1], 1.0)
        .log_likelihood(&Grid::new(vec![0.0, 1.0], None), &lifted(&[1.0]));
    assert!(matches!(short, Err(Stop::Fail(_))));
}

#[test]
fn fewer_values_than_the_order_are_enough() {
    let noise = ar(&[0.5, -0.4, 0.3], 1.0);
    for n in 0..4 {
        let at = Grid::new((0..n).map(f64::from).collect(), None);
        let r: Vec<f64> = (0..n).map(|i| 0.5 - f64::from(i)).collect();
        let found = noise.log_likelihood(&at, &lifted(&r)).unwrap().value();
        let gamma = noise.autocovariances(4);
        let size = r.len();
        let matrix =
            DMatrix::from_fn(size, size, |i, j| gamma[i.abs_diff(j)].value());
        let expected = if n == 0 { 0.0 } else { dense(matrix, &r) };
        close(found, expected, 1e-12);
    }
}

#[test]
fn student_is_the_density_of_statrs() {
    let at = Grid::new(vec![0.0], None);
    let known = Grid::new(vec![0.0], Some(vec![1.7]));
    for dof in [0.5, 1.0, 2.7, 30.0, 199.9, 200.1, 1000.0] {
        let noise = Student { dof: Number::new(dof), scale: Number::new(0.6) };
        for r in [0.0, 0.3, -4.0, 60.0] {
            for (at, width) in [(&at, 0.6), (&known, 0.6_f64.hypot(1.7))] {
                let law = StudentsT::new(0.0, width, dof).unwrap();
                let found = noise.log_likelihood(at, &lifted(&[r])).unwrap();
                close(found.value(), law.ln_pdf(r), 1e-10);
                let z = noise.innovations(at, &lifted(&[r])).unwrap()[0];
                let p = StatrsNormal::standard().cdf(-z.abs());
                let expected = law.cdf(-r.abs());
                // Below, the deviate is bounded to stay finite.
                if expected > f64::MIN_POSITIVE {
                    close(p.ln(), expected.ln(), 1e-7);
                }
                assert!(z.is_finite());
                assert!(z * r >= 0.0);
            }
        }
    }
}

#[test]
fn student_tends_to_the_normal() {
    let at = Grid::new(vec![0.0, 1.0, 2.0], None);
    let r: Vec<Number> = lifted(&[0.3, -1.0, 2.0]);
    let x = Number::new;
    let normal = Iid { sigma2: x(0.49) }.log_likelihood(&at, &r).unwrap();
    for dof in [1e8, 1e12, 1e16] {
        let noise = Student { dof: x(dof), scale: x(0.7) };
        let found = noise.log_likelihood(&at, &r).unwrap();
        close(found.value(), normal.value(), 1e-6);
    }
    for dof in [0.9e6, 1.1e6, 1e8, 1e12, 1e16] {
        let noise = Student { dof: x(dof), scale: x(0.7) };
        for (z, r) in noise.innovations(&at, &r).unwrap().iter().zip(&r) {
            // z - t is about -t (t^2 + 1) / (4 dof).
            close(*z, r.value() / 0.7, 1e-5);
        }
    }
}
