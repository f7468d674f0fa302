//! Simulation-based calibration of model choice: recordings drawn from models
//! by their prior odds, and what the diagnosis' engine says of them. A study
//! of a thousand is `examples/14_sbc_of_models.rs`.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use couloir::mechanism::catalogue::catalogue;
use couloir::model::declared_blocks;
use couloir::prelude::*;
use couloir::sbc::choices;

model! {
    struct Dry { event: Event }
    friction ~ Coulomb { mu: Gamma(100.0, 0.003) };
    errors ~ Iid { sigma2: InverseGamma(5.0, 16.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

/// A slope in three parts that no draw runs beyond, with the speeds of a mass
/// with a friction of 0.3: what the mechanisms' priors are scaled to.
fn plan() -> Event {
    let x = [0.0, 200.0, 500.0, 5000.0];
    let z = [0.0, -140.0, -260.0, -1160.0];
    let times: Vec<f64> = (1..=30).map(f64::from).collect();
    let event = Event::on(Track::from_points(&x, &z).unwrap())
        .velocity(Series::velocity(times, vec![0.0; 30]).unwrap())
        .build()
        .unwrap();
    let model = Dry::new(event.clone());
    let typical = simulate(&model, &[0.3, 0.01], Seed::new(1)).unwrap();
    event.with_recording(typical[0].clone()).unwrap()
}

#[test]
fn the_probabilities_of_models_are_calibrated() {
    let event = plan();
    let program = Dry::new(event.clone());
    let blocks = declared_blocks(&program).unwrap();
    let mut all = catalogue(&event.extent(), &blocks);
    let names = ["friction-step", "cohesion", "clock-offset"];
    all.retain(|mechanism| names.contains(&mechanism.name()));
    let remade =
        |seen: &[Series]| Ok(Dry::new(event.with_recording(seen[0].clone())?));
    let found =
        choices(&program, &remade, &all, 60, Seed::new(20), &Quiet).unwrap();
    // Half for the model as it is, half shared by the names.
    for (name, prior) in found.names.iter().zip(&found.prior) {
        let expected = if name == "none" { 0.5 } else { 1.0 / 6.0 };
        assert!((prior - expected).abs() < 1e-12, "{name}: {prior}");
    }
    // Every draw has a flow, so that these are the odds of the draws too.
    assert!(found.cases.iter().all(|case| case.redrawn == 0));
    // Some of the dozen figures exceeds 4 in one of 1300 runs that are right.
    let z = found.largest_z();
    assert!(z < 4.0, "{z}: {found:?}");
    // A tenfold evidence is more than 60 recordings can hide.
    let i = found.names.iter().position(|n| n == "clock-offset").unwrap();
    let wrong = found.with_error(i, 10.0);
    assert!(wrong.share(i).z() < -4.0, "{}", wrong.share(i).z());
}
