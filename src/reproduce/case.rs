//! Figures 4 to 7 and Table 6 on one series.

use super::experiment::{PRINTED, Priors, WIDE, Which, model};
use crate::calibrate::calibrate;
use crate::draws::{Draws, density, quantile};
use crate::error::{Error, Result};
use crate::infer::{Effort, MetropolisHastings, Quiet, infer};
use crate::model::{Assembled, Posterior};
use crate::observe::Event;
use crate::parallel;
use crate::report::CalibrationReport;
use crate::seed::Seed;

/// One series under both models.
#[derive(Debug, Clone)]
pub struct Case {
    /// M0 and M1, with everything that a calibration reports.
    pub reports: [CalibrationReport; 2],
    /// The mean of M1's median speed minus M0's over the first 240 m \[m/s\]:
    /// the paper's Delta1.
    pub delta1: f64,
    /// The root mean square of the same: Delta2.
    pub delta2: f64,
}

/// The paper's walk: three chains of 50 000 steps, the first half dropped.
const WALK: Effort = Effort { chains: 3, draws: 25_000, warmup: 25_000 };

/// The stretch over which medians are compared \[m\], as in the paper.
const STRETCH: f64 = 240.0;

pub(super) fn case(event: &Event, seed: u64) -> Result<Case> {
    let backend = MetropolisHastings::random_walk(&WALK);
    let places: Vec<f64> =
        (0..=120).map(|i| STRETCH * f64::from(i) / 120.0).collect();
    let mut reports = Vec::new();
    let mut medians = Vec::new();
    for which in Which::BOTH {
        let model = model(event.clone(), which, &WIDE)?;
        let found = calibrate(&model, &backend, seed, &Quiet)?;
        medians.push(median_speed(&model, &found.draws, &places));
        reports.push(found.report);
    }
    let apart: Vec<f64> =
        medians[1].iter().zip(&medians[0]).map(|(a, b)| a - b).collect();
    let mean = |f: fn(f64) -> f64| {
        apart.iter().map(|d| f(*d)).sum::<f64>() / apart.len() as f64
    };
    let [m0, m1] = [reports.swap_remove(0), reports.swap_remove(0)];
    Ok(Case {
        reports: [m0, m1],
        delta1: mean(|d| d),
        delta2: mean(|d| d * d).sqrt(),
    })
}

/// The posterior median of the speed at distances along the slope; 0 where
/// the mass never comes.
fn median_speed(model: &Assembled, draws: &Draws, places: &[f64]) -> Vec<f64> {
    let times: Vec<f64> = (0..=600).map(|i| 0.1 * f64::from(i)).collect();
    let speeds = parallel::map(draws.thinned(1000), |row| {
        let states = model.motion(row, &times).ok()?;
        let path: Vec<(f64, f64)> = states
            .iter()
            .map(|s| (s.distance.value(), s.speed.value()))
            .collect();
        let speeds = places.iter().map(|s| speed_at(&path, *s));
        Some(speeds.collect::<Vec<f64>>())
    });
    let speeds: Vec<_> = speeds.into_iter().flatten().collect();
    (0..places.len())
        .map(|i| {
            let mut column: Vec<f64> = speeds.iter().map(|s| s[i]).collect();
            column.sort_by(f64::total_cmp);
            quantile(&column, 0.5)
        })
        .collect()
}

/// The speed at a distance, linear between the path's points.
fn speed_at(path: &[(f64, f64)], place: f64) -> f64 {
    let next = path.partition_point(|(s, _)| *s <= place);
    match (next.checked_sub(1).map(|i| path[i]), path.get(next)) {
        (Some((s0, u0)), Some((s1, u1))) => {
            u0 + (u1 - u0) * (place - s0) / (s1 - s0)
        }
        (None, Some((_, u))) => *u,
        _ => 0.0,
    }
}

/// One row of Table 6 under one model.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// The paper's number of the set, 1 to 6.
    pub set: usize,
    /// The model.
    pub which: Which,
    /// The priors.
    pub priors: Priors,
    /// Name, 5 %, 50 % and 95 % quantile of each parameter.
    pub quantiles: Vec<(String, [f64; 3])>,
    /// The density of each parameter, for Figure 9.
    pub densities: Vec<Vec<(f64, f64)>>,
    /// The largest R-hat.
    pub rhat: f64,
}

/// The vague priors that the paper does not define.
const VAGUE: Priors = Priors {
    mu: "Uniform(0, 2)",
    xi: "Uniform(0, 20000)",
    sigma2: "Uniform(0, 1000)",
};

/// Table 6: which set is used with which model. Its set 6 names an inverse
/// gamma prior for xi, which belongs to sigma2's column: the text says that
/// xi's informative prior was kept throughout with M1.
fn sets() -> Vec<(usize, Which, Priors)> {
    use Which::{M0, M1};
    let one = PRINTED;
    let two = Priors { mu: VAGUE.mu, ..one };
    let three = Priors { xi: VAGUE.xi, ..one };
    let four = Priors { sigma2: VAGUE.sigma2, ..one };
    let six = Priors { xi: one.xi, ..VAGUE };
    vec![
        (1, M0, one),
        (2, M0, two),
        (3, M0, three),
        (4, M0, four),
        (5, M0, VAGUE),
        (1, M1, one),
        (2, M1, two),
        (4, M1, four),
        (6, M1, six),
    ]
}

pub(super) fn sensitivity(
    event: &Event,
    seed: Seed,
) -> Result<Vec<Sensitivity>> {
    let effort = Effort { chains: 2, draws: 20_000, warmup: 10_000 };
    parallel::try_map(sets(), |(set, which, priors)| {
        let model = model(event.clone(), which, &priors)?;
        let posterior = Posterior::new(&model)?;
        let walk = MetropolisHastings::adaptive(&effort);
        let seed = seed.child(set as u64).child(which as u64);
        let found = infer(&walk, &posterior, seed, &Quiet)?;
        let draws = found
            .draws
            .ok_or_else(|| Error::inference("the walk left no draws"))?;
        let summaries = found.summaries;
        Ok(Sensitivity {
            set,
            which,
            priors,
            quantiles: summaries
                .iter()
                .map(|s| (s.name.clone(), [s.q05, s.q50, s.q95]))
                .collect(),
            densities: (0..summaries.len())
                .map(|i| curve(&model, &draws, i))
                .collect(),
            rhat: summaries.iter().map(|s| s.rhat).fold(1.0, f64::max),
        })
    })
}

fn curve(
    model: &Assembled,
    draws: &Draws,
    parameter: usize,
) -> Vec<(f64, f64)> {
    let prior = model.priors().nth(parameter).map(|(_, prior)| *prior);
    let end =
        |p: f64| prior.and_then(|q| q.quantile(p)).filter(|x| x.is_finite());
    let support = crate::draws::Support { lower: end(0.0), upper: end(1.0) };
    density(&draws.pooled(parameter), support, 200)
        .map_or_else(Vec::new, |d| d.grid.into_iter().zip(d.density).collect())
}
