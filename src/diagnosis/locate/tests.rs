//! A force over time on an even slope, where every speed is linear in the
//! friction and the force, against linear algebra.

use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};

use super::process::Process;
use super::tangent::{Basis, Waves, half_log_det};
use super::*;
use crate::diagnosis::evidence::fit::fit;
use crate::draws::log_sum_exp;
use crate::error::Outcome;
use crate::infer::LaplaceMixture;
use crate::model::{Label, Number, Program, Run};
use crate::noise::Iid;
use crate::observe::{Event, Series};
use crate::physics::friction::Coulomb;
use crate::physics::{GRAVITY, Track};
use crate::prior::AnyPrior;
use crate::scalar::Real;

/// Dry friction, mu ~ N(0.3, 0.1), and errors of a known standard deviation.
struct Sliding(Event);

const MU: (f64, f64) = (0.3, 0.1);
const NOISE: f64 = 0.2;
const DEGREES: f64 = 35.0;
const START: f64 = 15.0;

impl Program for Sliding {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let prior = AnyPrior::Normal(MU.0, MU.1);
        let mu = run.scalar(Label::new("mu", "1"), prior)?;
        let friction = run.declare(Coulomb { mu });
        let flow = self.0.slide(&friction)?;
        let sigma2 = Real::new(NOISE * NOISE);
        run.observe(&self.0.velocity, flow.velocity(), &Iid { sigma2 })
    }
}

/// Synthetic speeds with a push of 0.8 m/s2 from 3 to 5 s.
fn pushed() -> Sliding {
    let (sin, cos) = DEGREES.to_radians().sin_cos();
    let times: Vec<f64> = (1..=40).map(|i| 0.25 * f64::from(i)).collect();
    let mut rng = Seed::new(4).rng();
    let speed = |t: &f64| {
        let error: f64 = StandardNormal.sample(&mut rng);
        let push = 0.8 * (t - 3.0).clamp(0.0, 2.0);
        START + GRAVITY * (sin - 0.33 * cos) * t + push + NOISE * error
    };
    let speeds = times.iter().map(speed).collect();
    let event = Event::on(Track::incline(DEGREES, 2000.0).unwrap())
        .release(0.0, START)
        .velocity(Series::velocity(times, speeds).unwrap());
    Sliding(event.build().unwrap())
}

/// What is to be seen of a force over time in these speeds.
fn seen(check: impl FnOnce(Sought<'_, '_>)) {
    let program = pushed();
    let extent = program.0.extent();
    let form = FreeForm::cells(&extent, Axis::Time, CELLS);
    let with = With::new(&program, &[&form]);
    let posterior = Posterior::new(&with).unwrap();
    let sought = Sought::of(&posterior, &extent, CELLS);
    check(sought);
}

/// The same in matrices: what is left of the speeds at the mean friction, what
/// is known of it without a force, and how the force of each cell adds.
struct Linear {
    off: DVector<f64>,
    known: DMatrix<f64>,
    adds: DMatrix<f64>,
    step: f64,
}

impl Linear {
    fn of(Sliding(event): &Sliding) -> Self {
        let (sin, cos) = DEGREES.to_radians().sin_cos();
        let times = DVector::from_column_slice(event.velocity.times());
        let values = DVector::from_column_slice(event.velocity.values());
        let pull = GRAVITY * (sin - MU.0 * cos);
        let off = values.add_scalar(-START) - pull * &times;
        let n = times.len();
        let friction = GRAVITY * cos * MU.1 * &times;
        let known = DMatrix::identity(n, n) * NOISE * NOISE
            + &friction * friction.transpose();
        let cell = event.extent().duration / CELLS as f64;
        let adds = DMatrix::from_fn(n, CELLS, |i, k| {
            (times[i] - k as f64 * cell).clamp(0.0, cell)
        });
        Self { off, known, adds, step: event.extent().run / CELLS as f64 }
    }

    /// ln p(recording), and the mean force, at a covariance of the force.
    fn given(&self, covariance: &DMatrix<f64>) -> (f64, DVector<f64>) {
        let across = covariance * self.adds.transpose();
        let factor = (&self.known + &self.adds * &across).cholesky().unwrap();
        let solved = factor.solve(&self.off);
        let log_det = 2.0 * factor.l().diagonal().map(f64::ln).sum();
        let n = self.off.len() as f64;
        let squares = self.off.dot(&solved);
        let log = -0.5 * (squares + log_det + n * std::f64::consts::TAU.ln());
        (log, across * solved)
    }

    fn covariance(&self, process: Process) -> DMatrix<f64> {
        let (length, size) = (process.length(), process.size());
        DMatrix::from_fn(CELLS, CELLS, |i, j| {
            let apart = (i as f64 - j as f64) * self.step / length;
            let nugget = if i == j { 1e-6 } else { 0.0 };
            size * size * ((-0.5 * apart * apart).exp() + nugget)
        })
    }

    /// The same over the process.
    fn integrated(&self) -> (f64, DVector<f64>) {
        over_processes(|process| self.given(&self.covariance(process)))
    }

    /// The means and the sd of mu and of the force in each cell, with a level
    /// in the force.
    fn whole(&self) -> (DVector<f64>, DVector<f64>) {
        let n = CELLS + 1;
        let cos = DEGREES.to_radians().cos();
        let times = self.adds.column_sum();
        let friction = -GRAVITY * cos * MU.1 * times;
        let given = |process: Process| {
            let level = process.size().powi(2);
            let covariance = self.covariance(process).add_scalar(level);
            // How mu and the force go together with the speeds.
            let mut across = DMatrix::zeros(n, self.off.len());
            across.set_row(0, &(MU.1 * friction.transpose()));
            let cells = &covariance * self.adds.transpose();
            across.rows_mut(1, CELLS).copy_from(&cells);
            let all = &self.known + &self.adds * &cells;
            let all = all.cholesky().unwrap();
            let mut mean = &across * all.solve(&self.off);
            mean[0] += MU.0;
            let told = &across * all.solve(&across.transpose());
            let mut before = covariance.diagonal().insert_row(0, 0.0);
            before[0] = MU.1 * MU.1;
            let squares = before - told.diagonal() + mean.component_mul(&mean);
            let mut moments = DVector::zeros(2 * n);
            moments.rows_mut(0, n).copy_from(&mean);
            moments.rows_mut(n, n).copy_from(&squares);
            (self.given(&covariance).0, moments)
        };
        let moments = over_processes(given).1;
        let mean = moments.rows(0, n).into_owned();
        let variance = moments.rows(n, n) - mean.component_mul(&mean);
        (mean, variance.map(f64::sqrt))
    }
}

/// The evidence and a mean over the process, from those at each, by the
/// rectangle rule: exact to far below what the draws allow.
fn over_processes(
    at: impl Fn(Process) -> (f64, DVector<f64>),
) -> (f64, DVector<f64>) {
    const STEP: f64 = 0.2;
    let nodes: Vec<f64> = (-20..=20).map(|i| STEP * f64::from(i)).collect();
    let mut found = Vec::new();
    for &length in &nodes {
        for &size in &nodes {
            let process = Process(length, size);
            let (log, mean) = at(process);
            let area = 2.0 * STEP.ln();
            found.push((log + process.log_prior() + area, mean));
        }
    }
    let total = log_sum_exp(found.iter().map(|(log, _)| *log));
    let zero = DVector::zeros(found[0].1.len());
    let mean = found
        .iter()
        .fold(zero, |sum, (log, mean)| sum + (log - total).exp() * mean);
    (total, mean)
}

#[test]
fn what_is_left_open_is_what_linear_algebra_says() {
    let program = pushed();
    let (mean, sd) = Linear::of(&program).whole();
    let none =
        fit(&program, &[], &LaplaceMixture::default(), Seed::new(1)).unwrap();
    let extent = program.0.extent();
    for seed in 1..=3 {
        let seed = Seed::new(seed);
        let force = locate(&program, &extent, Axis::Time, &none, seed);
        let force = [force.unwrap()];
        let open = left_open(&program, &extent, &force, seed.child(9));
        let open = open.unwrap().unwrap();
        let draws = open.own.pooled(0);
        let n = draws.len() as f64;
        let found = draws.iter().sum::<f64>() / n;
        let square = draws.iter().map(|mu| (mu - found).powi(2)).sum::<f64>();
        // 400 draws of weights that are worth a hundred at least: four
        // standard errors of a mean are 0.4 sd, of an sd 0.28 of it.
        let mut all = vec![(found, (square / n).sqrt())];
        let [Some(band)] = &open.bands[..] else {
            panic!("one axis, one band")
        };
        all.extend(band.mean.iter().copied().zip(band.sd.iter().copied()));
        for (i, (found, is)) in all.into_iter().enumerate() {
            let off = (found - mean[i]) / sd[i];
            assert!(off.abs() < 0.4, "seed {seed:?}, {i}: {off} sd");
            let ratio = is / sd[i];
            let near = (0.72..1.28).contains(&ratio);
            assert!(near, "seed {seed:?}, {i}: {ratio}");
        }
    }
}

#[test]
fn along_waves_a_tangent_is_that_of_the_cells() {
    seen(check_waves);
}

fn check_waves(sought: Sought<'_, '_>) {
    let (small, large) = (Process(0.3, -0.5), Process(0.3, 1.0));
    let waves = sought.basis(&large);
    let count = waves.factor.ncols();
    assert!(count < CELLS);
    let at = DVector::from_fn(count, |i, _| (0.4 * i as f64).sin());
    let force = &waves.factor * &at;
    let own = DVector::from_element(1, 0.2);
    let of = |basis: &Basis, at: &DVector<f64>| {
        sought.cells.tangent(basis, at, own.clone()).unwrap().unwrap()
    };
    let cells = of(&Basis::cells(CELLS, 1), &force);
    let along = of(&waves, &at);
    let by = large.size() / small.size();
    let scaled = cells.along(&sought.basis(&small)).scaled(by);
    // Elsewhere too, since they are the same to second order.
    let elsewhere = DVector::from_element(1, -0.4);
    let known = along.waves(&elsewhere).unwrap();
    for other in [cells.along(&waves), scaled] {
        let found = other.waves(&elsewhere).unwrap();
        // Sums of a few hundred products, of some hundreds of ln at most.
        assert!((found.mean - &known.mean).amax() < 1e-9);
        let off = other.height(&known) - along.height(&known);
        assert!(off.abs() < 1e-9, "{off}");
        let found = other.marginal(&known);
        let expected = along.marginal(&known);
        assert!((found.gradient - expected.gradient).amax() < 1e-8);
        assert!((found.precision - expected.precision).amax() < 1e-8);
    }
    // A height at no waves beside the best is the density there.
    let still = DVector::zeros(count);
    let none = of(&waves, &still);
    let log = sought.cells.log_density(&DVector::zeros(CELLS), own.as_slice());
    let precision = none.waves(&own).unwrap().precision;
    let half = half_log_det(&precision);
    let none = none.height(&Waves { mean: still, precision });
    assert!((none + half - log.unwrap()).abs() < 1e-9);
}

#[test]
fn on_an_even_slope_a_force_without_shape_is_a_friction() {
    seen(check_friction);
}

fn check_friction(sought: Sought<'_, '_>) {
    let looks = sought.looks(&[MU.0], COARSE).unwrap();
    let tangent = &highest(&looks).unwrap().tangent;
    let found = confounded::confounded(tangent, sought.extent).unwrap();
    assert_eq!(found.ncols(), 1);
    // But for the ridge that keeps it finite.
    let sign = found[0].signum();
    let off = found.iter().map(|f| (sign * f - 1.0).abs());
    assert!(off.fold(0.0, f64::max) < 1e-3, "{found}");
}

#[test]
fn the_free_force_is_what_linear_algebra_says() {
    let program = pushed();
    let linear = Linear::of(&program);
    let none =
        fit(&program, &[], &LaplaceMixture::default(), Seed::new(1)).unwrap();
    let (without, _) = linear.given(&DMatrix::zeros(CELLS, CELLS));
    // Four standard errors here and below.
    let off = none.log_evidence - without;
    assert!(off.abs() < 4.0 * none.se, "{off}");
    let (known, mean) = linear.integrated();
    let extent = program.0.extent();
    for seed in 1..=3 {
        let seed = Seed::new(seed);
        let found = locate(&program, &extent, Axis::Time, &none, seed);
        let found = found.unwrap();
        let off = none.log_evidence + found.log_bayes_factor - known;
        assert!(found.se < 0.15 && off.abs() < 4.0 * found.se, "{off}");
        for i in 0..CELLS {
            // The mean of at least a hundred draws, of which some are the
            // same.
            let Band { mean: found, sd, .. } = &found.band;
            let off = (found[i] - mean[i]).abs() / sd[i];
            assert!(off < 0.5, "cell {i}: {off} sd");
        }
    }
}

#[test]
fn where_no_force_has_a_density_none_is_left() {
    let program = pushed();
    let extent = program.0.extent();
    let mut none =
        fit(&program, &[], &LaplaceMixture::default(), Seed::new(1)).unwrap();
    none.best = vec![f64::NAN];
    let axes = [Axis::Place, Axis::Time];
    let all = locate_all(&program, &extent, &axes, &none, Seed::new(1));
    let said = all.unwrap_err().to_string();
    assert!(said.contains("no free-form force has a density"), "{said}");
    let rest = left(&program, &[], &none, &extent, Seed::new(1)).unwrap();
    assert!(rest.is_none());
}

#[test]
fn an_outlook_begins_at_the_best_place_and_asks_for_what_it_must_exceed() {
    let program = pushed();
    let extent = program.0.extent();
    // On the real line; the second has hardly a density.
    let owns = [vec![9.0], vec![0.33]];
    let of = |owns: &[Vec<f64>], least: f64| {
        outlook(&program, &extent, owns, least, Seed::new(2)).unwrap()
    };
    let none = f64::NEG_INFINITY;
    let good = of(&owns[1..], none).unwrap();
    let both = of(&owns, none).unwrap();
    assert_eq!((both.log, both.own), (good.log, good.own));
    assert!(of(&owns[1..], good.promised).is_none());
    assert!(of(&owns[1..], good.promised - 0.1).is_some());
    assert!(of(&[], none).is_none());
}
