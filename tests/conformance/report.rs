//! What each backend costs on each target, as the tables of
//! `docs/backends.md`.

use couloir::draws::summarise;
use couloir::infer::{BACKENDS, Inference};

use super::targets::{self, Target};
use super::{alarm, complaints, run, seeded};

/// One backend on one target.
struct Cell {
    found: couloir::Result<Inference>,
    /// How it ended, in a word; empty where all is well.
    verdict: &'static str,
}

impl Cell {
    fn of(found: couloir::Result<Inference>, target: &Target) -> Self {
        let verdict = match &found {
            Err(_) => "refuses",
            Ok(found) => {
                let wrong = !complaints(found, target).is_empty();
                match (wrong, alarm(found).is_some()) {
                    (true, false) => "**wrong, silent**",
                    (true, true) => "wrong, warned",
                    (false, true) => "warned",
                    (false, false) => "",
                }
            }
        };
        Self { found, verdict }
    }

    /// The least bulk effective size of any parameter, by what it cost.
    fn per(&self, cost: impl Fn(&Inference) -> f64) -> String {
        let found = match &self.found {
            Ok(found) if !self.verdict.contains("wrong") => found,
            _ => return self.verdict.to_owned(),
        };
        let Some(draws) = &found.draws else { return "-".to_owned() };
        let all = summarise(draws).into_iter().map(|s| s.ess_bulk);
        let figure = all.fold(f64::INFINITY, f64::min) / cost(found);
        let places = usize::from(figure < 10.0);
        format!("{figure:.places$} {}", self.verdict).trim().to_owned()
    }

    /// The error of the evidence and the error it stated.
    fn evidence(&self, target: &Target) -> String {
        let found = self.found.as_ref().ok();
        let evidence = found.and_then(|f| f.evidence.as_ref());
        match (evidence, target.log_evidence) {
            (Some(e), Some(known)) => {
                let warned = !found.is_some_and(|f| f.warnings.is_empty());
                let mark = if warned { " warned" } else { "" };
                format!("{:+.3} ± {:.3}{mark}", e.log - known, e.se)
            }
            _ => "-".to_owned(),
        }
    }

    /// How far below the top the mode lies.
    fn mode(&self, target: &Target) -> String {
        let mode = self.found.as_ref().ok().and_then(|f| f.mode.as_ref());
        match (mode, target.top) {
            (Some(mode), Some(top)) => {
                format!("{:.0e}", (top - mode.log_density).max(0.0))
            }
            _ => "-".to_owned(),
        }
    }
}

/// A table with a row for each target, of the backends named.
fn table(
    rows: &[(Target, Vec<Cell>)],
    backends: &[&str],
    cell: impl Fn(&Cell, &Target) -> String,
) {
    println!("\n| target | {} |", backends.join(" | "));
    println!("|---|{}", "---|".repeat(backends.len()));
    for (target, cells) in rows {
        let entries = BACKENDS.iter().zip(cells);
        let shown = entries.filter(|(e, _)| backends.contains(&e.name));
        let shown: Vec<_> = shown.map(|(_, c)| cell(c, target)).collect();
        if shown.iter().any(|text| text != "-") {
            println!("| {} | {} |", target.name, shown.join(" | "));
        }
    }
}

#[test]
#[ignore = "it prints what docs/backends.md records"]
fn the_table_of_backends() {
    let rows: Vec<(Target, Vec<Cell>)> = targets::all()
        .into_iter()
        .map(|target| {
            let cells = BACKENDS.iter();
            let cells = cells.map(|e| Cell::of(run(e, &target), &target));
            let cells = cells.collect();
            (target, cells)
        })
        .collect();
    let names = |with: fn(&Inference) -> bool| -> Vec<&str> {
        let gives = |i: usize| {
            let mut found =
                rows.iter().filter_map(|r| r.1[i].found.as_ref().ok());
            found.any(with)
        };
        let listed = BACKENDS.iter().enumerate();
        listed.filter(|(i, _)| gives(*i)).map(|(_, e)| e.name).collect()
    };
    let sampling = names(|f| f.draws.is_some());
    println!("\nEffective draws per 1000 evaluations:");
    let evaluations =
        |f: &Inference| (f.cost.densities + f.cost.gradients) as f64 / 1000.0;
    table(&rows, &sampling, |cell, _| cell.per(evaluations));
    println!("\nThousands of effective draws per second:");
    table(&rows, &sampling, |cell, _| {
        cell.per(|found| 1000.0 * found.cost.seconds)
    });
    println!("\nError of ln evidence, and the error stated:");
    let weighing = names(|f| f.evidence.is_some());
    table(&rows, &weighing, Cell::evidence);
    println!("\nHow far below the top the mode was found:");
    table(&rows, &names(|f| f.mode.is_some()), Cell::mode);
}

/// How often a backend is wrong and nothing says so, over seeds: a look at
/// the diagnostics themselves. The variable ONLY ("nuts on banana") leaves the
/// pairs whose names hold it.
#[test]
#[ignore = "some minutes: it prints what docs/backends.md records"]
fn how_often_a_failure_is_silent() {
    let only = std::env::var("ONLY").unwrap_or_default();
    for target in targets::all() {
        for entry in BACKENDS {
            let pair = format!("{} on {}", entry.name, target.name);
            if !pair.contains(&only) {
                continue;
            }
            // Importance sampling costs seconds a run, and quadrature gives
            // the same with any seed but for where its pilot looked.
            let few = ["importance", "quadrature"].contains(&entry.name);
            let seeds = if few { 4 } else { 20 };
            let (mut wrong, mut warned, mut silent) = (0, 0, 0);
            for found in
                (1..=seeds).flat_map(|seed| seeded(entry, &target, seed))
            {
                let bad = !complaints(&found, &target).is_empty();
                let alarmed = alarm(&found).is_some();
                wrong += usize::from(bad);
                warned += usize::from(alarmed);
                silent += usize::from(bad && !alarmed);
            }
            println!(
                "{pair}: of {seeds} seeds {wrong} wrong, {warned} warned, \
                 {silent} silently wrong"
            );
        }
    }
}
