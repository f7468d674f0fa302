//! The corrected model that a diagnosis prints compiles as it is, and has the
//! evidence that the diagnosis says.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::collections::BTreeMap;
use std::f64::consts::LN_10;
use std::sync::OnceLock;

use couloir::diagnosis::{self, Diagnosis, Options, diagnose};
use couloir::model::Assembled;
use couloir::noise;
use couloir::prelude::*;
use couloir::prior::AnyPrior;

/// A file with the text as printed.
const PRINTED: &str = include_str!("data/corrected/model.rs");

mod printed {
    include!("data/corrected/model.rs");

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

/// What is said of those speeds with Coulomb's law alone.
fn found() -> &'static Diagnosis {
    static FOUND: OnceLock<Diagnosis> = OnceLock::new();
    FOUND.get_or_init(|| {
        let laws = Laws::default().parse("coulomb").unwrap();
        let prior = |text| AnyPrior::parse(text).unwrap();
        let priors = BTreeMap::from([
            ("mu".to_owned(), prior("Gamma(9, 0.03)")),
            ("sigma2".to_owned(), prior("InverseGamma(3, 0.02)")),
        ]);
        let iid = noise::parse("iid").unwrap();
        let model = Assembled::new(event(), laws, iid, &priors).unwrap();
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
