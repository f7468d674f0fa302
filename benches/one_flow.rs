//! How long does one simulation take, exact and numerical?

#![allow(missing_docs)]

mod reference;

use criterion::{Criterion, criterion_group, criterion_main};

use couloir::physics::friction::{VelocityWeakening, Voellmy};
use couloir::physics::{Friction, sample};
use couloir::scalar::{Plain, Real};

fn slide(criterion: &mut Criterion, name: &str, law: &impl Friction<Plain>) {
    let event = reference::event();
    let times = event.velocity.times();
    criterion.bench_function(name, |b| {
        b.iter(|| {
            let mut sum = 0.0;
            let path = event.path();
            let visit = |s: couloir::physics::State<Plain>| {
                sum += s.speed.value();
            };
            let release = event.release();
            let done = sample(&path, law, release, times, true, visit);
            assert!(done.is_ok());
            sum
        });
    });
}

fn flows(criterion: &mut Criterion) {
    let number = Real::<Plain>::new;
    let voellmy = Voellmy { mu: number(0.32), xi: number(495.73) };
    slide(criterion, "flow, exact", &voellmy);
    let weakening =
        VelocityWeakening { mu: number(0.5), r: number(0.6), u0: number(8.0) };
    slide(criterion, "flow, Dormand-Prince", &weakening);
}

criterion_group!(benches, flows);
criterion_main!(benches);
