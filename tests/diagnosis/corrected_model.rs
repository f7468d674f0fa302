//! The corrected model that a diagnosis prints compiles as it is, and has the
//! evidence that the diagnosis says; calibrated again, it converges and has the
//! parameters that the diagnosis says.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::collections::BTreeMap;
use std::f64::consts::LN_10;
use std::sync::OnceLock;

use couloir::calibrate::{Calibration, calibrate};
use couloir::diagnosis::{self, Diagnosis, Options, diagnose};
use couloir::draws::summarise;
use couloir::infer::{Effort, suited};
use couloir::mechanism::catalogue::find;
use couloir::model::Assembled;
use couloir::noise;
use couloir::prelude::*;
use couloir::prior::AnyPrior;

/// A file with the text as printed.
const PRINTED: &str = include_str!("../data/corrected/model.rs");

mod printed {
    include!("../data/corrected/model.rs");

    pub(crate) fn of(event: couloir::Event) -> Result<Option<Evidence>> {
        evidence(event)
    }
}

model! {
    struct Slide { event: Event }
    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 0.02) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

/// 30 synthetic speeds under Voellmy's law with errors of 0.1 m/s.
fn event() -> Event {
    let times: Vec<f64> = (1..=30).map(|i| 0.5 * f64::from(i)).collect();
    let blank = Series::velocity(times, vec![0.0; 30]).unwrap();
    let track = Track::incline(30.0, 900.0).unwrap();
    let event = Event::on(track).named("a slope (synthetic)").velocity(blank);
    let plan = Slide::new(event.build().unwrap());
    let truth = [0.25, 1500.0, 0.01];
    let seen = simulate(&plan, &truth, Seed::new(1)).unwrap();
    plan.event.with_recording(seen[0].clone()).unwrap()
}

/// Coulomb's law with mechanisms.
fn coulomb(event: Event, labels: &[&str]) -> Assembled {
    let laws = Laws::default().parse("coulomb").unwrap();
    let prior = |text| AnyPrior::parse(text).unwrap();
    let priors = BTreeMap::from([
        ("mu".to_owned(), prior("Gamma(9, 0.03)")),
        ("sigma2".to_owned(), prior("InverseGamma(3, 0.02)")),
    ]);
    let iid = noise::parse("iid").unwrap();
    let extent = event.extent();
    let model = Assembled::new(event, laws, iid, &priors).unwrap();
    let blocks = model.blocks();
    let found = labels.iter().map(|l| find(l, &extent, &blocks).unwrap());
    model.with_mechanisms(found.collect(), &priors).unwrap()
}

/// What is said of those speeds with Coulomb's law alone.
fn found() -> &'static Diagnosis {
    static FOUND: OnceLock<Diagnosis> = OnceLock::new();
    FOUND.get_or_init(|| {
        let model = coulomb(event(), &[]);
        let options = Options::of(&model, 1);
        diagnose(&model, model.event(), &options, &Quiet).unwrap()
    })
}

#[test]
fn the_diagnosis_prints_this_model() {
    let found = found();
    assert_eq!(found.selected, ["turbulent-drag"]);
    assert_eq!(found.corrected.model, PRINTED);
    assert!(diagnosis::page(found).contains("struct Before"));
}

#[test]
fn the_printed_model_has_the_evidence_of_the_diagnosis() {
    let found = found();
    let gain = found.improvement.log10_bayes_factor * LN_10;
    let told = found.baseline.log_evidence + gain;
    let se = found.mechanisms.iter().find(|m| m.name == "turbulent-drag");
    let again = printed::of(event()).unwrap().unwrap();
    // Two Monte Carlo estimates, of two backends: four standard errors.
    let error = 4.0 * se.unwrap().se.hypot(again.se);
    let apart = (again.log - told).abs();
    assert!(apart < error, "{} {told} +- {error}", again.log);
    assert!(error < 0.5, "{error}");
}

/// Calibrated with the backend that suits the model, of this name.
fn calibrated(model: &Assembled, backend: &str) -> Calibration {
    let suited = suited(model, false, &Effort::new()).unwrap();
    assert_eq!(suited.backend.name(), backend);
    let found = calibrate(model, suited.backend.as_ref(), 1, &Quiet).unwrap();
    assert_eq!(found.report.warnings, Vec::<String>::new());
    for p in &found.report.parameters {
        let effective = p.ess_bulk.min(p.ess_tail);
        assert!(effective >= 400.0, "{}: {effective}", p.name);
    }
    found
}

#[test]
fn the_corrected_model_calibrated_again_has_the_parameters_found() {
    let found = found();
    let model = coulomb(event(), &["turbulent-drag"]);
    let again = calibrated(&model, "laplace-mixture").report;
    for p in &found.parameters {
        let q = again.parameters.iter().find(|q| q.name == p.name).unwrap();
        // Some hundreds of draws each, of two runs: four standard errors.
        assert!((p.q50 - q.q50).abs() < 0.3 * q.sd, "{}", p.name);
        assert!((p.sd / q.sd - 1.0).abs() < 0.3, "{}", p.name);
    }
    calibrated(&coulomb(event(), &[]), "mh");
}

#[test]
fn edges_in_place_are_found_by_the_backend_that_is_picked() {
    // From 90 to 150 m friction is higher by 0.15 (synthetic).
    let plan = coulomb(event(), &["friction-patch"]);
    let names: Vec<&str> = plan.priors().map(|(name, _)| name).collect();
    assert_eq!(names[..2], ["friction-patch.delta_mu", "friction-patch.from"]);
    let truth = [0.15, 90.0, 60.0, 0.25, 0.01];
    let seen = simulate(&plan, &truth, Seed::new(2)).unwrap();
    let event = event().with_recording(seen[0].clone()).unwrap();
    let model = coulomb(event, &["friction-patch"]);
    let found = calibrated(&model, "laplace-mixture");
    let smc = Smc { particles: 4000, ..Smc::default() };
    let posterior = Posterior::new(&model).unwrap();
    let other = infer(&smc, &posterior, Seed::new(3), &Quiet).unwrap();
    let other = summarise(other.draws.as_ref().unwrap());
    for ((p, q), x) in found.report.parameters.iter().zip(&other).zip(truth) {
        assert!((p.mean - x).abs() < 4.0 * p.sd, "{}: {}", p.name, p.mean);
        assert!((p.mean - q.mean).abs() < 0.3 * p.sd, "{}", p.name);
    }
}
