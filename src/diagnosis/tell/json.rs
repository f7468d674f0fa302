//! A diagnosis as `diagnosis.json`.

use std::f64::consts::LN_10;

use serde_json::{Map, Value, json};

use crate::diagnosis::locate::{Band, FreeForce};
use crate::diagnosis::tell::words::{in_words, single_rival};
use crate::diagnosis::{
    Baseline, Corrected, Diagnosis, Improvement, Judged, JudgedNoise,
    LawParameters, Mismatch, ParameterSummary, Rest, Rival,
};
use crate::physics::forces::Axis;
use crate::report::noise_json;

fn axis_name(axis: Axis) -> &'static str {
    match axis {
        Axis::Place => "arclength",
        Axis::Time => "time",
        Axis::Speed => "speed",
    }
}

fn parameters_json(parameters: &[ParameterSummary]) -> Value {
    let entry = |p: &ParameterSummary| {
        let value = json!({
            "mean": p.mean, "sd": p.sd, "q05": p.q05, "q50": p.q50,
            "q95": p.q95, "unit": p.unit,
        });
        (p.name.clone(), value)
    };
    Value::Object(parameters.iter().map(entry).collect())
}

fn law_json(law: &LawParameters) -> Value {
    json!({
        "as_it_was": parameters_json(&law.as_it_was),
        "corrected": parameters_json(&law.corrected),
        "with_free_form_force": parameters_json(&law.with_free_form_force),
    })
}

fn rest_json(rest: &Rest) -> Value {
    json!({
        "specific_force_sd": rest.specific_force_sd,
        "specific_force_q95": rest.specific_force_q95,
        "unit": "m/s2",
    })
}

fn mismatch_json(m: &Mismatch) -> Value {
    let mut value = json!({
        "coordinate": axis_name(m.axis), "from": m.from, "to": m.to,
        "unit": m.axis.unit(), "time_from": m.time_from, "time_to": m.time_to,
        "place_from": m.place_from, "place_to": m.place_to,
        "specific_force": m.specific_force,
        "specific_force_q05": m.specific_force_q05,
        "specific_force_q95": m.specific_force_q95,
        "delta_mu": m.delta_mu, "probability": m.probability,
    });
    if m.parts.len() > 1 {
        let parts = m.parts.iter().map(|(from, to, force)| {
            json!({"from": from, "to": to, "specific_force": force})
        });
        value["parts"] = parts.collect();
    }
    value
}

fn judged_json(m: &Judged) -> Value {
    let mut value = json!({
        "name": m.name, "kind": m.kind.name(), "probability": m.probability,
        "log_evidence": m.log_evidence, "log_evidence_se": m.se,
        "log10_bayes_factor": m.log10_bayes_factor, "says": m.says,
        "parameters": parameters_json(&m.parameters),
    });
    if let Some(axis) = m.coordinate {
        value["coordinate"] = json!(axis_name(axis));
    }
    if let Some(form) = m.form {
        value["form"] = json!(form);
    }
    if m.variants.len() > 1 {
        let variants = m.variants.iter();
        let variants =
            variants.map(|v| (v.label.clone(), json!(v.log_evidence)));
        value["variants"] = Value::Object(variants.collect::<Map<_, _>>());
    }
    value
}

fn judged_noise_json(noise: &JudgedNoise) -> Value {
    let known = [noise.probability, noise.log10_bayes_factor];
    noise_json(&noise.name, known, &parameters_json(&noise.parameters))
}

/// Sets of terms that do nearly as well, and the single mechanism that the
/// words name as the rival of a single one.
fn rivals(d: &Diagnosis) -> Vec<Rival> {
    let single = single_rival(d).filter(|_| d.selected.len() == 1);
    let single = single.map(|m| Rival {
        names: vec![m.name.clone()],
        log10_bayes_factor: m.log10_bayes_factor,
    });
    d.rivals.iter().cloned().chain(single).collect()
}

fn rival_json(rival: &Rival) -> Value {
    json!({
        "names": rival.names,
        "log10_bayes_factor": rival.log10_bayes_factor,
    })
}

fn force_json(force: &FreeForce) -> Value {
    let whole = force.whole.as_ref().unwrap_or(&force.band);
    let mut out = band_json(whole);
    out["coordinate"] = axis_name(force.axis).into();
    out["at"] = json!(force.at);
    out["beside_law"] = band_json(&force.band);
    out["log10_bayes_factor"] = json!(force.log_bayes_factor / LN_10);
    out
}

fn band_json(band: &Band) -> Value {
    json!({"mean": band.mean, "sd": band.sd, "band": band.width})
}

fn priors_json(priors: &[(String, String)]) -> Value {
    let all = priors.iter().cloned().map(|(name, prior)| (name, prior.into()));
    Value::Object(all.collect())
}

fn baseline_json(b: &Baseline) -> Value {
    json!({
        "friction": b.friction, "noise": b.noise,
        "noise_inferred": b.infers_noise,
        "mechanisms": b.mechanisms,
        "priors": priors_json(&b.priors),
        "log_evidence": b.log_evidence, "rmse": b.rmse,
        "ljung_box_p": b.ljung_box_p, "shapiro_wilk_p": b.shapiro_wilk_p,
        "predictive_p": b.predictive_p, "stationary_sd": b.stationary_sd,
        "innovation_sd": b.innovation_sd, "instrument": b.instrument,
    })
}

fn improvement_json(i: &Improvement) -> Value {
    json!({
        "log10_bayes_factor": i.log10_bayes_factor,
        "rmse_before": i.rmse.before,
        "rmse_after": i.rmse.after,
        "elpd_before": i.elpd.before,
        "elpd_after": i.elpd.after,
        "heldout_rmse_before": i.heldout_rmse.before,
        "heldout_rmse_after": i.heldout_rmse.after,
        "coverage90_before": i.coverage90.before,
        "coverage90_after": i.coverage90.after,
        "ljung_box_p_before": i.ljung_box_p.before,
        "ljung_box_p_after": i.ljung_box_p.after,
        "rmse_least_squares_before": i.least_squares.before,
        "rmse_least_squares_after": i.least_squares.after,
        "stationary_sd_before": i.stationary_sd.before,
        "stationary_sd_after": i.stationary_sd.after,
    })
}

fn corrected_json(corrected: &Corrected) -> Value {
    json!({
        "equation": corrected.equation,
        "model": corrected.model,
        "mechanisms": corrected.labels,
        "noise": corrected.noise,
    })
}

/// Each of several as JSON.
fn list<T>(all: &[T], one: impl Fn(&T) -> Value) -> Value {
    all.iter().map(one).collect()
}

impl Diagnosis {
    /// `diagnosis.json`.
    pub fn json(&self) -> Value {
        let mut document = json!({
            "schema": 2,
            "seed": self.seed,
            "event": self.event,
            "baseline": baseline_json(&self.baseline),
            "verdict": self.verdict.name(),
            "weak": self.weak,
            "quick": self.quick,
            "mismatch": list(&self.mismatch, mismatch_json),
            "mechanisms": list(&self.mechanisms, judged_json),
            "noise": list(&self.noise, judged_noise_json),
            "selected": self.selected,
            "withheld": self.withheld.as_ref().map(|withheld| json!({
                "names": withheld.names,
                "noise": withheld.noise,
                "rmse_before": withheld.rmse.before,
                "rmse_after": withheld.rmse.after,
            })),
            "selected_noise": self.selected_noise,
            "group": self.group,
            "rivals": list(&rivals(self), rival_json),
            "improvement": improvement_json(&self.improvement),
            "parameters": parameters_json(&self.parameters),
            "law": law_json(&self.law),
            "rest": self.rest.as_ref().map(rest_json),
            "corrected": corrected_json(&self.corrected),
            "forces": list(&self.forces, force_json),
            "separating": self.separating,
            "seconds": self.seconds,
            "warnings": self.warnings,
            "notes": self.notes,
            "doubts": self.doubts,
            "words": in_words(self),
        });
        self.origin.write_to(&mut document);
        document
    }
}
