//! How long do a log density of 400 values and its information take, by noise?

#![allow(missing_docs)]

use std::collections::BTreeMap;

use criterion::{Criterion, criterion_group, criterion_main};

use couloir::model::{Assembled, Model, Point, Posterior};
use couloir::noise::parse;
use couloir::prelude::*;

/// 400 speeds at ten a second, synthetic: 35 degrees, with a slow and a quick
/// wave for errors.
fn model(noise: &str) -> Result<Assembled> {
    let times: Vec<f64> = (1..=400).map(|i| 0.1 * f64::from(i)).collect();
    let speed = |t: &f64| {
        25.0 * (0.1 * t).tanh() + 0.5 * (0.4 * t).sin() + 0.1 * (7.0 * t).cos()
    };
    let speeds = times.iter().map(speed).collect();
    let (x, z): (Vec<f64>, Vec<f64>) = (0..200)
        .map(|i| 10.0 * f64::from(i))
        .map(|x| (x, -0.5 * x + 6.0 * (0.02 * x).sin()))
        .unzip();
    let event = Event::on(Track::from_points(&x, &z)?)
        .velocity(Series::velocity(times, speeds)?)
        .build()?;
    let law = Laws::default().parse("voellmy")?;
    Assembled::new(event, law, parse(noise)?, &BTreeMap::new())
}

fn densities(criterion: &mut Criterion) {
    let noises = [
        "iid",
        "ar(1)",
        "ou + white",
        "matern32 + white",
        "matern32 + ou",
        "matern32 + ou + tails",
    ];
    for noise in noises {
        let Ok(model) = model(noise) else { continue };
        let model: &dyn Model = &model;
        let Ok(posterior) = Posterior::new(model) else { continue };
        let value = |name: &str| match name {
            "mu" => 0.3,
            "xi" => 1000.0,
            "phi" => 0.7,
            _ => 0.5,
        };
        let names = posterior.parameters().iter();
        let natural: Vec<f64> = names.map(|p| value(&p.name)).collect();
        let Ok(z) = posterior.line(&natural) else { continue };
        criterion.bench_function(noise, |b| {
            b.iter(|| model.evaluate(Point::Line(&z), None));
        });
        criterion.bench_function(&format!("{noise}, information"), |b| {
            b.iter(|| model.information(&z));
        });
    }
}

criterion_group!(benches, densities);
criterion_main!(benches);
