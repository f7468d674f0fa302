//! What a diagnosis found, as plain data; and as `diagnosis.json`.

use std::f64::consts::LN_10;

use serde_json::{Map, Value, json};

use crate::diagnosis::locate::FreeForce;
use crate::draws::Draws;
use crate::mechanism::{Family, Noun};
use crate::physics::forces::Axis;
use crate::predict::Bands;

/// What a diagnosis says of a model and its recordings.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Diagnosis {
    /// The event's name; several, joined by " + ".
    pub event: String,
    /// The model as it was.
    pub baseline: Baseline,
    /// What kind of thing is missing.
    pub verdict: Verdict,
    /// Where simulation and recording differ.
    pub mismatch: Vec<Mismatch>,
    /// Everything that was weighed, most probable first.
    pub mechanisms: Vec<Judged>,
    /// The names of what is added to the model; empty where nothing is.
    pub selected: Vec<String>,
    /// What the recording cannot tell apart.
    pub group: Vec<String>,
    /// Combinations that would do nearly as well as the selected one: within
    /// 1 in log10.
    pub rivals: Vec<Rival>,
    /// What adding it brings.
    pub improvement: Improvement,
    /// The recording that would tell the group apart, in a sentence.
    pub separating: Option<String>,
    /// The corrected model's parameters, the mechanisms' first.
    pub parameters: Vec<Told>,
    /// The corrected model, written out.
    pub corrected: Corrected,
    /// Its posterior draws; those of the model as it was where nothing is
    /// added.
    pub draws: Option<Draws>,
    /// The free-form force over distance, over time, and over speed.
    pub forces: Vec<FreeForce>,
    /// The recordings with what both models predict.
    pub pictured: Vec<Pictured>,
    /// Wall-clock time \[s\].
    pub seconds: f64,
    /// What to know before trusting it.
    pub warnings: Vec<String>,
}

/// The model as it was, and how it stands to the recording.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Baseline {
    /// The friction law.
    pub friction: String,
    /// The noise.
    pub noise: String,
    /// The labels of the mechanisms that it had already.
    pub mechanisms: Vec<String>,
    /// ln p(recording | model).
    pub log_evidence: f64,
    /// Of the posterior mean prediction, in the recording's unit.
    pub rmse: f64,
    /// p of no autocorrelation among the innovations.
    pub ljung_box_p: f64,
    /// p of normal innovations.
    pub shapiro_wilk_p: f64,
    /// Posterior predictive p of the largest residual.
    pub predictive_p: f64,
    /// The standard deviation of the first recording's errors, where each
    /// depends on those before it.
    pub stationary_sd: Option<f64>,
    /// That of their innovations.
    pub innovation_sd: Option<f64>,
    /// The known error of a value, where the recording gives one.
    pub instrument: Option<f64>,
}

/// What kind of thing is missing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing.
    #[default]
    Adequate,
    /// A force.
    MissingPhysics,
    /// The start or the measurement is not as the model has it.
    Measurement,
    /// The errors are.
    Errors,
    /// Something that no mechanism describes.
    Unexplained,
}

impl Verdict {
    /// Its name in `diagnosis.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Adequate => "adequate",
            Self::MissingPhysics => "missing-physics",
            Self::Measurement => "measurement",
            Self::Errors => "noise",
            Self::Unexplained => "unexplained",
        }
    }
}

/// What sort of explanation of a recording something is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Hypothesis {
    /// The model as it was: nothing is missing.
    #[default]
    Baseline,
    /// A mechanism of this family is missing.
    Mechanism(Family),
    /// A force is missing that no mechanism describes.
    Unknown,
}

impl Hypothesis {
    /// Its kind in `diagnosis.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => NONE,
            Self::Mechanism(family) => family.name(),
            Self::Unknown => UNKNOWN,
        }
    }
}

/// The name of the model as it was among the mechanisms.
pub(crate) const NONE: &str = "none";
/// The name of the free-form force among the mechanisms.
pub(crate) const UNKNOWN: &str = "unknown";

/// A stretch in which simulation and recording differ.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Mismatch {
    /// Along what the stretch is given.
    pub axis: Axis,
    /// From and to, in metres on the shared axis or in seconds.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// When the mass comes there \[s\].
    pub time_from: f64,
    /// When it leaves.
    pub time_to: f64,
    /// Where it is, on the shared axis \[m\].
    pub place_from: f64,
    /// Where that ends.
    pub place_to: f64,
    /// The mean force there \[m/s2\]; below 0 it brakes.
    pub specific_force: f64,
    /// Its 5 % quantile.
    pub specific_force_q05: f64,
    /// Its 95 % quantile.
    pub specific_force_q95: f64,
    /// The change of mu that would have the same effect.
    pub delta_mu: f64,
    /// The posterior mass of a force of that sign.
    pub probability: f64,
    /// Runs of one sign that it is made of, where there are several.
    pub parts: Vec<(f64, f64, f64)>,
}

/// A parameter in figures.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Told {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Posterior mean.
    pub mean: f64,
    /// Posterior standard deviation.
    pub sd: f64,
    /// 5 % quantile.
    pub q05: f64,
    /// Median.
    pub q50: f64,
    /// 95 % quantile.
    pub q95: f64,
}

impl Told {
    /// Its own name, where it is a parameter of a mechanism of this name.
    pub(crate) fn within(&self, mechanism: &str) -> Option<&str> {
        self.name.strip_prefix(mechanism)?.strip_prefix('.')
    }
}

/// A mechanism as the evidence judges it.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Judged {
    /// Its name; "none" for the model as it was.
    pub name: String,
    /// What it is called in a sentence.
    pub noun: Noun,
    /// What sort of explanation it is.
    pub kind: Hypothesis,
    /// Its probability.
    pub probability: f64,
    /// ln of its evidence, averaged over its variants.
    pub log_evidence: f64,
    /// The standard error of that.
    pub se: f64,
    /// Against the model as it was.
    pub log10_bayes_factor: f64,
    /// What it says, in one sentence.
    pub says: String,
    /// Along what its best variant acts.
    pub coordinate: Option<Axis>,
    /// In which form.
    pub form: Option<&'static str>,
    /// The best variant's parameters.
    pub parameters: Vec<Told>,
    /// ln of the evidence of each variant, by its label.
    pub variants: Vec<(String, f64)>,
}

/// A combination of mechanisms beside the selected one.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Rival {
    /// Their names.
    pub names: Vec<String>,
    /// Against the model as it was.
    pub log10_bayes_factor: f64,
}

/// Before and after.
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub struct Improvement {
    /// Of the corrected model against the one before.
    pub log10_bayes_factor: f64,
    /// Of the posterior mean prediction, in the recording's unit.
    pub rmse: Pair,
    /// The least error that the motion reaches, whatever priors and noise
    /// say; NaN where it was not searched.
    pub least_squares: Pair,
    /// The standard deviation of the first recording's errors, where each
    /// depends on those before it; NaN where none does.
    pub stationary_sd: Pair,
    /// Expected log predictive density by PSIS-LOO.
    pub elpd: Pair,
    /// Of the last 30 %, predicted from the first 70 %.
    pub heldout_rmse: Pair,
    /// The share of values in the 90 % predictive band.
    pub coverage90: Pair,
    /// p of no autocorrelation among the innovations.
    pub ljung_box_p: Pair,
}

/// A figure before and after.
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub struct Pair {
    /// Of the model as it was.
    pub before: f64,
    /// Of the corrected one.
    pub after: f64,
}

/// The corrected model, written out.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Corrected {
    /// The equation of motion, and what else changed, one line each.
    pub equation: Vec<String>,
    /// Rust to paste.
    pub model: String,
    /// What to write under `mechanisms` in event.toml.
    pub labels: Vec<String>,
}

/// One recording with what both models predict of it.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Pictured {
    /// The event's name.
    pub event: String,
    /// velocity, position or acceleration.
    pub quantity: String,
    /// The recording's unit.
    pub unit: String,
    /// Times \[s\].
    pub times: Vec<f64>,
    /// Recorded values.
    pub values: Vec<f64>,
    /// Where the mass is at those times, on the shared axis \[m\].
    pub places: Vec<f64>,
    /// Predictions of the model as it was.
    pub before: Bands,
    /// Predictions of the corrected model.
    pub after: Bands,
    /// The track: horizontal distance and elevation \[m\].
    pub track: (Vec<f64>, Vec<f64>),
    /// The part of the track that the mismatch covers, in the same
    /// coordinates: x, z of points along it.
    pub marked: Vec<(f64, f64)>,
}

fn axis_name(axis: Axis) -> &'static str {
    match axis {
        Axis::Place => "arclength",
        Axis::Time => "time",
        Axis::Speed => "speed",
    }
}

fn parameters_json(parameters: &[Told]) -> Value {
    let entry = |p: &Told| {
        let value = json!({
            "mean": p.mean, "sd": p.sd, "q05": p.q05, "q50": p.q50,
            "q95": p.q95, "unit": p.unit,
        });
        (p.name.clone(), value)
    };
    Value::Object(parameters.iter().map(entry).collect())
}

fn mismatch_json(m: &Mismatch) -> Value {
    let unit = if m.axis == Axis::Time { "s" } else { "m" };
    let mut value = json!({
        "coordinate": axis_name(m.axis), "from": m.from, "to": m.to,
        "unit": unit, "time_from": m.time_from, "time_to": m.time_to,
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
        let variants = m.variants.iter().map(|(k, v)| (k.clone(), json!(v)));
        value["variants"] = Value::Object(variants.collect::<Map<_, _>>());
    }
    value
}

fn rival_json(rival: &Rival) -> Value {
    json!({
        "names": rival.names,
        "log10_bayes_factor": rival.log10_bayes_factor,
    })
}

fn force_json(force: &FreeForce) -> Value {
    json!({
        "coordinate": axis_name(force.axis), "at": force.at,
        "mean": force.mean, "sd": force.sd, "band": force.width,
        "log10_bayes_factor": force.log_bayes_factor / LN_10,
    })
}

impl Diagnosis {
    /// `diagnosis.json`.
    pub fn json(&self) -> Value {
        let (b, i) = (&self.baseline, &self.improvement);
        json!({
            "schema": 1,
            "event": self.event,
            "baseline": {
                "friction": b.friction, "noise": b.noise,
                "mechanisms": b.mechanisms,
                "log_evidence": b.log_evidence, "rmse": b.rmse,
                "ljung_box_p": b.ljung_box_p,
                "shapiro_wilk_p": b.shapiro_wilk_p,
                "predictive_p": b.predictive_p,
                "stationary_sd": b.stationary_sd,
                "innovation_sd": b.innovation_sd,
                "instrument": b.instrument,
            },
            "verdict": self.verdict.name(),
            "mismatch":
                self.mismatch.iter().map(mismatch_json).collect::<Vec<_>>(),
            "mechanisms":
                self.mechanisms.iter().map(judged_json).collect::<Vec<_>>(),
            "selected": self.selected,
            "group": self.group,
            "rivals": self.rivals.iter().map(rival_json).collect::<Vec<_>>(),
            "improvement": {
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
                "least_squares_before": i.least_squares.before,
                "least_squares_after": i.least_squares.after,
                "stationary_sd_before": i.stationary_sd.before,
                "stationary_sd_after": i.stationary_sd.after,
            },
            "parameters": parameters_json(&self.parameters),
            "corrected": {
                "equation": self.corrected.equation,
                "model": self.corrected.model,
                "mechanisms": self.corrected.labels,
            },
            "forces":
                self.forces.iter().map(force_json).collect::<Vec<_>>(),
            "separating": self.separating,
            "seconds": self.seconds,
            "warnings": self.warnings,
        })
    }
}
