//! Calibration from a thinned recording: the truth comes back.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::collections::BTreeMap;

use couloir::diagnosis::fit;
use couloir::infer::LaplaceMixture;
use couloir::model::Assembled;
use couloir::noise;
use couloir::observe::Thinning;
use couloir::physics::friction::{Laws, Voellmy};
use couloir::physics::{Track, sample};
use couloir::scalar::{Plain, Real};
use couloir::{Event, Seed, Series};
use rand_distr::{Distribution, StandardNormal};

const MU: f64 = 0.25;
const XI: f64 = 1200.0;
const SD: f64 = 0.5;

/// Speeds of an avalanche, 25 a second, with independent errors.
fn fine() -> Event {
    let x: Vec<f64> = (0..=50).map(|i| 20.0 * f64::from(i)).collect();
    let z: Vec<f64> =
        x.iter().map(|x| 0.0004 * (1300.0 - x).powi(2)).collect();
    let track = Track::from_points(&x, &z).unwrap();
    let times: Vec<f64> = (1..=750).map(|i| 0.04 * f64::from(i)).collect();
    let event = Event::on(track).depth(1.5).build().unwrap();
    let law = Voellmy::<Real> { mu: MU.into(), xi: XI.into() };
    let mut rng = Seed::new(6).rng();
    let mut speeds = Vec::new();
    let (path, release) = (event.path(), event.release::<Plain>());
    sample(&path, &law, release, &times, true, |state| {
        let z: f64 = StandardNormal.sample(&mut rng);
        speeds.push(state.speed.value() + SD * z);
    })
    .unwrap();
    event.with_recording(Series::velocity(times, speeds).unwrap()).unwrap()
}

/// Mean and standard deviation of mu, xi and sigma2.
fn calibrated(event: Event) -> Vec<[f64; 2]> {
    let friction = Laws::default().parse("voellmy").unwrap();
    let white = noise::parse("iid").unwrap();
    let priors = BTreeMap::new();
    let model = Assembled::new(event, friction, white, &priors).unwrap();
    let seed = Seed::new(3);
    let found = fit(&model, &[], &LaplaceMixture::default(), seed).unwrap();
    let columns = couloir::draws::summarise(&found.draws);
    columns.iter().map(|c| [c.mean, c.sd]).collect()
}

#[test]
fn averages_give_the_truth_and_its_uncertainty_back() {
    let fine = fine();
    let all = calibrated(fine.clone());
    let (thin, said) = fine.thinned(1.0, Thinning::Average).unwrap();
    assert_eq!(thin.velocity.len(), 30);
    let text = said[0].to_string();
    assert!(text.contains("750 values, 25 a second, to 30"), "{text}");
    let means = calibrated(thin.clone());
    for (truth, [mean, sd]) in [MU, XI].into_iter().zip(&means) {
        assert!((mean - truth).abs() < 3.0 * sd, "{mean} {sd} {truth}");
    }
    for (a, b) in all.iter().zip(&means).take(2) {
        // Independent errors lose nothing by it; thirty values tell the size
        // of the errors to an eighth.
        assert!((a[0] - b[0]).abs() < a[1], "{a:?} {b:?}");
        assert!((0.7..1.4).contains(&(b[1] / a[1])), "{a:?} {b:?}");
    }
    // The variance of means of 25.
    let [variance, sd] = means[2];
    assert!((variance - SD * SD / 25.0).abs() < 4.0 * sd, "{variance} {sd}");

    // As speeds of a moment, at the ends of their bins, they mislead.
    let moments = thin.velocity.clone().with_window(0.0).unwrap();
    let wrong = calibrated(thin.with_recording(moments).unwrap());
    let far = [MU, XI].into_iter().zip(&wrong);
    let far = far.map(|(truth, [mean, sd])| (mean - truth).abs() / sd);
    assert!(far.fold(0.0, f64::max) > 4.0, "{wrong:?}");
}

#[test]
fn picked_values_give_the_truth_back_with_less_certainty() {
    let fine = fine();
    let all = calibrated(fine.clone());
    let (thin, _) = fine.thinned(1.0, Thinning::Pick).unwrap();
    let few = calibrated(thin);
    for (truth, [mean, sd]) in [MU, XI].into_iter().zip(&few) {
        assert!((mean - truth).abs() < 3.5 * sd, "{mean} {sd} {truth}");
    }
    // A twenty-fifth of the values: five times the uncertainty, as far as
    // priors let it.
    assert!(few[0][1] > 2.0 * all[0][1], "{few:?} {all:?}");
}
