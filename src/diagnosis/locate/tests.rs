//! A force over time on an even slope, where every speed is linear in the
//! friction and the force, against linear algebra.

use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};

use super::*;
use crate::diagnosis::evidence::fit::fit;
use crate::draws::log_sum_exp;
use crate::error::Outcome;
use crate::infer::LaplaceMixture;
use crate::model::{Label, Number, Run};
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

    /// The same over the process, by the rectangle rule: exact to far below
    /// what the draws allow.
    fn integrated(&self) -> (f64, DVector<f64>) {
        const STEP: f64 = 0.2;
        let nodes: Vec<f64> =
            (-20..=20).map(|i| STEP * f64::from(i)).collect();
        let mut found = Vec::new();
        for &length in &nodes {
            for &size in &nodes {
                let process = Process(length, size);
                let (log, mean) = self.given(&self.covariance(process));
                let area = 2.0 * STEP.ln();
                found.push((log + process.log_prior() + area, mean));
            }
        }
        let total = log_sum_exp(found.iter().map(|(log, _)| *log));
        let zero = DVector::zeros(CELLS);
        let mean = found
            .iter()
            .fold(zero, |sum, (log, mean)| sum + (log - total).exp() * mean);
        (total, mean)
    }
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
            let off = (found.mean[i] - mean[i]).abs() / found.sd[i];
            assert!(off < 0.5, "cell {i}: {off} sd");
        }
    }
}
