//! The whole report as one HTML page that needs no network; without its script
//! it says the same.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::digits::{
    NONE, beside, grouped, p_value, per_cent, significant, whole,
};
use super::svg::{Picture, pictures};
use super::text::{law as law_called, plain, unit};
use super::words::sentences;
use super::{CalibrationReport, NoiseReport, NoiseRow, ParameterReport};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// `report.html`: the result in words, the table, the pictures, and how all
/// of it was computed.
///
/// ```
/// use couloir::report::{CalibrationReport, page};
/// let html = page(&CalibrationReport::default());
/// assert!(html.starts_with("<!DOCTYPE html>"));
/// ```
pub fn page(report: &CalibrationReport) -> String {
    let title = format!("{}: calibration", plain(&report.event));
    let (first, others): (Vec<Picture>, Vec<Picture>) =
        pictures(report).into_iter().partition(|p| p.name == "recording");
    standalone(
        &title,
        &html! {
            (heading(report))
            (answer(report))
            @for picture in &first { (figure(picture)) }
            (details(report))
            (table(&report.parameters))
            (noises(report))
            (law(report))
            @for picture in &others { (figure(picture)) }
            (computed(report))
        },
    )
}

/// A page of one file, with the style that all pages share.
pub(crate) fn standalone(title: &str, body: &Markup) -> String {
    let whole = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport"
                    content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (body)
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    whole.into_string()
}

fn heading(report: &CalibrationReport) -> Markup {
    html! {
        h1 { (plain(&report.event)) }
        p.sub {
            @if report.synthetic { span.synthetic { "synthetic data" } " " }
            "Calibration of " (law_called(&report.friction)) " friction with "
            (plain(report.errors_told())) " errors" (plain(&report.terms())) " on " (plain(&report.quantity))
        }
    }
}

/// How many sentences come first: whether it fits, what was calibrated, and
/// the law's parameters.
const FIRST: usize = 3;

fn answer(report: &CalibrationReport) -> Markup {
    let words = sentences(report);
    html! {
        @for sentence in words.iter().take(FIRST) {
            p.lead { (unbroken(sentence)) }
        }
        @if !report.warnings.is_empty() {
            div.warning role="note" {
                strong { "Warnings" }
                ul {
                    @for warning in &report.warnings {
                        li { (plain(warning)) }
                    }
                }
            }
        }
    }
}

/// All other sentences.
fn details(report: &CalibrationReport) -> Markup {
    let words = sentences(report);
    html! {
        @if words.len() > FIRST {
            h2 { "In detail" }
            ul.words {
                @for sentence in words.iter().skip(FIRST) {
                    li { (unbroken(sentence)) }
                }
            }
        }
    }
}

/// The sentence with numbers kept on one line with what belongs to them.
fn unbroken(sentence: &str) -> String {
    let sentence = plain(sentence).replace(" %", "\u{a0}%");
    sentence
        .replace(" p = ", " p\u{a0}=\u{a0}")
        .replace("R-hat", "R\u{2011}hat")
}

fn table(parameters: &[ParameterReport]) -> Markup {
    html! {
        h2 { "Parameters" }
        @if parameters.is_empty() { p { "No parameters." } } @else {
            div.wide { table {
                thead { tr {
                    th scope="col" { "parameter" }
                    @for heading in ["median", "mean", "sd", "90 % interval",
                        "mode", "R-hat", "ESS"] {
                        th scope="col" { (heading) }
                    }
                } }
                tbody { @for p in parameters { (row(p)) } }
            } }
            p.note {
                "Of the posterior: sd, the standard deviation; the interval \
                 from the 5 % to the 95 % quantile; mode, the most probable \
                 values together. R-hat: 1 where the chains agree, up to \
                 1.01 is fine. ESS: how many independent draws the chains \
                 are worth, 400 or more are enough."
            }
        }
    }
}

/// The noises that the calibration was averaged over.
fn noises(report: &CalibrationReport) -> Markup {
    let row = |n: &NoiseReport| (n.row(), sizes(&n.parameters));
    let rows: Vec<_> = report.noises.iter().map(row).collect();
    noise_table(
        &rows,
        "The parameters of the motion are averaged over these; those of the \
         errors, the mode, the draws in the pictures, the checks and the \
         predictions are of the first. The Bayes factor is against errors \
         that are correlated in time.",
    )
}

/// A table of noises, each with its parameters, and what it is; nothing where
/// there are none.
pub(crate) fn noise_table(rows: &[(NoiseRow, String)], note: &str) -> Markup {
    const HEADINGS: [&str; 4] =
        ["noise", "probability", "log10 Bayes factor", "parameters"];
    if rows.is_empty() {
        return html! {};
    }
    html! {
        h2 { "What made the errors" }
        div.wide { table {
            thead { tr {
                @for heading in HEADINGS { th scope="col" { (heading) } }
            } }
            tbody { @for (noise, sizes) in rows { tr {
                td.name { (plain(&noise.name)) }
                td { (noise.probability) }
                td { (noise.factor.replace('-', "−")) }
                td { (sizes.replace('-', "−")) }
            } } }
        } }
        p.note { (note) }
    }
}

/// Parameters with their 90 % intervals, in one line.
fn sizes(parameters: &[ParameterReport]) -> String {
    let one = |p: &ParameterReport| {
        let of = |x| beside(x, p.sd);
        let unit = match p.unit_shown().as_str() {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let (middle, low, high) = (of(p.q50), of(p.q05), of(p.q95));
        format!("{} {middle}{unit} ({low} to {high})", plain(&p.name))
    };
    let all: Vec<String> = parameters.iter().map(one).collect();
    all.join(", ")
}

/// The law's parameters, without and with a force of free form.
fn law(report: &CalibrationReport) -> Markup {
    let Some(law) = &report.law else { return html! {} };
    let rows = [
        ("as calibrated", &law.as_it_was),
        ("with a force of free form", &law.with_free_form_force),
    ];
    html! {
        h2 { "The friction law, whatever else may act" }
        div.wide { table {
            tbody { @for (which, parameters) in rows { tr {
                td.name { (which) }
                td { (sizes(parameters).replace('-', "−")) }
            } } }
        } }
    }
}

fn row(p: &ParameterReport) -> Markup {
    let number = |x: f64| beside(x, p.sd).replace('-', "−");
    let rhat = match p.rhat {
        x if x.is_finite() => format!("{x:.3}"),
        _ => NONE.to_owned(),
    };
    let mode = p.map.map_or("–".to_owned(), number);
    html! {
        tr {
            td.name {
                (plain(&p.name))
                @if !p.unit_shown().is_empty() {
                    " [" (p.unit_shown()) "]"
                }
            }
            td { (number(p.q50)) }
            td { (number(p.mean)) }
            td { (number(p.sd)) }
            td { (number(p.q05)) " to " (number(p.q95)) }
            td { (mode) }
            td { (rhat) }
            td { (whole(p.ess_bulk.min(p.ess_tail))) }
        }
    }
}

/// A picture for a page, and where there is one for a narrow screen.
pub(crate) fn drawn(page: &str, phone: &str) -> Markup {
    html! {
        div.wide.page[!phone.is_empty()] { (PreEscaped(page)) }
        @if !phone.is_empty() { div.phone { (PreEscaped(phone)) } }
    }
}

/// A picture under its heading, with its caption.
pub(crate) fn figure(picture: &Picture) -> Markup {
    html! {
        h2 { (picture.title) }
        figure id=(picture.name) {
            (drawn(&picture.svg, &picture.phone))
            figcaption { (picture.caption) }
        }
    }
}

fn computed(report: &CalibrationReport) -> Markup {
    let priors = report.parameters.iter();
    let priors = priors.map(|p| (p.name.clone(), p.prior_text.clone()));
    how_computed(&facts(report), &priors.collect::<Vec<_>>())
}

/// What a result comes from, and the priors, each by what it is called.
pub(crate) fn how_computed(
    facts: &[(String, String)],
    priors: &[(String, String)],
) -> Markup {
    let list = |all: &[(String, String)]| {
        html! {
            dl {
                @for (term, text) in all {
                    dt { (plain(term)) }
                    dd { (plain(text)) }
                }
            }
        }
    };
    html! {
        h2 { "How it was computed" }
        (list(facts))
        @if !priors.is_empty() {
            h3 { "Priors" }
            (list(priors))
        }
    }
}

/// What a reader needs to repeat the run and to judge it.
fn facts(report: &CalibrationReport) -> Vec<(String, String)> {
    let c = &report.checks;
    let seconds = significant(report.seconds, 3);
    let mut out = vec![
        ("friction", report.friction.clone()),
        ("errors", report.noise.clone()),
        ("recording", recording(report)),
        ("backend", report.backend_told()),
        ("seed", report.seed.to_string()),
        ("simulations", grouped(report.simulations)),
        ("duration", format!("{seconds} s")),
        (
            "residual error",
            format!("{} {}", significant(c.rmse, 3), unit(&report.unit)),
        ),
        ("values in the 90 % band", per_cent(c.coverage90)),
        ("Ljung-Box p", p_value(c.ljung_box_p)),
        ("Shapiro-Wilk p", p_value(c.shapiro_wilk_p)),
        ("Kolmogorov-Smirnov p", p_value(c.kolmogorov_smirnov_p)),
    ];
    if !report.acceptance.is_empty() {
        let rates: Vec<_> =
            report.acceptance.iter().map(|a| per_cent(*a)).collect();
        out.push(("acceptance by chain", rates.join(", ")));
    }
    if let Some(e) = &report.evidence {
        let (value, se) = (significant(e.value, 5), significant(e.se, 2));
        let text = format!("{value}, standard error {se} ({})", e.method);
        out.push(("log evidence", text));
    }
    let out = out.into_iter().map(|(term, text)| (term.to_owned(), text));
    report.origin.facts().into_iter().chain(out).collect()
}

fn recording(report: &CalibrationReport) -> String {
    let window = match report.window {
        w if w > 0.0 => {
            format!("means over {} s", significant(w, 3))
        }
        _ => "instantaneous".to_owned(),
    };
    format!(
        "{} values of {} [{}], {window}",
        report.values.len(),
        report.quantity,
        unit(&report.unit)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture;

    #[test]
    fn the_page_stands_alone() {
        let html = page(&fixture::calibration());
        let inner = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for outside in ["http", "//", "<link", "@import", "src=", "fetch("] {
            assert!(!inner.contains(outside), "{outside}");
        }
        assert!(html.contains("<html lang=\"en\">"));
        assert!(html.contains("synthetic data"));
        // Each for a page and for a phone.
        assert_eq!(html.matches("<svg").count(), 16);
        assert_eq!(html.matches("<figcaption>").count(), 8);
    }

    #[test]
    fn identifiers_are_unique() {
        let html = page(&fixture::calibration());
        fixture::assert_unique_ids(&html);
    }
}
