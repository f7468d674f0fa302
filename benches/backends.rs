//! How long does each backend take for the same effort?

#![allow(missing_docs)]

mod reference;

use criterion::{Criterion, criterion_group, criterion_main};

use couloir::Seed;
use couloir::infer::{BACKENDS, Effort, Quiet, infer};
use couloir::model::Posterior;

fn backends(criterion: &mut Criterion) {
    let model = reference::M1::new(reference::event());
    let effort = Effort::new().chains(4).draws(2_500).warmup(1_000);
    let mut group = criterion.benchmark_group("backend");
    group.sample_size(10);
    for entry in BACKENDS {
        let backend = (entry.make)(&effort);
        group.bench_function(entry.name, |b| {
            b.iter(|| {
                let posterior = Posterior::new(&model)?;
                infer(backend.as_ref(), &posterior, Seed::new(1), &Quiet)
            });
        });
    }
}

criterion_group!(benches, backends);
criterion_main!(benches);
