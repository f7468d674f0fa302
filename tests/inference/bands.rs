//! Bands hold as many recordings as they say. Series are drawn apart from
//! those that the bands are made of, and counted.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use couloir::draws::Draws;
use couloir::predict::{Bands, posterior_predictive, prior_predictive};
use couloir::prelude::*;

model! {
    struct Dry { event: Event }
    friction ~ Coulomb { mu: Uniform(0.2, 0.5) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 4.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

/// Errors matter most at the first of these times, the friction at the last.
const TIMES: [f64; 3] = [0.5, 3.0, 12.0];

/// Draws that a band is made of, and series that it is held against.
const COUNT: u64 = 2000;

/// Of the share inside: its own binomial error and the band's, which is the
/// same, four times over. A band from 10 to 90 % holds 0.8.
const TOLERANCE: f64 = 4.0 * 0.0095;

fn model() -> Dry {
    let series = Series::velocity(TIMES.to_vec(), vec![0.0; 3]).unwrap();
    let track = Track::incline(40.0, 2000.0).unwrap();
    Dry::new(Event::on(track).velocity(series).build().unwrap())
}

/// Values of the parameters by the prior, and what the flow is with them.
fn drawn(posterior: &Posterior<'_>, seed: Seed) -> (Vec<f64>, Vec<f64>) {
    let (_, all) = posterior.draw_prior(&mut seed.rng()).unwrap();
    (all.natural, all.predictions[0].clone())
}

fn hold(bands: &Bands, model: &Dry, posterior: &Posterior<'_>) {
    let (mut of_flow, mut of_full) = ([0.0; 3], [0.0; 3]);
    for i in 0..COUNT {
        let seed = Seed::new(2).child(i);
        let (values, flow) = drawn(posterior, seed.child(0));
        let made = simulate(model, &values, seed.child(1)).unwrap();
        let seen = made[0].values();
        for t in 0..TIMES.len() {
            let flows = bands.flow_low[t]..=bands.flow_high[t];
            let full = bands.full_low[t]..=bands.full_high[t];
            of_flow[t] += f64::from(u8::from(flows.contains(&flow[t])));
            of_full[t] += f64::from(u8::from(full.contains(&seen[t])));
        }
    }
    for share in of_flow.into_iter().chain(of_full) {
        let share = share / COUNT as f64;
        assert!((share - 0.9).abs() < TOLERANCE, "{of_flow:?} {of_full:?}");
    }
}

#[test]
fn a_band_before_any_recording_holds_nine_series_of_ten() {
    let model = model();
    let posterior = Posterior::new(&model).unwrap();
    let count = COUNT as usize;
    let bands = prior_predictive(&posterior, count, &TIMES, Seed::new(1));
    hold(&bands.unwrap(), &model, &posterior);
}

/// The draws are of the prior, so that the same series are expected.
#[test]
fn a_band_made_of_draws_holds_nine_series_of_ten() {
    let model = model();
    let posterior = Posterior::new(&model).unwrap();
    let parameters = posterior.parameters().iter();
    let (names, units) =
        parameters.map(|p| (p.name.clone(), p.unit.clone())).unzip();
    let rows = (0..COUNT)
        .flat_map(|i| drawn(&posterior, Seed::new(3).child(i)).0)
        .collect();
    let mut draws = Draws::new(names, units).unwrap();
    draws.push_chain(rows, None).unwrap();
    let seed = Seed::new(4);
    let bands = posterior_predictive(&posterior, &draws, &TIMES, seed);
    hold(&bands.unwrap(), &model, &posterior);
}
