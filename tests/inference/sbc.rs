//! Simulation-based calibration of every backend that yields draws, on the
//! paper's two models, and of a likelihood that is wrong on purpose.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use couloir::block::{Block, Field};
use couloir::infer::{
    BACKENDS, Backend, Effort, MetropolisHastings, Quiet, backend,
};
use couloir::noise::{Conditional, Grid};
use couloir::prelude::*;
use couloir::sbc::{Ranks, ranks};
use couloir::scalar::Kind;
use couloir::seed::Rng;
use couloir::{Result, Stop};

model! {
    /// The paper's M0.
    struct Independent { event: Event }
    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

model! {
    /// The paper's M1.
    struct Correlated { event: Event }
    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Ar {
        phi: [Uniform(-1.0, 1.0)],
        sigma2: InverseGamma(3.0, 20.0),
    };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

model! {
    /// Smooth errors beside white ones.
    struct Smooth { event: Event }
    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Matern32 {
        sd_matern: LogNormal(0.5, 0.5),
        time_matern: LogNormal(0.7, 0.5),
    } + White { sigma2: InverseGamma(3.0, 2.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

model! {
    /// Errors with a memory, with heavy tails, that grow.
    struct Shaped { event: Event }
    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Ou { sd_ou: LogNormal(0.5, 0.5), time_ou: LogNormal(0.7, 0.5) }
        + White { sigma2: InverseGamma(3.0, 2.0) }
        + Tails { nu: Uniform(2.0, 20.0) }
        + Growth { growth: Normal(0.0, 1.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

/// AR(1) errors as in equation 7 but without its first term.
#[derive(Debug, Clone, Copy)]
struct Firstless<S> {
    phi: S,
    sigma2: S,
}

impl<S: Copy> Block<S> for Firstless<S> {
    const NAME: &'static str = "firstless";
    const FIELDS: &'static [Field] = &[
        Field::new("phi", "1", "Flat()"),
        Field::new("sigma2", "1", "Flat()"),
    ];

    fn from_values(values: &[S]) -> Self {
        Self { phi: values[0], sigma2: values[1] }
    }
}

impl<K: Kind> couloir::noise::Noise<K> for Firstless<Real<K>> {
    fn check(&self, _: &Grid) -> Result<()> {
        Ok(())
    }

    fn walk(
        &self,
        _: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        for (i, &r) in residuals.iter().enumerate() {
            let log_density = match i.checked_sub(1) {
                None => Real::new(0.0),
                Some(before) => {
                    let eta = r - self.phi * residuals[before];
                    -0.5 * (self.sigma2.ln() + eta * eta / self.sigma2)
                }
            };
            visit(Conditional::new(log_density, Real::new(0.0)));
        }
        Ok(())
    }

    fn draw(&self, _: &Grid, _: &mut Rng) -> Result<Vec<f64>, Stop> {
        Err(Stop::Reject("only a likelihood"))
    }
}

model! {
    struct Wrong { event: Event }
    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Firstless {
        phi: Uniform(-1.0, 1.0),
        sigma2: InverseGamma(3.0, 20.0),
    };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

/// A slope in three parts, long enough for any draw from the priors: the
/// reference's track ends where a fast mass of the prior's would go on.
fn event(step: f64, count: usize) -> Event {
    let x = [0.0, 150.0, 350.0, 5000.0];
    let z = [0.0, -115.0, -230.0, -1800.0];
    let times: Vec<f64> = (1..=count).map(|i| step * i as f64).collect();
    Event::on(Track::from_points(&x, &z).unwrap())
        .depth(2.19)
        .velocity(Series::velocity(times, vec![0.0; count]).unwrap())
        .build()
        .unwrap()
}

/// Which model is calibrated on what it simulates.
#[derive(Debug, Clone, Copy)]
enum Case {
    Independent,
    Correlated,
    Smooth,
    Shaped,
    /// Simulated by the correlated model.
    Wrong,
}

fn ranked(
    case: Case,
    event: &Event,
    backend: &dyn Backend,
    count: usize,
) -> Ranks {
    let right = |event: Event| -> Box<dyn Model> {
        match case {
            Case::Independent => Box::new(Independent::new(event)),
            Case::Smooth => Box::new(Smooth::new(event)),
            Case::Shaped => Box::new(Shaped::new(event)),
            Case::Correlated | Case::Wrong => Box::new(Correlated::new(event)),
        }
    };
    let remade =
        |seen: &[Series]| Ok(right(event.with_recording(seen[0].clone())?));
    let fitted = |seen: &[Series]| -> Result<Box<dyn Model>> {
        match case {
            Case::Wrong => {
                let event = event.with_recording(seen[0].clone())?;
                Ok(Box::new(Wrong::new(event)))
            }
            _ => remade(seen),
        }
    };
    let model = right(event.clone());
    let seed = Seed::new(2020);
    ranks(model.as_ref(), [&remade, &fitted], backend, count, seed, &Quiet)
        .unwrap()
}

const REPLICATIONS: usize = 200;

/// Enough that 99 draws kept of a chain are next to independent.
const EFFORT: Effort = Effort::new().chains(1).draws(12_000).warmup(3000);
/// The same of a backend whose draws are nearly independent already.
const LIGHT: Effort = Effort::new().chains(1).draws(1000).warmup(500);

fn effort(name: &str) -> &'static Effort {
    match name {
        "mh" | "random-walk" | "bridge" | "reciprocal" => &EFFORT,
        _ => &LIGHT,
    }
}

#[test]
#[ignore = "slow: `cargo slow`"]
fn every_backend_is_calibrated() {
    // Evidence from chains, grids and modes bring no draws of their own.
    let without = ["map", "quadrature", "reciprocal", "bridge"];
    let names: Vec<&str> = BACKENDS
        .iter()
        .map(|entry| entry.name)
        .filter(|name| !without.contains(name))
        .collect();
    let mut found = Vec::new();
    for name in names {
        for case in [Case::Independent, Case::Correlated] {
            let backend = backend(name, effort(name)).unwrap();
            let ranks =
                ranked(case, &event(1.0, 21), backend.as_ref(), REPLICATIONS);
            for (i, parameter) in ranks.names.iter().enumerate() {
                let (p, counts) = (ranks.p(i), ranks.histogram(i));
                println!("{name} {case:?} {parameter} p {p:.4} {counts:?}");
                found.push((name, parameter.clone(), p));
            }
        }
    }
    all_even(&found);
}

#[test]
#[ignore = "slow: `cargo slow`"]
fn sums_of_noises_are_calibrated() {
    let mut found = Vec::new();
    for name in ["mh", "laplace-mixture"] {
        for case in [Case::Smooth, Case::Shaped] {
            let backend = backend(name, effort(name)).unwrap();
            // Denser than their memory lasts.
            let event = event(0.5, 41);
            let ranks = ranked(case, &event, backend.as_ref(), REPLICATIONS);
            for (i, parameter) in ranks.names.iter().enumerate() {
                let (p, counts) = (ranks.p(i), ranks.histogram(i));
                println!("{name} {case:?} {parameter} p {p:.4} {counts:?}");
                found.push((name, parameter.clone(), p));
            }
        }
    }
    all_even(&found);
}

/// Whether all ranks are even, by Bonferroni's bound.
fn all_even(found: &[(&str, String, f64)]) {
    let limit = 0.001 / found.len() as f64;
    for (name, parameter, p) in found {
        assert!(*p > limit, "{name} {parameter}: p = {p}");
    }
}

#[test]
#[ignore = "slow: `cargo slow`"]
fn a_likelihood_without_its_first_term_is_caught() {
    let backend = MetropolisHastings::adaptive(&EFFORT);
    // In five values the first is a good part of what there is to know.
    let event = event(4.0, 5);
    let ranks = ranked(Case::Wrong, &event, &backend, 5 * REPLICATIONS);
    let p: Vec<f64> = (0..ranks.names.len()).map(|i| ranks.p(i)).collect();
    for (i, name) in ranks.names.iter().enumerate() {
        println!("{name} p {:.2e} {:?}", p[i], ranks.histogram(i));
    }
    let least = p.iter().copied().fold(1.0, f64::min);
    assert!(least < 0.001 / p.len() as f64, "{p:?}");
}
