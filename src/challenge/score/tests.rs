//! Scores of answers made by hand.

use super::*;
use crate::challenge::effects::NONE as NOTHING;

/// A truth of the catalogue, or nothing hidden.
pub(in crate::challenge) fn truth(effect: &str) -> Truth {
    let all = CATALOGUE.into_iter().chain(super::super::effects::OUTSIDE);
    let kind = all.chain([NOTHING]).find(|k| k.name == effect).unwrap();
    Truth {
        effect: kind.name,
        class: kind.class,
        interval: (effect == "friction-patch").then(|| place(100.0, 150.0)),
        size: kind.range.1,
        unit: kind.unit,
        scatter: Scatter::of_effect(kind.name),
        noise_sd: 0.3,
        noise_rms: 0.31,
        gain: 20.0,
    }
}

fn place(from: f64, to: f64) -> Interval {
    let coordinate = Coordinate::Arclength;
    let (time_from, time_to) = (from / 10.0, to / 10.0);
    Interval { coordinate, from, to, time_from, time_to }
}

/// An outcome in which a name got a probability.
pub(in crate::challenge) fn outcome(
    effect: &str,
    answer: &str,
    p: f64,
) -> Outcome {
    let verdict = if answer == NONE { ADEQUATE } else { "missing-physics" };
    let others = (String::from("surge-like"), 1.0 - p);
    let noise = if answer == "ar1" { "ou + tails" } else { "iid" };
    Outcome {
        case: "case-001".to_owned(),
        truth: truth(effect),
        answer: Answer {
            noises: vec![(noise.to_owned(), 1.0)],
            verdict: verdict.to_owned(),
            probabilities: vec![(answer.to_owned(), p), others],
            group: vec![answer.to_owned()],
            mismatch: vec![place(100.0, 150.0)],
            rmse_before: 2.0,
            rmse_after: 0.3,
            least_squares_before: 1.9,
            least_squares_after: 0.29,
            heldout_rmse_after: 0.3,
            seconds: 1.0,
        },
    }
}

const SOME: [&str; 4] = ["none", "friction-patch", "slope-bias", "ar1"];

#[test]
fn perfect_answers() {
    let all = SOME.map(|name| outcome(name, name, 1.0));
    let score = Score::of(&all);
    // The bias counts by group only.
    assert_eq!(score.top1, Share { hits: 2, of: 2 });
    assert_eq!(score.in_group, Share { hits: 3, of: 3 });
    assert_eq!(score.false_alarms, Share { hits: 0, of: 1 });
    assert_eq!(score.within_noise, Share { hits: 3, of: 3 });
    assert!(score.expected_calibration_error.abs() < 1e-12);
    assert!((score.median_iou - 1.0).abs() < 1e-12);
    assert_eq!(score.confusion["ar1"]["ar1"], 1);
    assert!(failures(&all).is_empty());
}

#[test]
fn all_wrong() {
    let mut all = SOME.map(|name| {
        let wrong = if name == "none" { "surge" } else { "none" };
        outcome(name, wrong, 0.9)
    });
    for o in &mut all {
        o.answer.mismatch.clear();
        o.answer.rmse_after = 1.0;
    }
    let score = Score::of(&all);
    assert_eq!((score.top1.hits, score.in_group.hits), (0, 0));
    assert_eq!(score.false_alarms, Share { hits: 1, of: 1 });
    assert_eq!(score.detected.hits, 0);
    assert_eq!((score.within_noise.hits, score.median_iou), (0, 0.0));
    assert!((score.expected_calibration_error - 0.9).abs() < 1e-12);
    assert_eq!(failures(&all).len(), 4);
    assert_eq!(score.confusion["none"]["surge"], 1);
}

/// A small effect has more evidence than nothing, and less probability.
#[test]
fn the_group_goes_by_evidence() {
    let mut one = outcome("surge", "none", 0.6);
    one.answer.group = vec!["surge".into(), "none".into()];
    let score = Score::of(&[one]);
    assert_eq!((score.top1.hits, score.leads.hits), (0, 1));
}

#[test]
fn calibration_by_hand() {
    // Nothing hidden: two cases of weight 1/4; two names: the patch once, of
    // weight 1/4, the drift twice, of 1/8 each.
    let all = [
        outcome("none", "none", 0.9),
        outcome("none", "surge", 0.7),
        outcome("friction-patch", "friction-patch", 0.8),
        outcome("sensor-drift", "sensor-drift", 0.75),
        outcome("sensor-drift", "surge", 0.65),
    ];
    let score = Score::of(&all);
    // The bin from 0.8: stated (0.9 + 0.8)/2, all right. From 0.6: stated
    // (0.7/4 + 0.75/8 + 0.65/8) 2 = 0.7, right 1/8 of 1/2 = 1/4.
    let expected = 0.5 * 0.15 + 0.5 * (0.7 - 0.25);
    assert!((score.expected_calibration_error - expected).abs() < 1e-12);
    assert_eq!(score.bins[4].count, 2);
    assert!((score.bins[3].right - 0.25).abs() < 1e-12);
}

#[test]
fn overlap_is_of_unions() {
    let truth = place(100.0, 200.0);
    assert_eq!(overlap(&truth, &[]), 0.0);
    let parts = [place(140.0, 160.0), place(150.0, 220.0)];
    assert!((overlap(&truth, &parts) - 60.0 / 120.0).abs() < 1e-12);
    let mut times = place(10.0, 15.0);
    times.coordinate = Coordinate::Time;
    (times.time_from, times.time_to) = (10.0, 15.0);
    assert!((overlap(&truth, &[times]) - 0.5).abs() < 1e-12);
    assert!((overlap(&times, &[truth]) - 0.5).abs() < 1e-12);
}

#[test]
fn outside_the_catalogue_unknown_and_a_good_fit_are_fair() {
    let mut poor = outcome("wall-drag", "entrainment", 0.9);
    poor.answer.heldout_rmse_after = 2.0;
    let all = [
        outcome("wall-drag", "unknown", 0.9),
        outcome("cubic-drag", "turbulent-drag", 0.9),
        poor,
    ];
    let score = Score::of(&all);
    assert_eq!(score.outside.unknown, Share { hits: 1, of: 3 });
    assert_eq!(score.outside.explained, Share { hits: 1, of: 3 });
    assert_eq!((score.top1.of, failures(&all).len()), (0, 1));
}

/// Of errors that are not those of the event's file, saying so is neither a
/// false alarm nor a discovery.
#[test]
fn errors_beside_an_effect_are_scored_apart() {
    let real = |effect: &str, verdict: &str, noise: &str| {
        let mut one = outcome(effect, effect, 0.9);
        one.truth.scatter = Scatter::Smooth;
        one.answer.verdict = verdict.to_owned();
        one.answer.noises = vec![(noise.to_owned(), 0.8)];
        one
    };
    let mut worse = real("surge", "noise", "ar(1)");
    worse.answer.rmse_after = 2.5;
    worse.answer.least_squares_after = 1.9;
    let all = [
        real("none", "noise", "matern32 + white"),
        real("none", "measurement", "matern32 + white + growth"),
        real("surge", "missing-physics", "ou + white"),
        worse,
    ];
    let score = Score::of(&all);
    assert_eq!(score.false_alarms, Share { hits: 1, of: 2 });
    assert_eq!(score.detected, Share { hits: 1, of: 2 });
    assert_eq!(score.noise_kind, Share { hits: 2, of: 4 });
    assert_eq!(score.noise_kinds, [(Scatter::Smooth, score.noise_kind)]);
    assert_eq!(score.worse, Share { hits: 1, of: 4 });
    assert_eq!(score.worse_at_best, Share { hits: 0, of: 4 });
}
