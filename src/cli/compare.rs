//! `couloir compare`: models of one event by their evidence.

use clap::Args;
use serde_json::json;

use super::calibrate::{pretty, wrapped};
use super::progress::Told;
use super::study::assemble;
use super::{Output, Subject, Work, backend_name, width};
use crate::error::{Error, Result};
use crate::infer::{Evidence, backend, infer};
use crate::io::write_all;
use crate::model::Posterior;
use crate::physics::friction::Laws;
use crate::seed::Seed;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// A model, "friction, noise", such as "voellmy, ar(1)"; give it twice or
    /// more; the first is the one the others are compared with
    #[arg(long = "model", value_name = "MODEL", required = true)]
    models: Vec<String>,
    #[command(flatten)]
    work: Work,
    /// Backend with an evidence: smc, importance, bridge or reciprocal
    #[arg(long, default_value = "smc", value_parser = backend_name)]
    backend: String,
    #[command(flatten)]
    output: Output,
}

/// One model's part of a comparison.
struct Compared {
    friction: String,
    noise: String,
    evidence: Evidence,
    simulations: u64,
    warnings: Vec<String>,
}

impl Arguments {
    pub(super) fn run(&self, laws: &Laws) -> Result<String> {
        if self.models.len() < 2 {
            return Err(Error::input(
                "a comparison needs two models or more: give --model \
                 \"voellmy, iid\" --model \"voellmy, ar(1)\"",
            ));
        }
        let told = Told::new();
        let compared = self
            .models
            .iter()
            .map(|text| self.evidence(text, laws, &told))
            .collect::<Result<Vec<_>>>()?;
        drop(told);
        let event = self.subject.load(laws)?.event.name().to_owned();
        let document = pretty(&self.document(&event, &compared));
        if let Some(folder) = &self.output.out {
            write_all(folder, &[("comparison.json", document.clone())])?;
        }
        if self.output.json {
            return Ok(document);
        }
        Ok(tell(&event, &compared))
    }

    fn evidence(
        &self,
        text: &str,
        laws: &Laws,
        told: &Told,
    ) -> Result<Compared> {
        let (friction, noise) = text.split_once(',').ok_or_else(|| {
            Error::input(format!(
                "--model {text:?}: expected a friction law and a noise with a \
                 comma between, such as \"voellmy, ar(1)\""
            ))
        })?;
        let model = assemble(
            self.subject.load(laws)?,
            laws,
            Some(friction.trim().to_owned()),
            Some(noise.trim().to_owned()),
        )?;
        let posterior = Posterior::new(&model)?;
        let backend = backend(&self.backend, &self.work.effort()?)?;
        let seed = Seed::new(self.work.seed);
        let found = infer(backend.as_ref(), &posterior, seed, told)?;
        let evidence = found.evidence.ok_or_else(|| {
            Error::input(format!(
                "backend {} gives no evidence; use smc, importance, bridge \
                 or reciprocal",
                self.backend
            ))
        })?;
        Ok(Compared {
            friction: model.friction(),
            noise: model.noise(),
            evidence,
            simulations: found.cost.simulations,
            warnings: found.warnings,
        })
    }

    fn document(
        &self,
        event: &str,
        compared: &[Compared],
    ) -> serde_json::Value {
        let models: Vec<_> = compared
            .iter()
            .map(|c| {
                let (factor, se) = log10_factor(c, &compared[0]);
                json!({
                    "friction": c.friction,
                    "noise": c.noise,
                    "log_evidence": {
                        "value": c.evidence.log,
                        "se": c.evidence.se,
                        "method": c.evidence.method,
                    },
                    "log10_bayes_factor": {"value": factor, "se": se},
                    "simulations": c.simulations,
                    "warnings": c.warnings,
                })
            })
            .collect();
        json!({
            "schema": 1,
            "event": event,
            "backend": self.backend,
            "seed": self.work.seed,
            "models": models,
        })
    }
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
    text.push_str(&format!(
        "\n{:34} {:>20} {:>20}\n",
        "model", "ln evidence", "log10 Bayes factor"
    ));
    for c in compared {
        let (factor, se) = log10_factor(c, &compared[0]);
        let name = format!("{}, {}", c.friction, c.noise);
        let factor = if std::ptr::eq(c, &compared[0]) {
            "-".to_owned()
        } else {
            format!("{factor:.3} +- {se:.3}")
        };
        let evidence =
            format!("{:.3} +- {:.3}", c.evidence.log, c.evidence.se);
        if name.chars().count() > 34 {
            text.push_str(&format!("{name}\n{:34}", ""));
        } else {
            text.push_str(&format!("{name:34}"));
        }
        text.push_str(&format!(" {evidence:>20} {factor:>20}\n"));
    }
    text.push('\n');
    for c in &compared[1..] {
        let (factor, _) = log10_factor(c, &compared[0]);
        let (for_it, against) =
            if factor >= 0.0 { (c, &compared[0]) } else { (&compared[0], c) };
        text.push_str(&wrapped(
            &format!(
                "Evidence for {}, {} against {}, {}: {} (Kass and Raftery \
                 1995).",
                for_it.friction,
                for_it.noise,
                against.friction,
                against.noise,
                in_words(factor)
            ),
            width,
        ));
    }
    for c in compared {
        for warning in &c.warnings {
            let line =
                format!("Warning, {}, {}: {warning}", c.friction, c.noise);
            text.push_str(&wrapped(&line, width));
        }
    }
    text
}
