//! How long does one log density take, and one gradient?

#![allow(missing_docs)]

mod reference;

use criterion::{Criterion, criterion_group, criterion_main};

use couloir::model::{Model, Point, Posterior, Weights};

fn densities(criterion: &mut Criterion) {
    let model = reference::M1::new(reference::event());
    let model: &dyn Model = &model;
    let z = Posterior::new(model)
        .and_then(|posterior| posterior.line(&reference::MIDDLE))
        .unwrap_or_default();
    criterion.bench_function("log density", |b| {
        b.iter(|| model.evaluate(Point::Line(&z), None));
    });
    let mut gradient = [0.0; 4];
    criterion.bench_function("gradient", |b| {
        b.iter(|| model.gradient(&z, Weights::LINE, &mut gradient));
    });
}

criterion_group!(benches, densities);
criterion_main!(benches);
