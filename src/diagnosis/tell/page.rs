//! The diagnosis as one HTML page that needs no network; without its script it
//! says the same.

use maud::{Markup, html};

use crate::diagnosis::tell::phrases::{
    called, friction, interval, is_corrected, is_unsure, noise_row,
    probability, with_unit,
};
use crate::diagnosis::tell::pictures::{
    Figure, bars, forces, left_over, of_event,
};
use crate::diagnosis::tell::words::{before_and_after, in_words};
use crate::diagnosis::{
    Diagnosis, Hypothesis, Judged, LawParameters, ParameterSummary, Pictured,
    Verdict,
};
use crate::report::digits::{beside, significant};
use crate::report::text::{capital, is_synthetic, plain, unit};
use crate::report::{drawn, how_computed, noise_table, standalone};

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
            (answer(d))
            @for (i, p) in d.pictured.iter().enumerate() {
                (recorded(d, p, i))
            }
            (details(d))
            @for (i, p) in d.pictured.iter().enumerate() {
                (on_track(d, p, i))
            }
            (section(force_title(d.verdict), forces(d)))
            (section("What is left", left_over(d)))
            (section("What may be missing", bars(d)))
            (mechanisms(d))
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

/// How many sentences the first screen has: the verdict, where, and what
/// explains it; and that it is a quick look, where it is.
fn first_sentences(d: &Diagnosis) -> usize {
    3 + usize::from(d.quick)
}

/// The verdict and the sentences that everybody reads.
fn answer(d: &Diagnosis) -> Markup {
    let words = in_words(d);
    let first = &words[..words.len().min(first_sentences(d))];
    html! {
        p class={ "verdict " (d.verdict.name()) } {
            strong { (headline(d)) }
            @if d.quick { " " span.mark { "quick look" } }
            @if d.weak { " " span.mark { "weak" } }
        }
        @for sentence in first { p.lead { (unbroken(sentence)) } }
    }
}

/// All other sentences.
fn details(d: &Diagnosis) -> Markup {
    let words = in_words(d);
    let further = words.get(first_sentences(d)..).unwrap_or_default();
    html! {
        @if !further.is_empty() {
            h2 { "In detail" }
            ul.words {
                @for sentence in further { li { (unbroken(sentence)) } }
            }
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

fn headline(d: &Diagnosis) -> &'static str {
    match d.verdict {
        Verdict::Adequate if d.too_few().is_some() => "Too few values to tell",
        Verdict::Adequate if is_unsure(d) => "Nothing is sure to be missing",
        Verdict::Adequate => "Nothing is missing",
        Verdict::MissingPhysics => "Physics is missing",
        Verdict::Measurement => "The start or the measurement is off",
        Verdict::Errors => "The errors are of another kind",
        Verdict::Unexplained => "Something is missing that has no name",
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

/// What a picture of one recording is called.
fn title(d: &Diagnosis, p: &Pictured, what: &str) -> String {
    match d.pictured.len() > 1 {
        true => format!("{what}: {}", plain(&p.event)),
        false => what.to_owned(),
    }
}

/// A recording with what the models predict of it.
fn recorded(d: &Diagnosis, p: &Pictured, i: usize) -> Markup {
    let what = match p.after.times.is_empty() {
        true => "Recording and prediction",
        false => "Recording and prediction, before and after",
    };
    let [_, recording] = of_event(d, p, i);
    section(&title(d, p, what), recording)
}

/// A track with what was located on it.
fn on_track(d: &Diagnosis, p: &Pictured, i: usize) -> Markup {
    let what = if p.is_marked() { "Where" } else { "The track" };
    let [track, _] = of_event(d, p, i);
    section(&title(d, p, what), track)
}

/// A picture under its heading, with its caption.
fn section(title: &str, figure: Option<Figure>) -> Markup {
    let Some(figure) = figure else { return html! {} };
    html! {
        h2 { (title) }
        figure id=(figure.id) {
            (drawn(&figure.svg, &figure.phone))
            figcaption { (figure.caption) }
        }
    }
}

/// The likeliest mechanisms: what they are called, how large they are, and
/// the names that programs use.
fn mechanisms(d: &Diagnosis) -> Markup {
    let told = |m: &&Judged| {
        m.kind != Hypothesis::Baseline
            && (m.probability >= 0.01 || d.selected.contains(&m.name))
    };
    let told: Vec<&Judged> = d.mechanisms.iter().filter(told).collect();
    if told.is_empty() {
        return html! {};
    }
    html! {
        div.wide { table {
            thead { tr {
                th scope="col" { "what" }
                th scope="col" { "probability" }
                th.left scope="col" { "how much (90 % interval)" }
                th.left scope="col" { "name for programs" }
            } }
            tbody { @for m in told {
                tr {
                    td.name { (capital(&called(m))) }
                    td { (probability(m.probability)) }
                    td.said { (sizes(&m.parameters)) }
                    td.left { code { (plain(&m.name)) } }
                }
            } }
        } }
    }
}

/// The noises that may have made the errors.
fn noises(d: &Diagnosis) -> Markup {
    let rows: Vec<_> =
        d.noise.iter().map(|n| (noise_row(n), sizes(&n.parameters))).collect();
    noise_table(
        &rows,
        "Each averaged over what may be missing; the Bayes factor is against \
         the noise that the event names.",
    )
}

/// Parameters with their 90 % intervals.
fn sizes(parameters: &[ParameterSummary]) -> String {
    let one = |p: &ParameterSummary| {
        let middle = with_unit(&beside(p.q50, p.sd), &p.unit);
        format!("{} {middle} ({})", plain(&p.name), interval(p))
    };
    let all: Vec<_> = parameters.iter().map(one).collect();
    all.join(", ").replace('-', "−")
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
