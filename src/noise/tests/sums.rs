//! Sums of blocks against dense linear algebra.

use super::*;

/// A block with values, and the covariance of its errors over times apart:
/// in seconds, and in steps.
struct Summand {
    part: Box<dyn Part<Plain>>,
    covariance: Box<dyn Fn(f64, f64) -> f64>,
    /// Whether it needs a regular grid.
    on_grid: bool,
}

fn summands() -> Vec<Summand> {
    let x = Number::new;
    let of = |part: Box<dyn Part<Plain>>,
              covariance: Box<dyn Fn(f64, f64) -> f64>| {
        Summand { part, covariance, on_grid: false }
    };
    let mut all = vec![
        of(
            Box::new(White { sigma2: x(0.7) }),
            Box::new(|seconds, _| if seconds == 0.0 { 0.7 } else { 0.0 }),
        ),
        of(
            Box::new(Ou { sd_ou: x(1.3), time_ou: x(0.6) }),
            Box::new(|seconds, _| 1.69 * (-seconds / 0.6).exp()),
        ),
        of(
            Box::new(Matern32 { sd_matern: x(0.9), time_matern: x(0.3) }),
            Box::new(|seconds, _| {
                let q = seconds * 3f64.sqrt() / 0.3;
                0.81 * (1.0 + q) * (-q).exp()
            }),
        ),
    ];
    // Of the last, two values in three tell nothing of the next.
    let memories =
        [&[0.8][..], &[0.6, -0.3], &[0.4, 0.2, -0.5], &[0.0, 0.0, 0.8]];
    for phi in memories {
        let noise = ar(phi, 0.5);
        let c: Vec<f64> =
            noise.coefficients().iter().map(|c| c.value()).collect();
        let gamma = moving_average(&c, 0.5, 2000);
        let (first, variance) = (phi.len() == 1, gamma[0]);
        let own = phi[0];
        all.push(Summand {
            part: Box::new(noise),
            covariance: Box::new(move |_, steps: f64| match first {
                true => variance * own.powf(steps),
                false => gamma[steps.round() as usize],
            }),
            on_grid: !first,
        });
    }
    all
}

/// The covariance of the values of a sum on a grid, each error of so large a
/// size.
fn sum_covariance(of: &[&Summand], at: &Grid) -> DMatrix<f64> {
    let mut places = vec![0.0];
    for i in 1..at.len() {
        places.push(places[i - 1] + at.distance(i));
    }
    with_errors(at, |i, j| {
        let steps = (places[i] - places[j]).abs();
        of.iter().map(|s| (s.covariance)(steps * at.step(), steps)).sum()
    })
}

fn whole<'a>(of: &[&'a Summand]) -> Whole<'a, Plain> {
    let mut whole = Whole::new();
    of.iter().for_each(|summand| summand.part.join(&mut whole));
    whole
}

/// All sums of up to three blocks, twice the same among them.
fn sums(all: &[Summand]) -> Vec<Vec<&Summand>> {
    let mut sums: Vec<Vec<usize>> = (0..all.len()).map(|i| vec![i]).collect();
    let mut longer = sums.clone();
    for _ in 0..2 {
        longer = longer
            .iter()
            .flat_map(|sum| {
                let last = sum[sum.len() - 1];
                (last..all.len()).map(|i| [&sum[..], &[i]].concat())
            })
            .collect();
        sums.extend(longer.iter().cloned());
    }
    let of = |sum: Vec<usize>| sum.into_iter().map(|i| &all[i]).collect();
    sums.into_iter().map(of).collect()
}

#[test]
fn every_sum_of_three_is_the_dense_normal_density() {
    let mut rng = Seed::new(11).rng();
    let all = summands();
    let sums = sums(&all);
    assert_eq!(sums.len(), 7 + 28 + 84);
    let grids: Vec<Grid> =
        grids().into_iter().chain([uneven(false), uneven(true)]).collect();
    for sum in &sums {
        for at in &grids {
            let is_uneven = *at.spacing() == Spacing::Uneven;
            let noise = whole(sum);
            if is_uneven && sum.iter().any(|s| s.on_grid) {
                assert!(noise.check(at).is_err());
                continue;
            }
            noise.check(at).unwrap();
            let r = noise.draw(at, &mut rng).unwrap();
            let expected = dense(sum_covariance(sum, at), &r);
            let found = noise.log_likelihood(at, &lifted(&r)).unwrap();
            close(found.value(), expected, 1e-9);
        }
    }
}

/// 150 even times, and the same with two gaps: what is known of the state no
/// longer changes before the first of them.
fn long_grids() -> [Grid; 2] {
    let all = (0..150).map(|i| 0.25 * f64::from(i));
    let gaps = |t: &f64| !(20.0..21.0).contains(t) && *t != 30.0;
    [
        Grid::new(all.clone().collect(), None),
        Grid::new(all.filter(gaps).collect(), None),
    ]
}

#[test]
fn steady_filters_are_dense_densities() {
    let mut rng = Seed::new(14).rng();
    let all = summands();
    let pairs =
        (0..all.len()).flat_map(|i| (i..all.len()).map(move |j| [i, j]));
    for pair in pairs {
        let sum = pair.map(|i| &all[i]);
        for at in long_grids() {
            let noise = whole(&sum);
            let r = noise.draw(&at, &mut rng).unwrap();
            let expected = dense(sum_covariance(&sum, &at), &r);
            let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
            close(found.value(), expected, 1e-9);
        }
    }
}

/// Of 400 even times: the filter of two vectors against that of the state's
/// covariance, which is taken where values have standard errors, be they 0.
/// Memories of 1 to 300 steps; both carry the round-off of the variance of an
/// error over that of what is new in it, which is 1e6 at the most.
#[test]
fn even_times_are_filtered_as_any() {
    let times: Vec<f64> = (0..400).map(|i| 0.1 * f64::from(i)).collect();
    let even = Grid::new(times.clone(), None);
    let any = Grid::new(times, Some(vec![0.0; 400]));
    let mut rng = Seed::new(15).rng();
    for _ in 0..40 {
        let mut size =
            |from: f64, to: f64| Number::new(rng.random_range(from..to).exp());
        let sd_matern = size(-3.0, 1.0);
        let smooth = Matern32 { sd_matern, time_matern: size(-2.3, 1.0) };
        let drift = Ou { sd_ou: size(-3.0, 1.0), time_ou: size(-2.3, 3.4) };
        let white = White { sigma2: size(-8.0, 0.0) };
        let sums: [&dyn Part<Plain>; 3] = [
            &Sum::new(smooth, drift),
            &Sum::new(smooth, white),
            &Sum::new(drift, white),
        ];
        for sum in sums {
            let noise = Whole::of(sum);
            let r = lifted(&noise.draw(&any, &mut rng).unwrap());
            let expected = noise.log_likelihood(&any, &r).unwrap();
            let found = noise.log_likelihood(&even, &r).unwrap();
            close(found.value(), expected.value(), 1e-9);
        }
    }
}

#[test]
fn steady_filters_have_their_derivatives() {
    let r: Vec<f64> = (0..150).map(|i| (f64::from(i) * 1.3).sin()).collect();
    for at in long_grids() {
        let r = &r[..at.len()];
        gradient_agrees("matern32 + white", &at, [0.9, 0.3, 0.7], r);
        gradient_agrees("ou + white", &at, [1.3, 0.6, 0.7], r);
        gradient_agrees("ou + tails", &at, [1.3, 0.6, 4.5], r);
    }
}

#[test]
fn draws_of_sums_have_the_covariance_of_the_sum() {
    const DRAWS: usize = 20_000;
    let mut rng = Seed::new(12).rng();
    let all = summands();
    let pairs = [[0, 2], [1, 2], [3, 0], [2, 5]];
    for sum in pairs.map(|pair| pair.map(|i| &all[i])) {
        for at in grids() {
            let c = sum_covariance(&sum, &at);
            let noise = whole(&sum);
            let mut seen = DMatrix::zeros(at.len(), at.len());
            for _ in 0..DRAWS {
                let r = DVector::from_vec(noise.draw(&at, &mut rng).unwrap());
                seen.ger(1.0 / DRAWS as f64, &r, &r, 1.0);
            }
            for i in 0..at.len() {
                for j in 0..=i {
                    let square = c[(i, i)] * c[(j, j)] + c[(i, j)].powi(2);
                    let error = (square / DRAWS as f64).sqrt();
                    // The largest of some 2000 entries.
                    let off = (seen[(i, j)] - c[(i, j)]).abs();
                    assert!(off < 4.8 * error, "{i} {j}: {off} {error}");
                }
            }
        }
    }
}

/// Mean and variance of the last value given those before it, by dense linear
/// algebra.
fn given_before(c: &DMatrix<f64>, r: &[f64], i: usize) -> (f64, f64) {
    if i == 0 {
        return (0.0, c[(0, 0)]);
    }
    let past = c.view((0, 0), (i, i)).clone_owned();
    let across = c.view((0, i), (i, 1)).clone_owned();
    let weights = Cholesky::new(past).unwrap().solve(&across);
    let before = DVector::from_column_slice(&r[..i]);
    let mean = weights.dot(&before);
    (mean, c[(i, i)] - weights.dot(&across))
}

#[test]
fn tails_and_growth_shape_what_is_not_remembered() {
    let (nu, growth) = (4.5, -0.9);
    let tails = Tails { nu: Number::new(nu) };
    let growing = Growth { growth: Number::new(growth) };
    let all = summands();
    let mut rng = Seed::new(13).rng();
    for sum in sums(&all).iter().step_by(5) {
        for at in grids() {
            let mut noise = whole(sum);
            tails.join(&mut noise);
            growing.join(&mut noise);
            let r = noise.draw(&at, &mut rng).unwrap();
            let times = at.times();
            let span = times[at.len() - 1] - times[0];
            let size = |i: usize| {
                (growth * ((times[i] - times[0]) / span - 0.5)).exp()
            };
            // Known standard errors stay as large as they are.
            let mut c = sum_covariance(sum, &at);
            for (i, s) in
                at.standard_errors().unwrap_or_default().iter().enumerate()
            {
                c[(i, i)] += s * s * (size(i).powi(-2) - 1.0);
            }
            let even: Vec<f64> =
                r.iter().enumerate().map(|(i, r)| r / size(i)).collect();
            let mut expected = 0.0;
            for i in 0..at.len() {
                let (mean, variance) = given_before(&c, &even, i);
                let width = variance.sqrt();
                let law = StudentsT::new(mean, width, nu).unwrap();
                expected += law.ln_pdf(even[i]) - size(i).ln();
            }
            let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
            close(found.value(), expected, 1e-9);
        }
    }
}

#[test]
fn gradients_of_sums_are_differences() {
    let r: Vec<f64> = (0..16).map(|i| (f64::from(i) * 1.3).sin()).collect();
    for at in grids() {
        let r = &r[..at.len()];
        gradient_agrees("matern32 + white", &at, [0.9, 0.3, 0.7], r);
        gradient_agrees("ou + white", &at, [1.3, 0.6, 0.7], r);
        gradient_agrees("matern32", &at, [0.9, 0.1], r);
        gradient_agrees("white + tails + growth", &at, [0.7, 4.5, 0.6], r);
        gradient_agrees("ar(1) + white", &at, [0.7, 0.5, 0.3], r);
        gradient_agrees("ou + tails", &at, [1.3, 0.6, 4.5], r);
    }
    for at in [uneven(false), uneven(true)] {
        let r = &r[..at.len()];
        gradient_agrees("matern32 + white", &at, [0.9, 0.9, 0.7], r);
    }
}

#[test]
fn smooth_errors_close_together_keep_their_digits() {
    // The next value is known to a small share of the variance, where a dense
    // covariance has lost its digits: that share by its series.
    let noise = Matern32 {
        sd_matern: Number::new(1.0),
        time_matern: Number::new(3f64.sqrt()),
    };
    for step in [1e-1_f64, 1e-2, 1e-3, 1e-4] {
        let c = (1.0 + step) * (-step).exp();
        // 1 - c = x^2/2 - x^3/3 + x^4/8 - x^5/30 ..
        let less = step.powi(2) * (0.5 - step / 3.0 + step * step / 8.0)
            - step.powi(5) / 30.0
            + step.powi(6) / 144.0
            - step.powi(7) / 840.0;
        let variance = less * (1.0 + c);
        let at = Grid::new(vec![0.0, step], None);
        let r = [0.3, 0.3 * c + 0.5 * variance.sqrt()];
        let normal = |r: f64, v: f64| {
            -0.5 * (r * r / v + v.ln() + std::f64::consts::TAU.ln())
        };
        let expected =
            normal(r[0], 1.0) + normal(0.5 * variance.sqrt(), variance);
        let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
        close(found.value(), expected, 1e-7);
    }
}
