//! What residuals tell of the parameters, against Fisher's information.

use super::*;

pub(super) type Carried = Real<Grad<4>>;

/// The sums of products of what a noise says informs, and its log likelihood.
pub(super) fn informed(
    noise: &dyn Noise<Grad<4>>,
    at: &Grid,
    r: &[Carried],
) -> (DMatrix<f64>, Carried) {
    let mut sums = DMatrix::zeros(4, 4);
    let mut hear = |number: &Carried| {
        let slopes = DVector::from_fn(4, |i, _| number.partial(i));
        sums.ger(1.0, &slopes, &slopes, 1.0);
    };
    let total = noise.inform(at, r, &mut hear).unwrap();
    (sums, total)
}

/// The same of a noise by its name and the values of its parameters.
fn told(
    text: &str,
    at: &Grid,
    values: &[f64],
    r: &[Carried],
) -> (DMatrix<f64>, Carried) {
    let of = |(i, &x): (usize, &f64)| Real::variable(x, i);
    let x: Vec<Carried> = values.iter().enumerate().map(of).collect();
    let mut found = None;
    let mut inform = |noise: &dyn Noise<Grad<4>>| {
        found = Some(informed(noise, at, r));
    };
    parse(text).unwrap().with(&x, &mut inform).unwrap();
    found.unwrap()
}

/// Residuals that depend on the fourth direction.
pub(super) fn moved(r: &[f64]) -> Vec<Carried> {
    let direction = Carried::variable(0.0, 3);
    let moved = |(i, &r)| r + direction * (1.7 * i as f64).cos();
    r.iter().enumerate().map(moved).collect()
}

/// Of errors with the covariance sd^2 (1 + q) exp(-q), q = sqrt(3) dt/time,
/// and white ones.
fn smooth_and_white(at: &Grid, [sd, time, white]: [f64; 3]) -> DMatrix<f64> {
    let errors = at.standard_errors();
    DMatrix::from_fn(at.len(), at.len(), |i, j| {
        let apart = (at.times()[i] - at.times()[j]).abs();
        let q = 3f64.sqrt() * apart / time;
        let known = errors.map_or(0.0, |s| s[i] * s[i]);
        let own = if i == j { white + known } else { 0.0 };
        sd * sd * (1.0 + q) * (-q).exp() + own
    })
}

/// m' C^-1 m for what moves the mean, tr(C^-1 C_i C^-1 C_j)/2 for what
/// changes the covariance.
fn information(at: &Grid, values: [f64; 3]) -> DMatrix<f64> {
    let inverse = smooth_and_white(at, values).try_inverse().unwrap();
    let moved = moved(&vec![0.0; at.len()]);
    let mean = DVector::from_fn(at.len(), |i, _| moved[i].partial(3));
    let changes: [DMatrix<f64>; 3] = std::array::from_fn(|k| {
        let of = |h: f64| {
            let mut values = values;
            values[k] += h;
            smooth_and_white(at, values)
        };
        let h = 1e-5;
        &inverse * (of(h) - of(-h)) / (2.0 * h)
    });
    let mut all = DMatrix::zeros(4, 4);
    all[(3, 3)] = mean.dot(&(&inverse * &mean));
    for i in 0..3 {
        for j in 0..3 {
            all[(i, j)] = 0.5 * (&changes[i] * &changes[j]).trace();
        }
    }
    all
}

#[test]
fn what_residuals_tell_is_fishers_information_on_average() {
    const DRAWS: usize = 4000;
    let values = [0.9, 0.3, 0.7];
    let text = "matern32 + white";
    let mut rng = Seed::new(16).rng();
    let even = (0..40).map(|i| 0.25 * f64::from(i)).collect();
    for at in grids().into_iter().chain([Grid::new(even, None)]) {
        let mut sums = DMatrix::<f64>::zeros(4, 4);
        let mut squares = sums.clone();
        for _ in 0..DRAWS {
            let mut r = Vec::new();
            let mut draw = |noise: &dyn Noise<Plain>| {
                r = noise.draw(&at, &mut rng).unwrap();
            };
            let x = lifted(&values);
            parse(text).unwrap().with(&x, &mut draw).unwrap();
            let (one, _) = told(text, &at, &values, &moved(&r));
            squares += one.component_mul(&one);
            sums += one;
        }
        let mean = sums / DRAWS as f64;
        let known = information(&at, values);
        for i in 0..16 {
            let variance = squares[i] / DRAWS as f64 - mean[i] * mean[i];
            let error = (variance.max(0.0) / DRAWS as f64).sqrt();
            let off = (mean[i] - known[i]).abs();
            // The largest of 16 entries on five grids; differences are good
            // to about 1e-9 of an entry.
            let size = known[i].abs() + 1.0;
            assert!(off < 4.0 * error + 1e-8 * size, "{i}: {off} {error}");
        }
    }
}

#[test]
fn white_errors_with_tails_tell_what_students_do() {
    let r: Vec<f64> = (0..16).map(|i| (f64::from(i) * 1.3).tan()).collect();
    for at in grids() {
        let r = moved(&r[..at.len()]);
        let (scale, nu) = (0.6_f64, 4.5);
        let (student, of_it) = told("student", &at, &[nu, scale], &r);
        let white = [scale * scale, nu];
        let (sum, of_sum) = told("white + tails", &at, &white, &r);
        close(of_sum.value(), of_it.value(), 1e-12);
        // sigma2 = scale^2 first, then nu.
        let turn = DMatrix::from_row_slice(
            3,
            3,
            &[0.0, 2.0 * scale, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        );
        let of = |m: DMatrix<f64>| {
            m.select_rows(&[0, 1, 3]).select_columns(&[0, 1, 3])
        };
        let turned = turn.transpose() * of(sum) * &turn;
        for (found, known) in turned.iter().zip(of(student).iter()) {
            close(*found, *known, 1e-12);
        }
    }
}

#[test]
fn sizes_that_grow_tell_of_their_growth() {
    let at = Grid::new((0..6).map(f64::from).collect(), None);
    // Errors of 0 tell nothing of where they are.
    let r = lifted(&[0.0; 6]);
    let nu = 4.5;
    let (sum, _) = told("white + tails + growth", &at, &[0.5, nu, 0.0], &r);
    // ln of a size is growth (share - 1/2).
    let squares: f64 = (0..6).map(|i| (at.share(i) - 0.5).powi(2)).sum();
    close(sum[(2, 2)], 2.0 * nu / (nu + 3.0) * squares, 1e-13);
}

#[test]
fn what_is_told_on_the_way_is_the_likelihood_with_its_gradient() {
    let r: Vec<f64> = (0..150).map(|i| (f64::from(i) * 1.3).sin()).collect();
    let long = Grid::new((0..150).map(f64::from).collect(), None);
    for at in grids().into_iter().chain([long]) {
        for (text, values) in [
            ("matern32 + white", [0.9, 0.3, 0.7]),
            ("ou + tails", [1.3, 0.6, 4.5]),
            ("white + tails + growth", [0.7, 4.5, 0.6]),
            ("ar(2)", [0.4, -0.5, 0.8]),
        ] {
            let r = moved(&r[..at.len()]);
            let (_, total) = told(text, &at, &values, &r);
            let x: Vec<_> =
                (0..3).map(|i| Real::variable(values[i], i)).collect();
            let mut alone = Carried::new(0.0);
            let mut add = |noise: &dyn Noise<Grad<4>>| {
                alone = noise.log_likelihood(&at, &r).unwrap();
            };
            parse(text).unwrap().with(&x, &mut add).unwrap();
            // Sums of 150 terms in another order.
            close(total.value(), alone.value(), 1e-12);
            for i in 0..4 {
                close(total.partial(i), alone.partial(i), 1e-11);
            }
        }
    }
}
