//! The diagnosis as one HTML page that needs no network and no script.

use maud::{Markup, PreEscaped, html};

use crate::diagnosis::tell::phrases::{
    friction, interval, is_corrected, noise_row, with_unit,
};
use crate::diagnosis::tell::pictures::{Figure, bars, forces, of_event};
use crate::diagnosis::tell::words::{before_and_after, in_words};
use crate::diagnosis::{
    Diagnosis, Hypothesis, JudgedNoise, LawParameters, ParameterSummary,
    Pictured, Verdict,
};
use crate::report::digits::{beside, significant};
use crate::report::text::{is_synthetic, plain, unit};
use crate::report::{how_computed, noise_table, standalone};

/// `report.html` of a diagnosis: in words first, then what was located, both
/// models on the recordings, the evidence, and the corrected model.
///
/// ```
/// use couloir::diagnosis::{Diagnosis, page};
/// let html = page(&Diagnosis::default());
/// assert!(html.starts_with("<!DOCTYPE html>"));
/// ```
pub fn page(d: &Diagnosis) -> String {
    let title = format!("{}: diagnosis", plain(&d.event));
    standalone(
        &title,
        &html! {
            (heading(d))
            (words(d))
            @for (i, p) in d.pictured.iter().enumerate() {
                (pictured(d, p, i))
            }
            (section(force_title(d.verdict), forces(d)))
            (section("What may be missing", bars(d)))
            (sentences(d))
            (noises(d))
            (corrected(d))
            (compared(d))
            (parameters(d))
            (computed(d))
        },
    )
}

fn heading(d: &Diagnosis) -> Markup {
    let noise = d.baseline.noise.trim();
    html! {
        h1 { (plain(&d.event)) }
        p.sub {
            @if is_synthetic(&d.event) { span.synthetic { "synthetic data" } " " }
            "What is missing from " (friction(&d.baseline))
            @if !noise.is_empty() { " with " (plain(noise)) " errors" }
        }
    }
}

fn words(d: &Diagnosis) -> Markup {
    html! {
        p { strong { (headline(d.verdict)) } }
        ul.words {
            @for sentence in in_words(d) { li { (unbroken(&sentence)) } }
        }
        @if !d.warnings.is_empty() {
            div.warning role="note" {
                strong { "Warnings" }
                ul {
                    @for warning in &d.warnings { li { (plain(warning)) } }
                }
            }
        }
    }
}

fn force_title(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::MissingPhysics | Verdict::Unexplained => {
            "The force that is missing"
        }
        _ => "Whether a force is missing",
    }
}

fn headline(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Adequate => "Verdict: adequate, nothing is missing",
        Verdict::MissingPhysics => "Verdict: missing physics",
        Verdict::Measurement => "Verdict: the start or the measurement is off",
        Verdict::Errors => "Verdict: errors of another kind",
        Verdict::Unexplained => "Verdict: unexplained",
    }
}

/// The sentence with numbers kept on one line with what belongs to them.
fn unbroken(sentence: &str) -> String {
    let mut out = plain(sentence).replace(" p = ", " p\u{a0}=\u{a0}");
    for unit in ["%", "m/s²", "m/s", "m ", "m)", "s ", "s)"] {
        for digit in '0'..='9' {
            let (from, to) =
                (format!("{digit} {unit}"), format!("{digit}\u{a0}{unit}"));
            out = out.replace(&from, &to);
        }
    }
    out
}

/// The pictures of one recording.
fn pictured(d: &Diagnosis, p: &Pictured, i: usize) -> Markup {
    let several = d.pictured.len() > 1;
    let title = |what: &str| match several {
        true => format!("{what}: {}", plain(&p.event)),
        false => what.to_owned(),
    };
    let place = if p.marked.is_empty() { "The track" } else { "Where" };
    let prediction = match p.after.times.is_empty() {
        true => "Recording and prediction",
        false => "Recording and prediction, before and after",
    };
    let [track, recording] = of_event(d, p, i);
    html! {
        (section(&title(place), track))
        (section(&title(prediction), recording))
    }
}

/// A picture under its heading, with its caption.
fn section(title: &str, figure: Option<Figure>) -> Markup {
    let Some(figure) = figure else { return html! {} };
    html! {
        h2 { (title) }
        figure id=(figure.id) {
            div.wide { (PreEscaped(&figure.svg)) }
            figcaption { (figure.caption) }
        }
    }
}

/// What the likeliest mechanisms say.
fn sentences(d: &Diagnosis) -> Markup {
    let told: Vec<_> = d
        .mechanisms
        .iter()
        .filter(|m| !m.says.is_empty() && m.kind != Hypothesis::Baseline)
        .filter(|m| m.probability >= 0.01 || d.selected.contains(&m.name))
        .take(5)
        .collect();
    html! {
        @if !told.is_empty() {
            h3 { "What they say" }
            dl { @for m in told {
                dt { (plain(&m.name)) }
                dd { (plain(&m.says)) }
            } }
        }
    }
}

/// The noises that may have made the errors.
fn noises(d: &Diagnosis) -> Markup {
    let rows: Vec<_> =
        d.noise.iter().map(|n| (noise_row(n), sizes(n))).collect();
    noise_table(
        &rows,
        "Each averaged over what may be missing; the Bayes factor is against \
         the noise that the event names.",
    )
}

/// A noise's parameters with their 90 % intervals.
fn sizes(noise: &JudgedNoise) -> String {
    let one = |p: &ParameterSummary| {
        let middle = with_unit(&beside(p.q50, p.sd), &p.unit);
        format!("{} {middle} ({})", plain(&p.name), interval(p))
    };
    noise.parameters.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn corrected(d: &Diagnosis) -> Markup {
    let c = &d.corrected;
    let written = !c.labels.is_empty() || c.noise.is_some();
    if c.equation.is_empty() && c.model.is_empty() && !written {
        return html! {};
    }
    let fixed = is_corrected(d);
    html! {
        h2 { @if fixed { "The corrected model" } @else { "The model" } }
        @if !c.equation.is_empty() {
            pre.equation { (lines(&c.equation.join("\n"))) }
        }
        @if !c.model.is_empty() {
            h3 { "In Rust" }
            pre { code { (lines(&c.model)) } }
        }
        @if written {
            h3 { "In event.toml" }
            pre { code { (lines(&event_lines(d))) } }
        }
    }
}

/// Text of several lines, safe to show.
fn lines(text: &str) -> String {
    text.lines().map(plain).collect::<Vec<_>>().join("\n")
}

/// What to write into event.toml; a string of TOML escapes as one of JSON.
fn event_lines(d: &Diagnosis) -> String {
    let quoted: Vec<String> = d
        .corrected
        .labels
        .iter()
        .map(|label| serde_json::json!(label).to_string())
        .collect();
    let noise = d
        .corrected
        .noise
        .as_ref()
        .map(|noise| format!("noise = {}\n", serde_json::json!(noise)));
    let noise = noise.unwrap_or_default();
    format!("[model]\n{noise}mechanisms = [{}]", quoted.join(", "))
}

fn compared(d: &Diagnosis) -> Markup {
    let both = is_corrected(d);
    let rows = before_and_after(d);
    let told =
        |r: &&crate::diagnosis::tell::words::Row| both || r.before != "n/a";
    html! {
        h2 { @if both { "Before and after" } @else { "The fit" } }
        div.wide { table {
            thead { tr {
                th scope="col" { "" }
                th scope="col" { @if both { "before" } @else { "now" } }
                @if both { th scope="col" { "after" } }
            } }
            tbody {
                @for r in rows.iter().skip(usize::from(!both)).filter(told) {
                    tr {
                        td.name { (r.what) }
                        td { (r.before.replace('-', "−")) }
                        @if both { td { (r.after.replace('-', "−")) } }
                    }
                }
            }
        } }
        p.note {
            "RMSE: root mean square of recording minus mean prediction. \
             Last 30 %: predicted from the first 70 %. elpd: expected log \
             density of values left out one by one; higher is better. Nine \
             of ten values belong in the 90 % band. Ljung-Box p: below 0.05 \
             the residuals still have a memory."
        }
    }
}

fn parameters(d: &Diagnosis) -> Markup {
    if d.parameters.is_empty() {
        return html! {};
    }
    html! {
        h2 { "Parameters" }
        div.wide { table {
            thead { tr {
                @for heading in
                    ["parameter", "median", "mean", "sd", "90 % interval"]
                {
                    th scope="col" { (heading) }
                }
            } }
            tbody { @for p in &d.parameters { (row(p)) } }
        } }
        (law(d))
        p.note {
            "Of the posterior: sd, the standard deviation; the interval \
             from the 5 % to the 95 % quantile."
        }
    }
}

/// The law's parameters in three models, side by side.
fn law(d: &Diagnosis) -> Markup {
    let LawParameters { as_it_was, corrected, with_free_form_force } = &d.law;
    if with_free_form_force.is_empty() {
        return html! {};
    }
    let of = |all: &[ParameterSummary], name: &str| {
        let found = all.iter().find(|p| p.name == name);
        let told = |p: &ParameterSummary| {
            format!("{} ({})", beside(p.q50, p.sd), interval(p))
        };
        found.map_or("–".to_owned(), told).replace('-', "−")
    };
    html! {
        h3 { "The friction law, whatever else acts" }
        div.wide { table {
            thead { tr {
                @for heading in
                    ["parameter", "as it was", "corrected", "with any force"]
                {
                    th scope="col" { (heading) }
                }
            } }
            tbody { @for p in as_it_was {
                tr {
                    td.name { (named(p)) }
                    @for all in
                        [as_it_was, corrected, with_free_form_force]
                    {
                        td { (of(all, &p.name)) }
                    }
                }
            } }
        } }
    }
}

/// A parameter's name with its unit.
fn named(p: &ParameterSummary) -> String {
    match unit(&p.unit).as_str() {
        "" => plain(&p.name),
        unit => format!("{} [{unit}]", plain(&p.name)),
    }
}

fn row(p: &ParameterSummary) -> Markup {
    let number = |x: f64| beside(x, p.sd).replace('-', "−");
    html! {
        tr {
            td.name { (named(p)) }
            td { (number(p.q50)) }
            td { (number(p.mean)) }
            td { (number(p.sd)) }
            td { (number(p.q05)) " to " (number(p.q95)) }
        }
    }
}

fn computed(d: &Diagnosis) -> Markup {
    let values: usize = d.pictured.iter().map(|p| p.values.len()).sum();
    let log = significant(d.baseline.log_evidence, 5).replace('-', "−");
    let seconds = significant(d.seconds, 3);
    let mut own = vec![
        ("seed", d.seed.to_string()),
        ("log evidence before", log),
        ("duration", format!("{seconds} s")),
    ];
    if values > 0 {
        let recordings = d.pictured.len();
        let many = if recordings > 1 { "s" } else { "" };
        let told = format!("{values} in {recordings} recording{many}");
        own.insert(1, ("recorded values", told));
    }
    let own = own.into_iter().map(|(term, text)| (term.to_owned(), text));
    let facts: Vec<_> = d.origin.facts().into_iter().chain(own).collect();
    how_computed(&facts, &d.baseline.priors)
}
