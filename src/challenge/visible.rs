//! How much of a hidden effect a recording shows at all.

use std::f64::consts::TAU;

use super::effects::Nothing;
use super::errors::Instrument;
use super::ground::Ground;
use super::moments::Start;
use super::motion::{Law, slide};

/// The time step of the search \[s\]: steps end on every border, so that
/// these are as good as the noise asks for.
const STEP: f64 = 0.05;

/// What one recording of a case shows.
pub(super) struct Shown {
    /// Where the mass is said to start \[m\].
    pub(super) from: f64,
    /// \[s\].
    pub(super) times: Vec<f64>,
    /// \[m/s\].
    pub(super) values: Vec<f64>,
}

/// The greatest log likelihood that the baseline reaches, over its friction
/// parameters and the variance of independent normal errors.
pub(super) fn baseline(ground: &Ground, law: &Law, all: &[Shown]) -> f64 {
    let squares = |law: &Law| -> f64 {
        let misfit = |e: Vec<f64>| e.iter().map(|e| e * e).sum::<f64>();
        all.iter().map(|shown| misfit(left(ground, law, shown))).sum()
    };
    let least = least(law, &squares);
    let count: usize = all.iter().map(|shown| shown.values.len()).sum();
    let n = count as f64;
    -0.5 * n * ((TAU * least / n).ln() + 1.0)
}

/// The same over its friction parameters alone, with errors as they were
/// drawn.
pub(super) fn baseline_under(
    ground: &Ground,
    law: &Law,
    all: &[Shown],
    real: Instrument,
) -> f64 {
    let recorders: Vec<_> = all.iter().map(|s| real.at(&s.times)).collect();
    let lacking = |law: &Law| -> f64 {
        let pairs = all.iter().zip(&recorders);
        pairs.map(|(s, r)| -r.log_density(&left(ground, law, s))).sum()
    };
    -least(law, &lacking)
}

/// The least value over a law's parameters.
fn least(law: &Law, of: &impl Fn(&Law) -> f64) -> f64 {
    let with = |p: [f64; 2]| match *law {
        Law::Coulomb { .. } => Law::Coulomb { mu: p[0].abs() },
        Law::Voellmy { depth, .. } => {
            Law::Voellmy { mu: p[0].abs(), xi: p[1].exp(), depth }
        }
    };
    let of = |p: [f64; 2]| of(&with(p));
    match law {
        Law::Coulomb { .. } => search(&of, [0.05, 0.0]),
        Law::Voellmy { .. } => search(&of, [0.05, 0.5]),
    }
}

/// What a motion leaves of a recording \[m/s\].
fn left(ground: &Ground, law: &Law, shown: &Shown) -> Vec<f64> {
    let start = Start { place: shown.from, speed: 0.0 };
    let until = shown.times.iter().copied().fold(0.0, f64::max) + STEP;
    let run = slide(ground, law, &Nothing, start, until, STEP);
    let pairs = shown.times.iter().zip(&shown.values);
    pairs.map(|(t, v)| v - run.speed(*t)).collect()
}

/// The eight ways from a place; the first two leave ln xi as it is.
const WAYS: [(f64, f64); 8] = [
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, 1.0),
    (0.0, -1.0),
    (0.7, 0.7),
    (-0.7, -0.7),
    (0.7, -0.7),
    (-0.7, 0.7),
];

/// The least value over mu and ln xi: from the best of a grid, along eight
/// ways in strides that are halved where none helps. Where ln xi has a stride
/// of 0, it is not searched.
fn search(of: &impl Fn([f64; 2]) -> f64, mut stride: [f64; 2]) -> f64 {
    let both = stride[1] > 0.0;
    let ways = if both { &WAYS[..] } else { &WAYS[..2] };
    let mut best = grid(of, both);
    while stride[0] > 1e-5 {
        let (from, least) = best;
        let better = ways.iter().find_map(|(a, b)| {
            let p = [from[0] + a * stride[0], from[1] + b * stride[1]];
            let value = of(p);
            (value < least).then_some((p, value))
        });
        match better {
            Some(found) => best = found,
            None => stride = stride.map(|x| 0.5 * x),
        }
    }
    best.1
}

/// The best of a coarse grid, with its value.
fn grid(of: &impl Fn([f64; 2]) -> f64, both: bool) -> ([f64; 2], f64) {
    let levels: &[f64] = if both { &[6.0, 7.0, 8.0] } else { &[7.0] };
    let mut best = ([0.3, 7.0], f64::INFINITY);
    for mu in [0.05, 0.15, 0.25, 0.35, 0.45, 0.55] {
        for level in levels {
            let p = [mu, *level];
            let value = of(p);
            if value < best.1 {
                best = (p, value);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::challenge::ground::Shape;
    use crate::seed::Seed;

    #[test]
    fn the_search_finds_the_parameters() {
        let ground = Ground::draw(Shape::Bends, &mut Seed::new(3).rng());
        let depth = 2.0;
        for law in [
            Law::Coulomb { mu: 0.31 },
            Law::Voellmy { mu: 0.27, xi: 900.0, depth },
        ] {
            let start = Start { place: 30.0, speed: 0.0 };
            let run = slide(&ground, &law, &Nothing, start, 12.0, 4e-3);
            let times: Vec<f64> =
                (1..80).map(|i| 0.1 * f64::from(i)).collect();
            let values = times.iter().map(|t| run.speed(*t)).collect();
            let shown = Shown { from: 30.0, times, values };
            let level = baseline(&ground, &law, &[shown]);
            // A root mean square of 1 cm/s would give 252.
            assert!(level > 252.0, "{law:?} {level}");
        }
    }
}
