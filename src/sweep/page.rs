//! What came of all events, as a page.

use maud::{Markup, html};

use super::files::{Rows, all};
use super::row::{Cell, Columns, Row};
use super::summary::{Medians, Summary};
use crate::error::Result;
use crate::report::PROGRAM;
use crate::report::digits::{short, significant};
use crate::report::standalone;
use crate::report::text::plain;

/// How many events the page shows one by one: all are in the table beside it,
/// which no browser has to draw.
const SHOWN: usize = 300;

/// From how many bytes on a text is a sentence, which is broken into lines.
const WORDS: usize = 40;

/// How many kinds of failure, and how many events of each.
const FAILURES: [usize; 2] = [50, 10];

/// `sweep.html`: how many events have which verdict, which mechanisms were
/// found and how probable they are, where the parameters lie, what failed and
/// why, and the first events one by one.
///
/// # Errors
/// Rows that cannot be read.
pub fn page(summary: &Summary, rows: Rows<'_>) -> Result<String> {
    let mut first: Vec<Row> = Vec::new();
    // What stands here ends the reading early.
    let read = all(rows, &mut |row| match first.len() {
        SHOWN => Err(std::io::ErrorKind::Interrupted.into()),
        _ => {
            first.push(row.clone());
            Ok(())
        }
    });
    if first.len() < SHOWN.min(summary.events) {
        read.map_err(|e| crate::Error::system(e.to_string()))?;
    }
    let title = format!("{} of {} events", summary.verb, summary.events);
    Ok(standalone(&title, &body(summary, &first)))
}

fn body(summary: &Summary, first: &[Row]) -> Markup {
    html! {
        h1 { "Sweep: " (plain(&summary.verb)) }
        p.sub { (summary.counts()) "." }
        (verdicts(summary))
        (candidates(summary))
        (parameters(summary))
        (failures(summary))
        (events(summary, first))
        p.note { "Computed by " (PROGRAM) "." }
    }
}

/// A bar beside a number, as long as a share.
fn bar(share: f64) -> Markup {
    let width = format!("{:.1}", 100.0 * share.clamp(0.0, 1.0));
    html! {
        td.left {
            svg viewBox="0 0 100 6" width="100%" height="10"
                preserveAspectRatio="none" aria-hidden="true" {
                rect width="100" height="6" fill="#e3e3e3" fill-opacity="0.4" {}
                rect width=(width) height="6" fill="#0072b2" {}
            }
        }
    }
}

fn verdicts(summary: &Summary) -> Markup {
    let done = summary.done().max(1) as f64;
    html! {
        @if !summary.verdicts.is_empty() {
            h2 { "Verdicts" }
            div.wide {
                table {
                    tr { th { "verdict" } th { "events" } th.left { "share" } }
                    @for (verdict, events) in &summary.verdicts {
                        tr {
                            td { (plain(verdict)) }
                            td { (events) }
                            (bar(*events as f64 / done))
                        }
                    }
                }
            }
        }
    }
}

fn heading(kind: &str) -> String {
    let mut letters = kind.chars();
    let first = letters.next().map(|c| c.to_ascii_uppercase());
    first.into_iter().chain(letters).chain(['s']).collect()
}

fn candidates(summary: &Summary) -> Markup {
    let ranked = summary.ranked();
    html! {
        @if !ranked.is_empty() {
            h2 { (heading(summary.kind())) }
            div.wide {
                table {
                    tr {
                        th { (summary.kind()) } th { "selected" }
                        th { "mean probability" } th.left { "" }
                    }
                    @for (name, seen) in ranked {
                        tr {
                            td { (plain(name)) }
                            td { (seen.times_selected(name)) }
                            td { (format!("{:.3}", seen.mean())) }
                            (bar(seen.mean()))
                        }
                    }
                }
            }
            p.note {
                "The mean is over the events in which the " (summary.kind())
                " was weighed."
            }
        }
    }
}

fn parameters(summary: &Summary) -> Markup {
    let row = |name: &str, medians: &Medians| {
        let quantiles = medians.quantiles().map(|x| short(x, 3));
        html! {
            tr {
                td { (plain(name)) }
                @for quantile in quantiles { td { (quantile) } }
                td.left { (plain(&medians.unit)) }
            }
        }
    };
    html! {
        @if !summary.parameters.is_empty() {
            h2 { "Parameters" }
            div.wide {
                table {
                    tr {
                        th { "parameter" } th { "5 %" } th { "50 %" }
                        th { "95 %" } th.left { "unit" }
                    }
                    @for (name, medians) in &summary.parameters {
                        (row(name, medians))
                    }
                }
            }
            p.note {
                "Below which shares of the events' posterior medians lie: \
                 how events differ, and not how well one is known."
            }
        }
    }
}

fn failures(summary: &Summary) -> Markup {
    let [kinds, shown] = FAILURES;
    html! {
        @if !summary.failures.is_empty() {
            h2 { "What failed" }
            div.wide {
                table {
                    tr { th { "events" } th.left { "why" } th.left { "which" } }
                    @for (why, events) in summary.failures.iter().take(kinds) {
                        tr {
                            td { (events.len()) }
                            td.said { (plain(why)) }
                            td.said {
                                (plain(&events[..events.len().min(shown)].join(", ")))
                                @if events.len() > shown {
                                    " and " (events.len() - shown) " more"
                                }
                            }
                        }
                    }
                }
            }
            @if summary.failures.len() > kinds {
                p.note {
                    "And " (summary.failures.len() - kinds) " more messages, \
                     in sweep.json."
                }
            }
        }
    }
}

/// The first events one by one.
fn events(summary: &Summary, first: &[Row]) -> Markup {
    let columns = Columns {
        candidates: Vec::new(),
        parameters: summary.columns().parameters,
    };
    let names = columns.names();
    let cell = |cell: &Cell| match cell {
        Cell::Text(text) if text.len() > WORDS => {
            html! { td.said { (plain(text)) } }
        }
        Cell::Text(text) => html! { td.word { (plain(text)) } },
        Cell::Number(Some(number)) => {
            html! { td { (significant(*number, 3)) } }
        }
        Cell::Number(None) => html! { td {} },
    };
    html! {
        h2 { "Events" }
        @if summary.events > first.len() {
            p.note {
                "The first " (first.len()) " of " (summary.events)
                "; all are in sweep.csv."
            }
        }
        div.wide {
            table {
                tr { @for name in &names { th { (plain(name)) } } }
                @for row in first {
                    tr { @for one in columns.cells(row) { (cell(&one)) } }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::files::summed;
    use super::super::journal::Outcome;
    use super::*;

    #[test]
    fn it_shows_the_first_events_and_no_markup_of_theirs() {
        let done = json!({"verdict": "adequate", "mechanisms": [
            {"name": "<b>", "probability": 0.5}]});
        let rows = |each: &mut dyn FnMut(&Row) -> std::io::Result<()>| {
            for of in 0..2 * SHOWN {
                let event = format!("<script>{of}</script>");
                let outcome = match of {
                    0 => Outcome::Failed("<i>".to_owned()),
                    _ => Outcome::Done(done.clone()),
                };
                if each(&Row { event, task: None, outcome: Some(outcome) })
                    .is_err()
                {
                    return Err(crate::Error::system("ended"));
                }
            }
            Ok(())
        };
        let summary = summed("diagnose", &rows).unwrap();
        let page = page(&summary, &rows).unwrap();
        assert!(page.contains("The first 300 of 600"));
        assert_eq!(page.matches("&lt;script&gt;").count(), SHOWN + 1);
        for tag in ["<script>0", "<b>", "<i>"] {
            assert!(!page.contains(tag), "{tag}");
        }
    }
}
