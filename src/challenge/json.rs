//! `challenge.json`, the document for programs.

use serde_json::{Map, Value, json};

use super::scatter::Scatter;
use super::score::{CalibrationBin, EffectScore, Outcome, Score, Share};
use super::trial::Scored;

/// `challenge.json`, schema 1. A share without cases is null.
pub fn challenge_json(scored: &Scored) -> Value {
    let s = &scored.score;
    let outside = &s.outside;
    json!({
        "schema": 1,
        "cases": s.cases,
        "top1": s.top1.value(),
        "expected_calibration_error": s.expected_calibration_error,
        "false_alarm_rate": s.false_alarms.value(),
        "median_iou": s.median_iou,
        "confusion": s.confusion,
        "first_in_group": s.leads.value(),
        "in_group": s.in_group.value(),
        "detected": s.detected.value(),
        "rmse_within": s.within_noise.value(),
        "noise_kind": s.noise_kind.value(),
        "noise_kinds": s.noise_kinds.iter().map(kind).collect::<Map<_, _>>(),
        "fit_worse": s.worse.value(),
        "fit_worse_most": s.most_worse,
        "least_squares_worse": s.worse_at_best.value(),
        "visible": {
            "cases": s.in_group_visible.of,
            "top1": s.top1_visible.value(),
            "in_group": s.in_group_visible.value(),
        },
        "standard_errors": errors(s),
        "calibration": s.bins.iter().map(bin).collect::<Vec<_>>(),
        "effects": s.effects.iter().map(effect).collect::<Map<_, _>>(),
        "outside": {
            "cases": outside.detected.of,
            "detected": outside.detected.value(),
            "unknown": outside.unknown.value(),
            "explained": outside.explained.value(),
            "median_iou": outside.median_iou,
        },
        "seconds": {"median": s.seconds.0, "max": s.seconds.1},
        "answers": scored.outcomes.iter().map(answer).collect::<Vec<_>>(),
    })
}

fn errors(s: &Score) -> Value {
    json!({
        "top1": s.top1.se(),
        "first_in_group": s.leads.se(),
        "in_group": s.in_group.se(),
        "false_alarm_rate": s.false_alarms.se(),
        "detected": s.detected.se(),
        "rmse_within": s.within_noise.se(),
        "noise_kind": s.noise_kind.se(),
        "fit_worse": s.worse.se(),
        "least_squares_worse": s.worse_at_best.se(),
    })
}

fn kind((scatter, share): &(Scatter, Share)) -> (String, Value) {
    let value = json!({"cases": share.of, "right": share.value()});
    (scatter.name().to_owned(), value)
}

fn bin(bin: &CalibrationBin) -> Value {
    json!({
        "cases": bin.count,
        "weight": bin.weight,
        "stated": bin.stated,
        "right": bin.right,
    })
}

fn effect(e: &EffectScore) -> (String, Value) {
    let value = json!({
        "cases": e.first.of,
        "visible": e.visible.hits,
        "top1": e.first.value(),
        "in_group": e.in_group.value(),
        "detected": e.detected.value(),
        "detected_by_size": e.by_size.each_ref().map(Share::value),
        "median_iou": e.median_iou,
    });
    (e.name.to_owned(), value)
}

fn answer(o: &Outcome) -> Value {
    let (name, probability) = o.answer.top();
    json!({
        "case": o.case,
        "truth": o.truth.effect,
        "size": o.truth.size,
        "unit": o.truth.unit,
        "errors": o.truth.scatter.name(),
        "noise_sd": o.truth.noise_sd,
        "gain": o.truth.gain,
        "answer": name,
        "probability": probability,
        "verdict": o.answer.verdict,
        "noise": o.answer.noises.first().map(|(name, _)| name),
        "noise_probability": o.answer.noises.first().map(|(_, p)| p),
        "group": o.answer.group,
        "iou": o.overlap(),
        "rmse_before": o.answer.rmse_before,
        "rmse_after": o.answer.rmse_after,
        "rmse_least_squares_before": o.answer.least_squares_before,
        "rmse_least_squares_after": o.answer.least_squares_after,
        "seconds": o.answer.seconds,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::challenge::score::tests::outcome;

    #[test]
    fn the_keys_are_those_of_the_format() {
        let outcomes = vec![outcome("surge", "surge", 0.9)];
        let score = Score::of(&outcomes);
        let value = challenge_json(&Scored { outcomes, score });
        for key in [
            "schema",
            "cases",
            "top1",
            "expected_calibration_error",
            "false_alarm_rate",
            "median_iou",
            "confusion",
        ] {
            assert!(value.get(key).is_some(), "{key}");
        }
        assert_eq!(value["top1"], 1.0);
        assert_eq!(value["false_alarm_rate"], Value::Null);
        assert_eq!(value["noise_kind"], 1.0);
        assert_eq!(value["noise_kinds"]["independent"]["cases"], 1);
        assert_eq!(value["fit_worse"], 0.0);
        assert_eq!(value["confusion"]["surge"]["surge"], 1);
    }
}
