//! A population from its members' posteriors, against sums over a grid where
//! everything is normal.

use couloir::draws::Draws;
use couloir::population::{Member, Population, pool};
use couloir::prelude::*;
use couloir::prior::AnyPrior;
use couloir::rand::RngExt;
use couloir::rand_distr::StandardNormal;
use statrs::function::erf::erfc;
use std::sync::LazyLock;

/// What was measured of each member, with errors of standard deviation 1.
const SEEN: [f64; 12] =
    [2.1, -0.4, 3.3, 1.0, 0.2, 1.9, 4.6, 0.8, -1.7, 2.7, 1.4, 3.0];

/// The prior of each alone, normal; `pool` makes of it those of the
/// population's mean and of its spread.
const CENTRE: f64 = 1.0;
const WIDTH: f64 = 2.0;

/// Members whose posteriors are drawn from exactly.
fn members(seen: &[f64], draws: usize) -> Vec<Member> {
    let share = WIDTH * WIDTH / (WIDTH * WIDTH + 1.0);
    let mut rng = Seed::new(7).rng();
    seen.iter()
        .map(|seen| {
            let mean = CENTRE + share * (seen - CENTRE);
            let one = |_| {
                let z: f64 = rng.sample(StandardNormal);
                mean + share.sqrt() * z
            };
            let rows = (0..draws).map(one).collect();
            let (names, units) = (vec!["a".to_owned()], vec!["m".to_owned()]);
            let mut draws = Draws::new(names, units).unwrap();
            draws.push_chain(rows, None).unwrap();
            let priors = vec![AnyPrior::parse("Normal(1, 2)").unwrap()];
            Member { name: format!("{seen}"), draws, priors }
        })
        .collect()
}

static EXACT: LazyLock<Vec<(f64, f64, f64)>> = LazyLock::new(exact);

/// The posterior of mean and spread on a grid: the members' own values are
/// integrated out by hand.
fn exact() -> Vec<(f64, f64, f64)> {
    let mut grid = Vec::new();
    for i in 0..400 {
        for j in 0..400 {
            let mean = -3.0 + 8.0 * (f64::from(i) + 0.5) / 400.0;
            let spread = 8.0 * (f64::from(j) + 0.5) / 400.0;
            let variance = spread * spread + 1.0;
            let z = ((mean - CENTRE) / WIDTH).powi(2);
            let mut log = -0.5 * (z + (spread / WIDTH).powi(2));
            for seen in SEEN {
                log -=
                    0.5 * ((seen - mean).powi(2) / variance + variance.ln());
            }
            grid.push((mean, spread, log.exp()));
        }
    }
    let total: f64 = grid.iter().map(|(_, _, weight)| weight).sum();
    grid.iter_mut().for_each(|(_, _, weight)| *weight /= total);
    grid
}

/// A mean and a standard deviation over the grid.
fn moments(of: impl Fn(f64, f64) -> f64) -> (f64, f64) {
    let grid = &*EXACT;
    let mean = grid.iter().map(|(m, s, w)| w * of(*m, *s)).sum::<f64>();
    let square = |(m, s, w): &(f64, f64, f64)| w * (of(*m, *s) - mean).powi(2);
    (mean, grid.iter().map(square).sum::<f64>().sqrt())
}

/// The population of [`SEEN`], which two tests look at.
static POOLED: LazyLock<Population> = LazyLock::new(|| pooled(&SEEN, 4000));

fn pooled(seen: &[f64], draws: usize) -> Population {
    pool(&members(seen, draws), Seed::new(3), &Quiet).unwrap()
}

/// The walk's figures are worth some 1000 draws (0.03 of a standard
/// deviation), and the members' 4000 draws leave as much: four times both
/// together is 0.17.
#[test]
fn mean_and_spread_are_those_of_the_grid() {
    let found = &*POOLED;
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let summaries = couloir::draws::summarise(&found.draws);
    let exact = [moments(|m, _| m), moments(|_, s| s)];
    for (found, (mean, sd)) in summaries.iter().zip(exact) {
        let apart = (found.mean - mean) / sd;
        assert!(apart.abs() < 0.17, "{}: {apart}", found.name);
        assert!((found.sd / sd - 1.0).abs() < 0.17, "{}", found.name);
    }
    let errors = found.parameters[0].errors;
    assert!(errors.iter().all(|error| *error < 0.17), "{errors:?}");
}

/// The probability that a member is below `x`, all members given: normal
/// given mean and spread, averaged over the grid.
fn below(seen: f64, x: f64) -> f64 {
    let of = |(m, s, weight): &(f64, f64, f64)| {
        let share = s * s / (s * s + 1.0);
        let z = (x - m - share * (seen - m)) / share.sqrt();
        weight * 0.5 * erfc(-z / std::f64::consts::SQRT_2)
    };
    EXACT.iter().map(of).sum()
}

/// The weights leave some 1000 draws: a probability of 0.5 is known to 0.016,
/// one of 0.05 to 0.007, and 200 draws of the population add as much. Four
/// times both.
#[test]
fn members_are_where_the_grid_has_them() {
    let found = &*POOLED;
    for (seen, member) in SEEN.iter().zip(&found.members) {
        let [low, half, high] = member.pooled[0];
        for (x, level, error) in
            [(low, 0.05, 0.04), (half, 0.5, 0.09), (high, 0.95, 0.04)]
        {
            let exact = below(*seen, x);
            assert!(
                (exact - level).abs() < error,
                "{seen} at {level}: {exact}"
            );
        }
    }
}

#[test]
fn few_draws_beside_a_narrow_population_are_told() {
    let found = pooled(&[1.0, 1.01, 0.99, 1.0, 0.98, 1.02, 9.0], 40);
    let said = found.warnings.join(" ");
    assert!(said.contains("9 first"), "{said}");
}

#[test]
fn members_that_do_not_go_together_are_refused() {
    let mut all = members(&SEEN, 40);
    let refusal = |members: &[Member]| {
        let found = pool(members, Seed::new(1), &Quiet);
        let error = found.unwrap_err();
        assert!(error.is_input());
        error.to_string()
    };
    assert!(refusal(&all[..1]).contains("expected 2 or more"));
    all[3].priors = vec![AnyPrior::Flat()];
    assert!(refusal(&all).contains("improper"));
    all[3] = members(&SEEN[3..4], 10).remove(0);
    assert!(refusal(&all).contains("10 draws"));
    let mut draws = Draws::new(vec!["b".into()], vec!["1".into()]).unwrap();
    draws.push_chain(vec![0.5; 40], None).unwrap();
    all[3].draws = draws;
    assert!(refusal(&all).contains("same law"));
}
