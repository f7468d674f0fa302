//! `couloir bench`: every backend on one event, side by side.

use clap::Args;
use serde_json::json;

use super::answer::{Answer, pretty, wrapped};
use super::progress::Told;
use super::results::Output;
use super::study::{Read, priors_of};
use super::{Subject, Work, width};
use crate::draws::summarise;
use crate::error::Result;
use crate::infer::{BACKENDS, Inference, infer};
use crate::model::Posterior;
use crate::physics::friction::Laws;
use crate::seed::Seed;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    #[command(flatten)]
    work: Work,
    #[command(flatten)]
    output: Output,
}

/// What one backend did.
struct Row {
    name: &'static str,
    found: Inference,
    /// The smallest bulk ESS of any parameter.
    effective: Option<f64>,
    rhat: Option<f64>,
}

impl Row {
    fn per_second(&self) -> Option<f64> {
        self.effective.map(|e| e / self.found.cost.seconds)
    }

    fn per_simulation(&self) -> Option<f64> {
        self.effective.map(|e| e / self.found.cost.simulations as f64)
    }
}

impl Arguments {
    pub(super) fn run(
        &self,
        laws: &Laws,
        told: &Told,
        typed: &str,
    ) -> Result<Answer> {
        let results =
            self.output.ready(&["bench.json"], self.subject.paths())?;
        let Read { model, said, .. } = self.subject.named(laws)?;
        let origin = self.subject.origin(typed)?;
        let posterior = Posterior::new(&model)?;
        let mut rows = Vec::new();
        for entry in BACKENDS {
            let backend = self.work.backend(entry.name)?;
            let seed = Seed::new(self.work.seed);
            let found = infer(backend.as_ref(), &posterior, seed, told)?;
            rows.push(row(entry.name, found));
        }
        told.finish();
        let name = model.event().name();
        let mut document = self.document(name, &rows);
        document["priors"] = priors_of(&model).into();
        origin.write_to(&mut document);
        said.write_to(&mut document);
        let document = pretty(&document);
        let wrote =
            results.write(|| Ok(vec![("bench.json", document.clone())]));
        let title = format!("{name}: {}, {}", model.friction(), model.noise());
        let text = match self.output.json {
            true => document,
            false => tell(&title, &rows) + &said.lines(),
        };
        Ok(Answer::from(text).after(wrote))
    }

    fn document(&self, event: &str, rows: &[Row]) -> serde_json::Value {
        let backends: Vec<_> = rows
            .iter()
            .map(|row| {
                json!({
                    "backend": row.name,
                    "seconds": row.found.cost.seconds,
                    "simulations": row.found.cost.simulations,
                    "ess_min": row.effective,
                    "ess_per_second": row.per_second(),
                    "ess_per_simulation": row.per_simulation(),
                    "rhat_max": row.rhat,
                    "log_evidence": row.found.evidence.as_ref().map(|e| {
                        json!({"value": e.log, "se": e.se})
                    }),
                    "mode_log_density":
                        row.found.mode.as_ref().map(|m| m.log_density),
                    "warnings": warnings(row),
                })
            })
            .collect();
        json!({
            "schema": 1,
            "event": event,
            "seed": self.work.seed,
            "backends": backends,
        })
    }
}

fn warnings(row: &Row) -> Vec<&String> {
    row.found.warnings.iter().chain(&row.found.hints).collect()
}

fn row(name: &'static str, found: Inference) -> Row {
    let summaries = match &found.draws {
        Some(draws) if found.summaries.is_empty() => Some(summarise(draws)),
        Some(_) => Some(found.summaries.clone()),
        None => None,
    };
    let least = |f: fn(&crate::draws::Summary) -> f64| {
        summaries.as_ref().map(|s| s.iter().map(f).fold(f64::NAN, f64::min))
    };
    let most = summaries
        .as_ref()
        .map(|s| s.iter().map(|s| s.rhat).fold(f64::NAN, f64::max));
    Row { name, effective: least(|s| s.ess_bulk), rhat: most, found }
}

/// A backend's line of the table.
fn line(row: &Row) -> String {
    let number = |x: Option<f64>, digits: usize| {
        x.filter(|x| x.is_finite())
            .map_or("-".to_owned(), |x| format!("{x:.digits$}"))
    };
    let evidence = row
        .found
        .evidence
        .as_ref()
        .map_or("-".into(), |e| format!("{:.2} ± {:.2}", e.log, e.se));
    format!(
        "{:15} {:7.2} {:9} {:>7} {:>8} {:>8} {:>6} {:>16}\n",
        row.name,
        row.found.cost.seconds,
        row.found.cost.simulations,
        number(row.effective, 0),
        number(row.per_second(), 0),
        number(row.per_simulation(), 4),
        number(row.rhat, 3),
        evidence,
    )
}

fn tell(title: &str, rows: &[Row]) -> String {
    let mut text = wrapped(title, width());
    text.push_str(&format!(
        "\n{:15} {:>7} {:>9} {:>7} {:>8} {:>8} {:>6} {:>16}\n",
        "backend",
        "s",
        "sims",
        "ESS",
        "ESS/s",
        "ESS/sim",
        "R-hat",
        "ln evidence"
    ));
    for row in rows {
        text.push_str(&line(row));
    }
    for row in rows {
        if let Some(mode) = &row.found.mode {
            text.push_str(&format!(
                "\n{}: mode with ln(prior x likelihood) = {:.4}\n",
                row.name, mode.log_density
            ));
        }
    }
    text.push('\n');
    for row in rows {
        for warning in warnings(row) {
            let line = format!("Warning, {}: {warning}", row.name);
            text.push_str(&wrapped(&line, width()));
        }
    }
    text.push_str("ESS: the least of any parameter's bulk effective draws.\n");
    text
}
