//! Models with mechanisms that came from an event file, and several events
//! together.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::collections::BTreeMap;

use couloir::diagnosis::{
    Fit, Options, Sharing, Together, Verdict, diagnose, diagnose_together, fit,
};
use couloir::draws::summarise;
use couloir::infer::{Backend, LaplaceMixture, Quiet, SearchSpace, Smc};
use couloir::mechanism::catalogue::{Catalogue, FrictionPatch, find};
use couloir::mechanism::{Mechanism, Role};
use couloir::model::{Assembled, Model, Point, Posterior, Program, With};
use couloir::noise::{self, Iid, Noise};
use couloir::physics::Track;
use couloir::physics::friction::Laws;
use couloir::prior::AnyPrior;
use couloir::scalar::{Plain, Real};
use couloir::{Event, Result, Seed, Series};

/// A slope with a patch of higher friction between 60 and 110 m of the common
/// axis, released at some place on it; 50 values with errors of 0.3 m/s.
fn slide(name: &str, origin: f64, seed: u64) -> Assembled {
    let times: Vec<f64> = (1..=50).map(|i| 0.2 * f64::from(i)).collect();
    let track = Track::incline(28.0, 900.0).unwrap().with_origin(origin);
    let blank = Series::velocity(times.clone(), vec![3.0; 50]).unwrap();
    let event = |series| {
        Event::on(track.clone()).named(name).velocity(series).build().unwrap()
    };
    let patch = |model: Assembled| {
        let extent = model.event().extent();
        let found = find("friction-patch", &extent, &[]).unwrap();
        model.with_mechanisms(vec![found], &BTreeMap::new()).unwrap()
    };
    let truth = [0.15, 60.0, 50.0, 0.25, 0.09];
    let states = patch(of(event(blank))).motion(&truth, &times).unwrap();
    let mut rng = Seed::new(seed).rng();
    let errors = Iid { sigma2: Real::<Plain>::new(0.09) };
    let grid = couloir::noise::Grid::new(times.clone(), None);
    let errors = errors.draw(&grid, &mut rng).unwrap();
    let values = states.iter().zip(errors).map(|(s, e)| s.speed.value() + e);
    let values = values.collect();
    of(event(Series::velocity(times, values).unwrap()))
}

fn of(event: Event) -> Assembled {
    let laws = Laws::default().parse("coulomb").unwrap();
    let noise = noise::parse("iid").unwrap();
    let mut priors = BTreeMap::new();
    priors.insert("mu".into(), AnyPrior::parse("Gamma(9, 0.03)").unwrap());
    let sigma2 = AnyPrior::parse("InverseGamma(3, 0.3)").unwrap();
    priors.insert("sigma2".into(), sigma2);
    Assembled::new(event, laws, noise, &priors).unwrap()
}

fn both() -> [Assembled; 2] {
    [slide("upper 1", 0.0, 1), slide("lower 1", 40.0, 2)]
}

/// Both under one law, or each under its own.
fn under(events: Vec<Assembled>, one_law: bool) -> Result<Together> {
    match one_law {
        true => Together::with_one_law(events),
        false => Together::new(events),
    }
}

fn likelihood(program: &impl Program, values: &[f64]) -> f64 {
    let posterior = Posterior::new(program).unwrap();
    let density = posterior.density(Point::Natural(values)).unwrap();
    assert_eq!(density.rejected, None);
    density.log_likelihood
}

#[test]
fn mechanisms_of_an_event_file_are_those_put_on_from_outside() {
    let plain = slide("one", 0.0, 1);
    let extent = plain.event().extent();
    let patch = FrictionPatch { extent };
    let outside = With::new(&plain, &[&patch]);
    let key = "friction-patch.delta_mu".to_owned();
    let prior = AnyPrior::parse("Normal(0.1, 0.2)").unwrap();
    let priors = BTreeMap::from([(key, prior)]);
    let inside = having("friction-patch", &priors);
    inside.check_priors(&priors).unwrap();
    assert_eq!(
        inside.priors().next().unwrap().1.to_string(),
        prior.to_string()
    );
    let (mechanism, own) = ([0.14, 61.0, 47.0], [0.26, 0.1]);
    let all = [&mechanism[..], &own].concat();
    let a = likelihood(&outside, &all);
    let b = likelihood(&inside, &all);
    assert_eq!(a, b);
    let zero = likelihood(&inside, &[0.0, 61.0, 47.0, 0.26, 0.1]);
    assert!((zero - likelihood(&plain, &own)).abs() < 1e-9);
    let part = inside.first(20).unwrap();
    let known = likelihood(&part, &all);
    assert!(known.is_finite() && known != b);
    assert!(inside.rest(&all).unwrap().is_none());
}

#[test]
fn a_stretch_ends_within_the_run_unless_the_file_has_a_prior() {
    let plain = slide("one", 0.0, 1);
    let extent = plain.event().extent();
    let patch = FrictionPatch { extent };
    let outside = With::new(&plain, &[&patch]);
    let key = "friction-patch.length".to_owned();
    let prior = AnyPrior::Uniform(1.0, extent.run);
    let given = BTreeMap::from([(key, prior)]);
    let [inside, free] = [BTreeMap::new(), given]
        .map(|priors| having("friction-patch", &priors));
    let own = [0.26, 0.1];
    let log_prior = |program: &dyn Model, values: &[&[f64]]| -> f64 {
        let posterior = Posterior::new(program).unwrap();
        let values = values.concat();
        posterior.density(Point::Natural(&values)).unwrap().log_prior
    };
    let half = extent.begin + 0.5 * extent.run;
    for (share, is_possible) in [(0.45, true), (0.55, false)] {
        let amounts = [0.14, half, share * extent.run];
        let a = log_prior(&outside, &[&amounts, &own]);
        let b = log_prior(&inside, &[&amounts, &own]);
        assert_eq!(a.is_finite(), is_possible, "{share}");
        assert!(a == b || (a - b).abs() < 1e-12, "{a} {b}");
        assert!(log_prior(&free, &[&amounts, &own]).is_finite());
    }
    let before = [0.14, half];
    let middle =
        |model: &Assembled| model.middle(&before).unwrap() / extent.run;
    assert!(middle(&inside) < 0.3 && middle(&free) > 0.5);
    let until = extent.begin + extent.run;
    assert_eq!(inside.role(2), Role::Length { until });
    assert_eq!(free.role(2), Role::Other);
}

/// A slide whose model has a mechanism already, under priors of a file.
fn having(label: &str, priors: &BTreeMap<String, AnyPrior>) -> Assembled {
    let plain = slide("one", 0.0, 1);
    let found = find(label, &plain.event().extent(), &[]).unwrap();
    plain.with_mechanisms(vec![found], priors).unwrap()
}

#[test]
fn what_a_model_has_is_not_looked_for_and_stays() {
    let model = having("clock-offset", &BTreeMap::new());
    let options = Options::of(&model, 1);
    let found = diagnose(&model, model.event(), &options, &Quiet).unwrap();
    assert_eq!(found.verdict, Verdict::MissingPhysics);
    let names: Vec<&str> =
        found.mechanisms.iter().map(|m| m.name.as_str()).collect();
    assert!(!names.contains(&"clock-offset"), "{names:?}");
    assert_eq!(found.baseline.mechanisms, ["clock-offset"]);
    // Whatever is found, it comes after what was there.
    let corrected = &found.corrected;
    let all = [&found.baseline.mechanisms[..], &found.selected].concat();
    assert_eq!(corrected.labels.len(), all.len());
    for (i, (label, name)) in corrected.labels.iter().zip(&all).enumerate() {
        assert!(label.starts_with(name), "{label}");
        let line = &corrected.equation[1 + i];
        assert!(line.starts_with(&format!("{name}: ")), "{line}");
        let line = format!("let added_{i} = find({label:?}, &extent");
        assert!(corrected.model.contains(&line), "{}", corrected.model);
    }
}

#[test]
fn no_variant_of_what_a_model_has_is_looked_for() {
    let model = having("friction-step(time)", &BTreeMap::new());
    let extent = model.event().extent();
    let names = |blocks: &[String]| -> Vec<&str> {
        let all = couloir::mechanism::catalogue::catalogue(&extent, blocks);
        all.iter().map(|m| m.name()).collect()
    };
    assert!(names(&[]).contains(&"friction-step"));
    assert!(!names(&model.blocks()).contains(&"friction-step"));
    // A force is shared by all events, a clock is each one's own.
    let together = |label: &str| -> Vec<String> {
        let events =
            vec![having(label, &BTreeMap::new()), slide("two", 40.0, 2)];
        let together = Together::new(events).unwrap();
        let clock = together.catalogue(&Catalogue::default(), Sharing::Shared);
        let of = |name: &str| {
            let found = clock.iter().find(|m| m.name() == name)?;
            Some(found.unknowns().into_iter().map(|u| u.name))
        };
        of(label).into_iter().flatten().collect()
    };
    assert!(together("friction-patch").is_empty());
    assert_eq!(together("clock-offset"), ["two.ahead"]);
}

#[test]
fn sensors_are_shared_where_they_record_the_same() {
    let names = |events: [Assembled; 2], name: &str| -> Vec<String> {
        let together = Together::new(events.into()).unwrap();
        let all = together.catalogue(&Catalogue::default(), Sharing::Shared);
        let found = all.iter().find(|m| m.name() == name).unwrap();
        found.unknowns().into_iter().map(|u| u.name).collect()
    };
    let mixed = || {
        let [velocity, _] = both();
        let times: Vec<f64> = (1..=50).map(|i| 0.2 * f64::from(i)).collect();
        let values = times.iter().map(|t| 1.5 * t * t).collect();
        let track = Track::incline(28.0, 900.0).unwrap();
        let event = Event::on(track).named("seen 2");
        let event = event.position(Series::position(times, values).unwrap());
        [velocity, of(event.build().unwrap())]
    };
    assert_eq!(names(both(), "velocity-scale"), ["excess"]);
    assert_eq!(names(mixed(), "friction-patch")[0], "delta_mu");
    let own = names(mixed(), "velocity-scale");
    assert!(own.len() == 2 && own[0].ends_with(".excess"), "{own:?}");
}

#[test]
fn with_nothing_shared_the_log_evidence_adds_up() {
    let peaks = LaplaceMixture::default();
    let of = |model: &Assembled, seed| -> Fit {
        fit(model, &[], &peaks, Seed::new(seed)).unwrap()
    };
    let [a, b] = both();
    let sum = of(&a, 1).log_evidence + of(&b, 2).log_evidence;
    let exact = likelihood(&a, &[0.3, 0.2]) + likelihood(&b, &[0.28, 0.1]);
    let together = Together::new(both().into()).unwrap();
    assert_eq!(together.labels(), ["upper", "lower"]);
    let joint = likelihood(&together, &[0.3, 0.2, 0.28, 0.1]);
    assert!((joint - exact).abs() < 1e-9);
    let joint = fit(&together, &[], &peaks, Seed::new(3)).unwrap();
    assert_eq!(joint.draws.names()[0], "upper.mu");
    let apart = (joint.log_evidence - sum).abs();
    assert!(apart < 0.1, "{} {sum}", joint.log_evidence);
    let shared = Together::with_one_law(both().into()).unwrap();
    let posterior = Posterior::new(&shared).unwrap();
    let names: Vec<_> =
        posterior.parameters().iter().map(|p| p.name.clone()).collect();
    assert_eq!(names, ["mu", "upper.sigma2", "lower.sigma2"]);
}

#[test]
fn what_events_have_in_common_is_integrated_as_all_at_once() {
    // Tempering knows nothing of events; of the two estimates each has an
    // error of its own, and four of both together are allowed.
    let tempering = Smc { particles: 1500, ..Smc::default() };
    let cases = [
        ("friction-step", Sharing::Shared, true),
        ("friction-step", Sharing::Pooled, false),
        ("initial-velocity", Sharing::Shared, true),
        ("friction-patch", Sharing::Shared, true),
    ];
    for (name, sharing, one_law) in cases {
        let together = under(both().into(), one_law).unwrap();
        let all = together.catalogue(&Catalogue::default(), sharing);
        let found = all.iter().find(|m| m.name() == name).unwrap();
        let added = [found.as_ref()];
        let peaks = LaplaceMixture::default();
        let apart = fit(&together, &added, &peaks, Seed::new(5)).unwrap();
        let with = With::new(&together, &added);
        let posterior = Posterior::new(&with).unwrap();
        let led = tempering.explore(&posterior, Seed::new(6), &Quiet).unwrap();
        let known = led.evidence.unwrap();
        let off = (apart.log_evidence - known.log).abs();
        let error = apart.se.hypot(known.se);
        let what = format!(
            "{name}: {} +- {}, {} +- {}",
            apart.log_evidence, apart.se, known.log, known.se
        );
        assert!(off < 4.0 * error && error < 0.2, "{what}");
        // The draws are of all at once too: four standard errors of a mean of
        // a hundred draws, for sd that a hundred draws tell to a tenth.
        let (mine, theirs) =
            (summarise(&apart.draws), summarise(&led.draws.unwrap()));
        for (a, b) in mine.iter().zip(&theirs) {
            let off = (a.mean - b.mean).abs();
            assert!(off < 0.4 * b.sd, "{what}; {}: {a:?} {b:?}", a.name);
        }
    }
}

/// The width of the 90 % interval of the patch's delta_mu, and its middle.
fn width(
    program: &impl Program,
    mechanism: &dyn couloir::mechanism::Mechanism,
) -> (f64, f64) {
    let backend = LaplaceMixture::within(SearchSpace {
        prior_starts: 200,
        ..SearchSpace::default()
    });
    let found = fit(program, &[mechanism], &backend, Seed::new(4)).unwrap();
    let delta = &summarise(&found.draws)[0];
    assert_eq!(delta.name, "friction-patch.delta_mu");
    (delta.q95 - delta.q05, delta.q50)
}

#[test]
fn a_shared_patch_is_known_better_from_two() {
    let [a, b] = both();
    let patch = |model: &Assembled| {
        find("friction-patch", &model.event().extent(), &[]).unwrap()
    };
    let (one, _) = width(&a, patch(&a).as_ref());
    let (other, _) = width(&b, patch(&b).as_ref());
    let together = Together::new(both().into()).unwrap();
    let all = together.catalogue(&Catalogue::default(), Sharing::Shared);
    let shared = all.iter().find(|m| m.name() == "friction-patch").unwrap();
    let (joint, middle) = width(&together, shared.as_ref());
    assert!(joint < one.min(other), "{one} {other} {joint}");
    assert!((middle - 0.15).abs() < 0.05, "{middle}");
}

#[test]
fn each_event_sees_its_own_change() {
    let together = Together::new(both().into()).unwrap();
    let extent = together.extent();
    let [a, b] = both().map(|model| model.event().extent());
    assert_eq!(extent.begin, a.begin.min(b.begin));
    let end = (a.begin + a.run).max(b.begin + b.run);
    assert!((extent.begin + extent.run - end).abs() < 1e-9);
    let all = together.catalogue(&Catalogue::default(), Sharing::Shared);
    let clock = all.iter().find(|m| m.name() == "clock-offset").unwrap();
    let names: Vec<_> = clock.unknowns().into_iter().map(|u| u.name).collect();
    assert_eq!(names, ["upper.ahead", "lower.ahead"]);
    let own = [0.3, 0.2, 0.28, 0.1];
    let with = With::new(&together, &[clock.as_ref()]);
    let found = likelihood(&with, &[&[0.4, -0.3], &own[..]].concat());
    let single = |model: &Assembled, values: [f64; 3]| {
        let extent = model.event().extent();
        let clock = find("clock-offset", &extent, &[]).unwrap();
        likelihood(&With::new(model, &[clock.as_ref()]), &values)
    };
    let [a, b] = both();
    let sum = single(&a, [0.4, 0.3, 0.2]) + single(&b, [-0.3, 0.28, 0.1]);
    assert!((found - sum).abs() < 1e-9, "{found} {sum}");
}

#[test]
fn a_pooled_amplitude_is_the_common_one_where_nothing_spreads() {
    let together = Together::with_one_law(both().into()).unwrap();
    let own = [0.28, 0.1, 0.1];
    let pooled = together.catalogue(&Catalogue::default(), Sharing::Pooled);
    let shared = together.catalogue(&Catalogue::default(), Sharing::Shared);
    for (pooled, shared) in pooled.iter().zip(&shared) {
        assert_eq!(pooled.label(), shared.label());
        let middle = |m: &dyn Mechanism| -> Vec<f64> {
            let unknowns = m.unknowns();
            unknowns.iter().map(|u| u.prior.quantile(0.4).unwrap()).collect()
        };
        let common = middle(shared.as_ref());
        let a = With::new(&together, &[shared.as_ref()]);
        let a = likelihood(&a, &[&common, &own[..]].concat());
        let mut values = common.clone();
        if !pooled.is_each_events_own() {
            values.extend([1e-12, 0.7, -0.4]);
        }
        let with = With::new(&together, &[pooled.as_ref()]);
        let b = likelihood(&with, &[&values, &own[..]].concat());
        assert!((a - b).abs() < 1e-6, "{}: {a} {b}", pooled.label());
        if !pooled.is_each_events_own() {
            let last = values.len() - 3;
            values[last] = 0.05;
            let c = likelihood(&with, &[&values, &own[..]].concat());
            assert!((c - b).abs() > 1e-4, "{}", pooled.label());
        }
    }
}

#[test]
fn events_that_cannot_share_a_law_are_refused() {
    let laws = Laws::default().parse("voellmy").unwrap();
    let noise = noise::parse("iid").unwrap();
    let event = slide("other", 0.0, 3).event().clone();
    let other = Assembled::new(event, laws, noise, &BTreeMap::new()).unwrap();
    let [a, _] = both();
    let error = Together::with_one_law(vec![a, other]).unwrap_err();
    assert!(error.is_input() && error.to_string().contains("voellmy"));
    let none = Together::<Assembled>::new(Vec::new());
    assert!(none.unwrap_err().is_input());
}

#[test]
fn events_with_different_noises_are_diagnosed_together() {
    let mut events: Vec<Assembled> = both().into();
    let other = events[1].with_noise("ar(1)").unwrap().unwrap();
    events[1] = other;
    let together = Together::new(events).unwrap();
    let options = Options::of_all(&together, 1);
    assert_eq!(options.noise, "iid | ar(1)");
    let found =
        diagnose_together(&together, Sharing::Shared, &options, &Quiet);
    let noises = found.unwrap().noise;
    assert!(!noises.is_empty());
}

#[test]
fn moments_are_on_the_shared_clock() {
    // The same slide, its clock read 7 s later: what happens at a moment of
    // the shared clock happens 7 s sooner by its own.
    let plain = slide("one", 0.0, 1);
    let event = plain.event();
    let late = Event::on(event.track().clone())
        .named("one")
        .clock(7.0)
        .velocity(event.velocity.clone())
        .build()
        .unwrap();
    let late = of(late);
    assert_eq!(late.event().extent().since, 7.0);
    let cases: [(&str, &[f64], &[f64]); 4] = [
        ("surge", &[0.5, 3.0, 2.0], &[0.5, 10.0, 2.0]),
        ("friction-step(time)", &[0.1, 4.0], &[0.1, 11.0]),
        ("friction-hardening(time, linear)", &[0.1], &[0.1]),
        ("spreading", &[0.6, 2.0], &[0.6, 2.0]),
    ];
    for (label, own, shared) in cases {
        let value = |model: &Assembled, amounts: &[f64]| {
            let extent = model.event().extent();
            let found = find(label, &extent, &[]).unwrap();
            let with = With::new(model, &[found.as_ref()]);
            likelihood(&with, &[amounts, &[0.26, 0.1]].concat())
        };
        let (a, b) = (value(&plain, own), value(&late, shared));
        // Round-off of a sum of 50 squares.
        assert!((a - b).abs() < 1e-9 * a.abs(), "{label}: {a} {b}");
        let without = likelihood(&late, &[0.26, 0.1]);
        assert!((b - without).abs() > 0.1, "{label} does nothing");
    }
    let both = Together::new(vec![plain, late]).unwrap();
    let extent = both.extent();
    assert_eq!((extent.since, extent.duration), (0.0, 17.0));
}
