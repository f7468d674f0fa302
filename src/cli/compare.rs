//! `couloir compare`: models of one event by their evidence, and by how well
//! they predict.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Map, Value, json};

use super::answer::{Answer, pretty, wrapped};
use super::predictive::{self, Predicted};
use super::progress::Told;
use super::results::Output;
use super::said::Said;
use super::study::{NoDepth, assemble, priors_of};
use super::{Subject, Work, at_least_one, backend_giving, width};
use crate::draws::{Lfo, Loo};
use crate::elpd;
use crate::error::{Error, Result};
use crate::infer::{Backend, Evidence, Inference, Progress, infer};
use crate::model::{Assembled, Posterior};
use crate::noise;
use crate::physics::friction::Laws;
use crate::report::Origin;
use crate::seed::Seed;
use crate::spelling::quoted;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// A model, "friction, noise", such as "voellmy, ar(1)"; give it twice or
    /// more; the first is the one the others are compared with. The event's
    /// mechanisms stay, unless a third part names others, or none:
    /// "voellmy, iid, friction-patch + surge"
    #[arg(long = "model", value_name = "MODEL", required = true)]
    models: Vec<String>,
    #[command(flatten)]
    work: Work,
    /// Backend with an evidence: smc, importance, laplace-mixture, bridge or
    /// reciprocal
    #[arg(long, default_value = "smc", value_parser = with_evidence)]
    backend: String,
    /// Predict each value from those before it as well (leave-future-out),
    /// fitting again where need be
    #[arg(long)]
    lfo: bool,
    /// How many values --lfo takes as known at first; a third of them where
    /// not given
    #[arg(long, value_name = "N", requires = "lfo", value_parser = at_least_one)]
    lfo_from: Option<usize>,
    #[command(flatten)]
    output: Output,
}

fn with_evidence(name: &str) -> Result<String, String> {
    let purpose = "gives no evidence with draws, which models are compared by";
    backend_giving(name, purpose, |gives| gives.draws && gives.evidence)
}

/// One model's part of a comparison.
struct Compared {
    friction: String,
    noise: String,
    mechanisms: Vec<String>,
    priors: Map<String, Value>,
    evidence: Evidence,
    loo: Loo,
    lfo: Option<Lfo>,
    simulations: u64,
    warnings: Vec<String>,
}

impl Compared {
    fn name(&self) -> String {
        let own = format!("{}, {}", self.friction, self.noise);
        match self.mechanisms.is_empty() {
            true => own,
            false => format!("{own}, {}", self.mechanisms.join(" + ")),
        }
    }

    fn document(&self, first: &Self) -> serde_json::Value {
        let (factor, se) = log10_factor(self, first);
        let mut document = json!({
            "friction": self.friction,
            "noise": self.noise,
            "priors": self.priors,
            "log_evidence": {
                "value": self.evidence.log,
                "se": self.evidence.se,
                "method": self.evidence.method,
            },
            "log10_bayes_factor": {"value": factor, "se": se},
            "simulations": self.simulations,
            "warnings": self.warnings,
        });
        if !self.mechanisms.is_empty() {
            document["mechanisms"] = json!(self.mechanisms);
        }
        document
    }
}

/// A comparison with what it is of.
struct Found {
    event: String,
    origin: Origin,
    compared: Vec<Compared>,
    said: Said,
}

/// By leave-one-out.
fn left_out(compared: &[Compared]) -> Vec<Predicted<'_>> {
    compared.iter().map(|c| Predicted::left_out(c.name(), &c.loo)).collect()
}

/// By leave-future-out; nothing where it was not asked for.
fn ahead(compared: &[Compared]) -> Vec<Predicted<'_>> {
    compared
        .iter()
        .filter_map(|c| Some(Predicted::ahead(c.name(), c.lfo.as_ref()?)))
        .collect()
}

impl Arguments {
    /// The events that are named.
    pub(super) fn paths(&self) -> &[PathBuf] {
        self.subject.paths()
    }

    pub(super) fn run(
        &self,
        laws: &Laws,
        told: &Told,
        typed: &str,
    ) -> Result<Answer> {
        let files = ["comparison.json"];
        let results = self.output.ready(&files, self.subject.paths())?;
        let found = self.found(laws, told, typed)?;
        told.finish();
        let document = pretty(&self.json(&found));
        let wrote =
            results.write(|| Ok(vec![("comparison.json", document.clone())]));
        let text = match self.output.json {
            true => document,
            false => tell(&found.event, &found.compared) + &found.said.lines(),
        };
        Ok(Answer::from(text).after(wrote))
    }

    /// `comparison.json` alone.
    pub(super) fn document(
        &self,
        laws: &Laws,
        progress: &dyn Progress,
    ) -> Result<Value> {
        self.found(laws, progress, "").map(|found| self.json(&found))
    }

    /// Refuses a law or a noise that would be of no model.
    fn refuse_one_model(&self) -> Result<()> {
        let Subject { friction, noise, .. } = &self.subject;
        let given = [("--friction", friction), ("--noise", noise)];
        match given.into_iter().find(|(_, given)| given.is_some()) {
            None => Ok(()),
            Some((name, _)) => Err(Error::input(format!(
                "{name} has no effect here; expected laws and noises in \
                 --model, such as --model \"voellmy, iid\": drop it"
            ))),
        }
    }

    /// The event's models, compared. All that can be wrong with one of them
    /// is told before any is worked on.
    fn found(
        &self,
        laws: &Laws,
        progress: &dyn Progress,
        typed: &str,
    ) -> Result<Found> {
        self.refuse_one_model()?;
        if self.models.len() < 2 {
            return Err(Error::input(
                "a comparison needs two models or more: give --model \
                 \"voellmy, iid\" --model \"voellmy, ar(1)\"",
            ));
        }
        let file = self.subject.load(laws)?;
        let event = file.event.name().to_owned();
        let mut said = Said::of(&file);
        let origin = self.subject.origin(typed)?;
        let models = self.models.iter().map(|text| self.model(text, laws));
        let compared = models
            .collect::<Result<Vec<_>>>()?
            .iter()
            .map(|model| self.compared(model, progress))
            .collect::<Result<Vec<_>>>()?;
        let depth = NoDepth::of(&file);
        for c in &compared {
            said.note(depth.note(&c.friction, laws));
        }
        Ok(Found { event, origin, compared, said })
    }

    fn compared(
        &self,
        model: &Assembled,
        progress: &dyn Progress,
    ) -> Result<Compared> {
        let posterior = Posterior::new(model)?;
        let backend = self.work.backend(&self.backend)?;
        let seed = Seed::new(self.work.seed);
        let found = infer(backend.as_ref(), &posterior, seed, progress)?;
        let (evidence, loo) = self.judged(&found, &posterior)?;
        let lfo = self.predicted_ahead(model, backend.as_ref(), progress)?;
        Ok(Compared {
            friction: model.friction(),
            noise: model.noise(),
            mechanisms: model.labels(),
            priors: priors_of(model),
            evidence,
            loo,
            lfo,
            simulations: found.cost.simulations,
            warnings: [found.warnings, found.hints].concat(),
        })
    }

    /// The model that an argument names.
    fn model(&self, text: &str, laws: &Laws) -> Result<Assembled> {
        let mut parts = text.splitn(3, ',');
        let (Some(friction), Some(noise)) = (parts.next(), parts.next())
        else {
            return Err(Error::input(format!(
                "--model {text:?}: expected a friction law and a noise with a \
                 comma between, such as \"voellmy, ar(1)\""
            )));
        };
        let mechanisms = parts.next().map(named);
        let mut file = self.subject.load(laws)?;
        let own = || -> Result<Assembled> {
            file.friction = laws.parse(friction.trim())?;
            file.noise = noise::parse(noise.trim())?;
            assemble(file, laws, None, None, mechanisms)
        };
        let at = format!("--model {}", quoted(text));
        own().map_err(|error| error.within(at))
    }

    /// The evidence and the leave-one-out prediction of what was found.
    fn judged(
        &self,
        found: &Inference,
        posterior: &Posterior<'_>,
    ) -> Result<(Evidence, Loo)> {
        let both = found.evidence.clone().zip(found.draws.as_ref());
        let (evidence, draws) = both.ok_or_else(|| {
            Error::input(format!(
                "backend {} gives no evidence; use smc, importance, bridge \
                 or reciprocal",
                self.backend
            ))
        })?;
        Ok((evidence, elpd::leave_one_out(posterior, draws)?))
    }

    /// Leave-future-out, where it is asked for.
    fn predicted_ahead(
        &self,
        model: &Assembled,
        backend: &dyn Backend,
        progress: &dyn Progress,
    ) -> Result<Option<Lfo>> {
        if !self.lfo {
            return Ok(None);
        }
        let values = model.event().recordings().map(|s| s.len()).sum();
        let least = self.lfo_from.unwrap_or_else(|| elpd::least_for(values));
        let seed = Seed::new(self.work.seed).child(1);
        elpd::leave_future_out(model, backend, least, seed, progress)
            .map(Some)
            .map_err(|error| error.within("--lfo"))
    }

    /// `comparison.json`.
    fn json(&self, found: &Found) -> Value {
        let Found { event, origin, compared, said } = found;
        let mut models: Vec<_> =
            compared.iter().map(|c| c.document(&compared[0])).collect();
        let (loo, lfo) = (left_out(compared), ahead(compared));
        for (key, found) in [("loo", loo), ("lfo", lfo)] {
            let parts = predictive::documents(&found);
            for (model, part) in models.iter_mut().zip(parts) {
                model[key] = part;
            }
        }
        let mut document = json!({
            "schema": 1,
            "event": event,
            "backend": self.backend,
            "seed": self.work.seed,
            "models": models,
        });
        origin.write_to(&mut document);
        said.write_to(&mut document);
        document
    }
}

/// The mechanisms of a sum such as "friction-patch + surge", or of "none".
fn named(sum: &str) -> Vec<String> {
    let names = sum.split('+').map(|name| name.trim().to_owned());
    names.filter(|name| name != "none").collect()
}

/// log10 of the Bayes factor of a model against another, with its error.
fn log10_factor(model: &Compared, against: &Compared) -> (f64, f64) {
    if std::ptr::eq(model, against) {
        return (0.0, 0.0);
    }
    let ln10 = std::f64::consts::LN_10;
    let se = model.evidence.se.hypot(against.evidence.se);
    ((model.evidence.log - against.evidence.log) / ln10, se / ln10)
}

/// What a log10 Bayes factor is worth (Kass, Raftery 1995).
fn in_words(log10: f64) -> &'static str {
    match log10.abs() {
        x if x < 0.5 => "not worth more than a bare mention",
        x if x < 1.0 => "substantial",
        x if x <= 2.0 => "strong",
        _ => "decisive",
    }
}

fn tell(event: &str, compared: &[Compared]) -> String {
    let width = width();
    let mut text = wrapped(event, width);
    text.push_str(&table(compared));
    text.push('\n');
    for c in &compared[1..] {
        text.push_str(&wrapped(&verdict(c, &compared[0]), width));
    }
    for c in compared {
        for warning in &c.warnings {
            let line = format!("Warning, {}: {warning}", c.name());
            text.push_str(&wrapped(&line, width));
        }
    }
    text.push_str(&predictive::tell(&left_out(compared), width));
    text.push_str(&predictive::tell(&ahead(compared), width));
    text
}

fn table(compared: &[Compared]) -> String {
    let mut text = format!(
        "\n{:34} {:>20} {:>20}\n",
        "model", "ln evidence", "log10 Bayes factor"
    );
    for c in compared {
        let (factor, se) = log10_factor(c, &compared[0]);
        let name = c.name();
        let factor = if std::ptr::eq(c, &compared[0]) {
            "-".to_owned()
        } else {
            format!("{factor:.3} ± {se:.3}")
        };
        let evidence = format!("{:.3} ± {:.3}", c.evidence.log, c.evidence.se);
        if name.chars().count() > 34 {
            text.push_str(&format!("{name}\n{:34}", ""));
        } else {
            text.push_str(&format!("{name:34}"));
        }
        text.push_str(&format!(" {evidence:>20} {factor:>20}\n"));
    }
    text
}

fn verdict(model: &Compared, first: &Compared) -> String {
    let (factor, _) = log10_factor(model, first);
    let (for_it, against) =
        if factor >= 0.0 { (model, first) } else { (first, model) };
    format!(
        "Evidence for {} against {}: {} (Kass and Raftery 1995).",
        for_it.name(),
        against.name(),
        in_words(factor)
    )
}
