//! What a diagnosis found, as plain data.

use std::collections::BTreeMap;

use crate::diagnosis::hypothesis::Hypothesis;
use crate::diagnosis::locate::FreeForce;
use crate::draws::{Draws, Summary};
use crate::mechanism::Noun;
use crate::physics::forces::Axis;
use crate::predict::Bands;
use crate::report::Origin;

/// What a diagnosis says of a model and its recordings.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Diagnosis {
    /// Where it comes from.
    pub origin: Origin,
    /// The seed of every random draw.
    pub seed: u64,
    /// The event's name; several, joined by " + ".
    pub event: String,
    /// The model as it was.
    pub baseline: Baseline,
    /// What kind of thing is missing.
    pub verdict: Verdict,
    /// Whether evidence and fit disagree, or the recording does not rule out
    /// that nothing is missing.
    pub weak: bool,
    /// Whether a quick look had to do.
    pub quick: bool,
    /// The odds beforehand that were given, by name, against 1 for each other.
    pub odds: BTreeMap<String, f64>,
    /// Where simulation and recording differ.
    pub mismatch: Vec<Mismatch>,
    /// Everything that was weighed, most probable first.
    pub mechanisms: Vec<Judged>,
    /// The noises that may have made the errors, most probable first.
    pub noise: Vec<JudgedNoise>,
    /// The names of what is added to the model; empty where nothing is.
    pub selected: Vec<String>,
    /// What is not added although the evidence asks for it, since the fit
    /// would be worse.
    pub withheld: Option<Withheld>,
    /// The noise of the corrected model.
    pub selected_noise: String,
    /// What the recording cannot tell apart.
    pub group: Vec<String>,
    /// Combinations that would do nearly as well as the selected one: within
    /// 1 in log10.
    pub rivals: Vec<Rival>,
    /// What adding it brings.
    pub improvement: Improvement,
    /// The recording that would tell most beside this one, in a sentence: what
    /// tells the group apart or, of one name, whether it is that.
    pub separating: Option<String>,
    /// The corrected model's parameters, the mechanisms' first.
    pub parameters: Vec<ParameterSummary>,
    /// The friction law's parameters, whatever else may act.
    pub law: LawParameters,
    /// The force that is left beside what was selected; `None` where the
    /// free-form force itself was.
    pub rest: Option<Rest>,
    /// The same as a force over distance.
    pub left: Option<FreeForce>,
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
    /// How the recordings were thinned, and whether that matters, in
    /// sentences.
    pub notes: Vec<String>,
    /// Those of the warnings for which its figures should not be used.
    pub doubts: Vec<String>,
}

impl Diagnosis {
    /// How many values there are for how many unknowns, where there are no
    /// more of the ones than of the others: the model then explains them
    /// whatever is missing.
    pub(crate) fn too_few(&self) -> Option<String> {
        let values: usize = self.pictured.iter().map(|p| p.values.len()).sum();
        let unknowns = self.baseline.priors.len();
        let many = if values == 1 { "" } else { "s" };
        (values > 0 && values <= unknowns)
            .then(|| format!("{values} value{many} for {unknowns} unknowns"))
    }

    /// Warns of too few values; its warnings are then reasons not to use it.
    pub(super) fn doubt(&mut self) {
        let few = self.too_few().map(|few| {
            format!("so few values tell nothing of what is missing: {few}")
        });
        self.warnings.extend(few);
        self.doubts = self.warnings.clone();
    }
}

/// What evidence asks for and the fit speaks against.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Withheld {
    /// The names of the mechanisms; empty where only other errors are.
    pub names: Vec<String>,
    /// The noise that has the evidence.
    pub noise: String,
    /// The root mean square error without and with them \[recorded unit\].
    pub rmse: BeforeAfter,
}

/// The model as it was, and how it stands to the recording.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Baseline {
    /// The friction law.
    pub friction: String,
    /// The noise.
    pub noise: String,
    /// Whether it stands in for one that was to be inferred.
    pub infers_noise: bool,
    /// The labels of the mechanisms that it had already.
    pub mechanisms: Vec<String>,
    /// The priors of its parameters, by their names.
    pub priors: Vec<(String, String)>,
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

/// The posterior of a parameter, summarised.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct ParameterSummary {
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

impl ParameterSummary {
    /// That of a column of draws.
    pub(crate) fn of(column: &Summary) -> Self {
        Self {
            name: column.name.clone(),
            unit: column.unit.clone(),
            mean: column.mean,
            sd: column.sd,
            q05: column.q05,
            q50: column.q50,
            q95: column.q95,
        }
    }

    /// The median where the 90 % interval has one sign; else NaN, since nothing
    /// is told of a sign then.
    pub(crate) fn signed(&self) -> f64 {
        if self.q05 * self.q95 > 0.0 { self.q50 } else { f64::NAN }
    }

    /// The same under its own name, where it is of a mechanism of this name.
    pub(crate) fn named_within(self, mechanism: &str) -> Self {
        let name = self.within(mechanism).unwrap_or(&self.name).to_owned();
        Self { name, ..self }
    }

    /// Its own name, where it is a parameter of a mechanism of this name.
    pub(crate) fn within(&self, mechanism: &str) -> Option<&str> {
        self.name.strip_prefix(mechanism)?.strip_prefix('.')
    }
}

/// The friction law's parameters: what is missing from a model spoils those
/// that it has.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct LawParameters {
    /// As calibrated with nothing added.
    pub as_it_was: Vec<ParameterSummary>,
    /// With what was selected; empty where nothing is added.
    pub corrected: Vec<ParameterSummary>,
    /// With a force of free form in the model, along any axis: what can be said
    /// of them when the rest of the physics is left open.
    pub with_free_form_force: Vec<ParameterSummary>,
}

/// A force of free form on top of a model, as a size.
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub struct Rest {
    /// Its root mean square along the run \[m/s2\].
    pub specific_force_sd: f64,
    /// The 95 % quantile of its size, over the run and its draws \[m/s2\].
    pub specific_force_q95: f64,
}

impl Rest {
    /// That of a force's draws.
    pub(crate) fn of(force: &FreeForce) -> Self {
        let mut sizes: Vec<f64> =
            force.draws.iter().flatten().map(|f| f.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let count = sizes.len().max(1);
        let square = sizes.iter().map(|f| f * f).sum::<f64>();
        let last = (0.95 * (count - 1) as f64) as usize;
        Self {
            specific_force_sd: (square / count as f64).sqrt(),
            specific_force_q95: sizes.get(last).copied().unwrap_or(f64::NAN),
        }
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
    pub parameters: Vec<ParameterSummary>,
    /// Its variants.
    pub variants: Vec<Variant>,
}

/// A variant of a mechanism: over distance or over time, or in another form.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Variant {
    /// What to write under `mechanisms` in event.toml.
    pub label: String,
    /// Along what it acts.
    pub coordinate: Option<Axis>,
    /// ln of its evidence.
    pub log_evidence: f64,
}

/// A noise as the evidence judges it.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct JudgedNoise {
    /// Its name, as event files have it.
    pub name: String,
    /// Whether large errors are more common than a normal law has them.
    pub has_tails: bool,
    /// Whether its size changes along the recording.
    pub grows: bool,
    /// Its probability among those that are kept; each parameter makes it e
    /// times less probable beforehand.
    pub probability: f64,
    /// Against the noise that the model names, without those odds.
    pub log10_bayes_factor: f64,
    /// Its parameters.
    pub parameters: Vec<ParameterSummary>,
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

/// What the corrected model brings, against the model as it was.
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub struct Improvement {
    /// Of the corrected model against the one before.
    pub log10_bayes_factor: f64,
    /// Of the posterior mean prediction, in the recording's unit.
    pub rmse: BeforeAfter,
    /// The least error that the motion reaches, whatever priors and noise
    /// say; NaN where it was not searched.
    pub least_squares: BeforeAfter,
    /// The standard deviation of the first recording's errors, where each
    /// depends on those before it; NaN where none does.
    pub stationary_sd: BeforeAfter,
    /// Expected log predictive density by PSIS-LOO.
    pub elpd: BeforeAfter,
    /// Of the last 30 %, predicted from the first 70 %.
    pub heldout_rmse: BeforeAfter,
    /// The share of values in the 90 % predictive band.
    pub coverage90: BeforeAfter,
    /// p of no autocorrelation among the innovations.
    pub ljung_box_p: BeforeAfter,
}

/// A figure of both models.
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub struct BeforeAfter {
    /// Of the model as it was.
    pub before: f64,
    /// Of the corrected one.
    pub after: f64,
}

/// By what share an error must grow to be worse: below it a posterior mean of
/// some hundred draws says nothing.
const WORSE: f64 = 0.01;

impl BeforeAfter {
    /// Whether an error grows by more than its own uncertainty.
    pub(crate) fn grows(&self) -> bool {
        self.after > (1.0 + WORSE) * self.before
    }
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
    /// What to write as `noise` there, where it is another.
    pub noise: Option<String>,
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
    /// Times \[s\], on the clock that events share.
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
    /// The part of the track that each mismatch covers, in the same
    /// coordinates: x, z of points along it; none where it is off the track.
    pub marked: Vec<Vec<(f64, f64)>>,
}

impl Pictured {
    /// Whether any mismatch is on its track.
    pub(crate) fn is_marked(&self) -> bool {
        self.marked.iter().any(|stretch| !stretch.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_is_told_where_the_interval_has_one() {
        let of = |q05: f64, q50: f64, q95: f64| {
            let (name, unit, mean, sd) =
                (String::new(), String::new(), q50, 1.0);
            ParameterSummary { name, unit, mean, sd, q05, q50, q95 }.signed()
        };
        assert_eq!(of(1.0, 2.0, 3.0), 2.0);
        assert_eq!(of(-3.0, -2.0, -1.0), -2.0);
        assert!(of(-0.1, 2.0, 3.0).is_nan());
        assert!(of(0.0, 2.0, 3.0).is_nan());
    }
}
