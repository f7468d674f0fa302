//! A mechanism of a user's own is weighed with the catalogue, for one event
//! and for several of the user's own models; and what such a model declares
//! is not looked for.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use couloir::diagnosis::{
    Hypothesis, Options, Sharing, Verdict, diagnose, diagnose_together,
};
use couloir::mechanism::catalogue::Catalogue;
use couloir::mechanism::{
    Candidate, Change, Extent, Family, Mechanism, Missing, Noun, Unknown,
};
use couloir::model::{AnyProgram, Together, With};
use couloir::physics::forces::{Axis, Term};
use couloir::prelude::*;
use couloir::prior::AnyPrior;

/// Dry friction that differs in two gullies, known from the map, by the same
/// amount: one patch is not enough for it.
#[derive(Debug)]
struct Gullies {
    extent: Extent,
    name: &'static str,
}

impl Candidate for Gullies {
    fn name(&self) -> &'static str {
        self.name
    }
    fn family(&self) -> Family {
        Family::Physics
    }
    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("other friction in the gullies")
    }
    fn says(&self) -> &'static str {
        "In both gullies the dry friction is higher or lower than elsewhere."
    }
    fn unknowns(&self) -> Vec<Unknown> {
        let prior = AnyPrior::Normal(0.0, 0.15);
        vec![Unknown::amplitude("delta_mu", "1", prior)]
    }
    fn formula(&self) -> String {
        "- delta_mu g cos(theta) in the gullies".to_owned()
    }
}

impl Missing for Gullies {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { mu: values[0], ..Rate::default() };
        let gully = |edges: [f64; 2]| {
            let edges = edges.map(Real::new);
            let term = Term::between(Axis::Place, edges, rate);
            Change::force(&self.extent, term)
        };
        gully([40.0, 60.0]).and(&gully([110.0, 140.0]))
    }
}

fn with_gullies(name: &'static str) -> Options {
    let make = move |extent: &Extent| -> Box<dyn Mechanism> {
        Box::new(Gullies { extent: *extent, name })
    };
    let catalogue = Catalogue::default().with(make);
    Options::default().with_catalogue(catalogue)
}

model! {
    struct Dragged { event: Event }
    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Ar { phi: [Uniform(-1.0, 1.0)], sigma2: InverseGamma(3.0, 0.05) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

model! {
    struct Dry { event: Event }
    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 0.1) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

model! {
    struct PositionFirst { event: Event }
    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 0.1) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.position ~ flow.position() + errors;
        event.velocity ~ flow.velocity() + errors;
    }
}

/// An event on 30 degrees, with some recording.
fn plan(name: &str) -> Event {
    let times = (1..=40).map(|i| 0.4 * f64::from(i)).collect();
    Event::on(Track::incline(30.0, 900.0).unwrap())
        .named(name)
        .velocity(Series::velocity(times, vec![10.0; 40]).unwrap())
        .build()
        .unwrap()
}

/// The event as a model with the gullies would be recorded: 0.2 more friction
/// in them, then the values of the model's own parameters.
fn recorded<P: Program>(
    program: &P,
    event: &Event,
    own: &[f64],
    seed: u64,
) -> Event {
    let gullies = Gullies { extent: event.extent(), name: "gullies" };
    let truth = With::new(program, &[&gullies]);
    let values = [&[0.2], own].concat();
    let seen = simulate(&truth, &values, Seed::new(seed)).unwrap();
    event.with_recording(seen[0].clone()).unwrap()
}

#[test]
fn a_model_that_scores_other_series_than_recorded_is_refused() {
    let event = plan("one");
    let position =
        Series::position(vec![2.0, 4.0, 6.0], vec![3.0, 12.0, 27.0]).unwrap();
    let both = event.with_recording(position).unwrap();
    let refused = |model: &dyn AnyProgram| {
        let options = Options::default();
        let found = diagnose(model, &both, &options, &Quiet);
        found.unwrap_err().to_string()
    };
    let told = refused(&PositionFirst::new(both.clone()));
    let expected = "the model scores position (3 values) and velocity (40 \
        values), but recorded are velocity (40 values) and position (3 \
        values): expected each recording of an event scored once";
    assert!(told.starts_with(expected), "{told}");
    let told = refused(&Dry::new(both.clone()));
    let expected = "the model scores velocity (40 values), but recorded";
    assert!(told.starts_with(expected), "{told}");
}

#[test]
fn a_planted_effect_is_found_by_a_mechanism_of_ones_own() {
    let event = plan("one");
    let model = Dragged::new(event.clone());
    let own = [0.28, 1200.0, 0.2, 0.01];
    let event = recorded(&model, &event, &own, 1);
    let model = Dragged::new(event.clone());
    let options = with_gullies("gullies");
    let found = diagnose(&model, &event, &options, &Quiet).unwrap();
    assert_eq!(found.verdict, Verdict::MissingPhysics);
    assert_eq!(found.mechanisms[0].name, "gullies");
    let physics = Hypothesis::Mechanism(Family::Physics);
    assert_eq!(found.mechanisms[0].kind, physics);
    assert_eq!(found.selected, ["gullies"]);
    let amount = &found.parameters[0];
    assert_eq!(amount.name, "gullies.delta_mu");
    // 0.2 was planted; three posterior sd hold it in all but 3 of 1000.
    assert!((amount.mean - 0.2).abs() < 3.0 * amount.sd, "{amount:?}");
    // The model declares Voellmy's law, which has the drag; nobody said so
    // again.
    let names: Vec<&str> =
        found.mechanisms.iter().map(|m| m.name.as_str()).collect();
    assert!(!names.contains(&"turbulent-drag"), "{names:?}");
    for there in ["cohesion", "friction-patch"] {
        assert!(names.contains(&there), "{names:?}");
    }
    assert_eq!(found.baseline.friction, "voellmy");
    assert_eq!(found.baseline.noise, "ar");
}

#[test]
fn several_events_of_ones_own_models_are_diagnosed_together() {
    let members =
        ["north", "south"].into_iter().enumerate().map(|(i, name)| {
            let event = plan(name);
            let own = [0.28 + 0.03 * i as f64, 0.04];
            let dry = Dry::new(event.clone());
            let event = recorded(&dry, &event, &own, 3 + i as u64);
            (Dry::new(event.clone()), event)
        });
    let together = Together::new(members.collect()).unwrap();
    let posterior = Posterior::new(&together).unwrap();
    let names: Vec<&str> =
        posterior.parameters().iter().map(|p| p.name.as_str()).collect();
    let expected = ["north.mu", "north.sigma2", "south.mu", "south.sigma2"];
    assert_eq!(names, expected);
    let options = with_gullies("gullies");
    let shared = Sharing::Shared;
    let found =
        diagnose_together(&together, shared, &options, &Quiet).unwrap();
    assert_eq!(found.verdict, Verdict::MissingPhysics);
    assert_eq!(found.selected, ["gullies"]);
    let amount = &found.parameters[0];
    assert!((amount.mean - 0.2).abs() < 3.0 * amount.sd, "{amount:?}");
}

#[test]
fn names_that_are_taken_are_refused() {
    let event = plan("one");
    let model = Dry::new(event.clone());
    for name in ["none", "unknown", "surge"] {
        let options = with_gullies(name);
        let error = diagnose(&model, &event, &options, &Quiet).unwrap_err();
        assert!(error.is_input() && error.to_string().contains(name));
    }
}
