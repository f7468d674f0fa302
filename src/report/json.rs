//! A calibration as `calibration.json`, the document for programs.

use serde_json::{Map, Value, json};

use super::{
    CalibrationReport, Checks, EvidenceReport, LawReport, NoiseReport,
    ParameterReport,
};
use crate::noise::Form;
use crate::predict::Statistic;

/// `calibration.json`, schema 1; numbers that are not finite are null.
///
/// ```
/// use couloir::report::{CalibrationReport, calibration_json};
/// let json = calibration_json(&CalibrationReport::default());
/// assert_eq!(json["schema"], 1);
/// assert!(json["log_evidence"].is_null());
/// ```
pub fn calibration_json(report: &CalibrationReport) -> Value {
    let parameters: Map<String, Value> = report
        .parameters
        .iter()
        .map(|p| (p.name.clone(), parameter(p)))
        .collect();
    let mut model = json!({"friction": report.friction});
    model["noise"] = match report.noises.is_empty() {
        true => json!(report.noise),
        false => json!("infer"),
    };
    if !report.mechanisms.is_empty() {
        model["mechanisms"] = json!(report.mechanisms);
    }
    let mut document = json!({
        "schema": 1,
        "event": report.event,
        "model": model,
        "backend": report.backend,
        "seed": report.seed,
        "parameters": parameters,
        "log_evidence": report.evidence.as_ref().map(evidence),
        "checks": checks(&report.checks),
        "predictive":
            report.statistics.iter().map(statistic).collect::<Vec<_>>(),
        "notes": report.notes,
        "simulations": report.simulations,
        "warnings": report.warnings,
        "doubts": report.doubts,
    });
    if let Some(why) = &report.backend_why {
        document["backend_why"] = json!(why);
    }
    if !report.noises.is_empty() {
        document["noise"] = report.noises.iter().map(noise).collect();
    }
    if let Some(found) = &report.law {
        document["law"] = law(found);
    }
    report.origin.write_to(&mut document);
    document
}

fn noise(n: &NoiseReport) -> Value {
    let known = [n.probability, n.log10_bayes_factor];
    noise_json(&n.name, known, &figures(&n.parameters))
}

/// A noise with its probability and log10 Bayes factor, in `calibration.json`
/// as in `diagnosis.json`.
pub(crate) fn noise_json(
    name: &str,
    [probability, log10_bayes_factor]: [f64; 2],
    parameters: &Value,
) -> Value {
    let form = Form::of(name);
    json!({
        "name": name,
        "tails": if form.has_tails { "student" } else { "normal" },
        "size": if form.grows { "growing" } else { "equal" },
        "probability": probability,
        "log10_bayes_factor": log10_bayes_factor,
        "parameters": parameters,
    })
}

/// As in `diagnosis.json`, with what speaks for the force.
fn law(law: &LawReport) -> Value {
    let used = match law.needs_force() {
        true => "with_free_form_force",
        false => "as_it_was",
    };
    json!({
        "as_it_was": figures(&law.as_it_was),
        "with_free_form_force": figures(&law.with_free_form_force),
        "log10_bayes_factor": law.log10_bayes_factor,
        "differs": law.differs,
        "use": used,
    })
}

/// Parameters as `diagnosis.json` has them.
fn figures(parameters: &[ParameterReport]) -> Value {
    let one = |p: &ParameterReport| {
        let value = json!({
            "mean": p.mean, "sd": p.sd, "q05": p.q05, "q50": p.q50,
            "q95": p.q95, "unit": p.unit,
        });
        (p.name.clone(), value)
    };
    Value::Object(parameters.iter().map(one).collect())
}

/// A figure of the recording beside those of its replicates.
fn statistic(s: &Statistic) -> Value {
    json!({
        "name": s.name, "unit": s.unit, "recorded": s.recorded,
        "q05": s.quantile(0.05), "q50": s.quantile(0.5),
        "q95": s.quantile(0.95), "p": s.p(),
    })
}

// serde_json turns numbers that are not finite into null.
fn parameter(p: &ParameterReport) -> Value {
    json!({
        "unit": p.unit,
        "prior": p.prior_text,
        "map": p.map,
        "mean": p.mean,
        "sd": p.sd,
        "q025": p.q025,
        "q05": p.q05,
        "q50": p.q50,
        "q95": p.q95,
        "q975": p.q975,
        "rhat": p.rhat,
        "ess_bulk": p.ess_bulk,
        "ess_tail": p.ess_tail,
        "mcse_mean": p.mcse_mean,
    })
}

fn evidence(e: &EvidenceReport) -> Value {
    json!({"value": e.value, "se": e.se, "method": e.method})
}

fn checks(c: &Checks) -> Value {
    json!({
        "ljung_box_p": c.ljung_box_p,
        "shapiro_wilk_p": c.shapiro_wilk_p,
        "kolmogorov_smirnov_p": c.kolmogorov_smirnov_p,
        "coverage90": c.coverage90,
        "rmse": c.rmse,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture;

    fn keys(value: &Value) -> Vec<&str> {
        value
            .as_object()
            .map(|o| o.keys().map(String::as_str).collect())
            .unwrap_or_default()
    }

    #[test]
    fn keys_are_those_of_the_format() {
        let json = calibration_json(&fixture::calibration());
        let mut top = keys(&json);
        top.sort_unstable();
        assert_eq!(
            top,
            [
                "backend",
                "checks",
                "doubts",
                "event",
                "log_evidence",
                "model",
                "notes",
                "parameters",
                "predictive",
                "program",
                "schema",
                "seed",
                "simulations",
                "warnings"
            ]
        );
        assert_eq!(keys(&json["parameters"]["mu"]).len(), 14);
        assert_eq!(keys(&json["checks"]).len(), 5);
        assert_eq!(keys(&json["log_evidence"]).len(), 3);
        assert_eq!(keys(&json["model"]), ["friction", "noise"]);
    }

    #[test]
    fn what_is_not_finite_is_null() {
        let mut report = fixture::calibration();
        report.parameters[0].rhat = f64::NAN;
        report.parameters[0].sd = f64::INFINITY;
        report.parameters[0].map = Some(f64::NAN);
        report.evidence = None;
        let json = calibration_json(&report);
        for key in ["rhat", "sd", "map"] {
            assert!(json["parameters"]["mu"][key].is_null(), "{key}");
        }
        assert!(json["log_evidence"].is_null());
    }
}
