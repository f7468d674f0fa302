//! A diagnosis in a terminal: words, tables and the corrected equation.

use crate::diagnosis::tell::phrases::{
    interval, is_corrected, log10, noise_row, own_name, probability, with_unit,
};
use crate::diagnosis::tell::words::{Row, before_and_after, in_words};
use crate::diagnosis::{Diagnosis, Judged};
use crate::report::digits::beside;
use crate::report::text::{plain, shorten, wrap};
use crate::report::{NoiseRow, noise_lines};

/// The narrowest and the widest summary.
const WIDTHS: (usize, usize) = (44, 80);
/// How many mechanisms the table has.
const MECHANISMS: usize = 8;
/// The widest name of a mechanism.
const NAME: usize = 18;

/// The diagnosis for a terminal, at most `width` characters a line (at least
/// 44, at most 80): the words, the mechanisms, before and after, and the
/// corrected equation.
///
/// ```
/// use couloir::diagnosis::{Diagnosis, summary};
/// let text = summary(&Diagnosis::default(), 80);
/// assert!(text.lines().all(|line| line.chars().count() <= 80));
/// ```
pub fn summary(d: &Diagnosis, width: usize) -> String {
    let width = width.clamp(WIDTHS.0, WIDTHS.1);
    let mut lines = Vec::new();
    for sentence in in_words(d) {
        lines.extend(wrap(&plain(&sentence), width));
    }
    lines.extend(mechanisms(d, width));
    lines.extend(noises(d, width));
    lines.extend(compared(d));
    lines.extend(equation(d, width));
    lines.iter().fold(String::new(), |out, line| {
        out + shorten(line.trim_end(), width).as_str() + "\n"
    })
}

fn mechanisms(d: &Diagnosis, width: usize) -> Vec<String> {
    let shown = &d.mechanisms[..d.mechanisms.len().min(MECHANISMS)];
    if shown.is_empty() {
        return Vec::new();
    }
    let room = width.saturating_sub(NAME + 21);
    let line = |name: &str, p: &str, bf: &str, size: &str| {
        let size = if room < 12 { "" } else { size };
        format!("{name:<NAME$}  {p:>7}  {bf:>8}  {size}")
    };
    let head = line("mechanism", "prob.", "log10 BF", "its size (90 %)");
    let mut lines = vec![String::new(), head, "─".repeat(width)];
    lines.extend(shown.iter().map(|m| {
        line(
            &shorten(&plain(&m.name), NAME),
            &probability(m.probability),
            &log10(m.log10_bayes_factor),
            &fitting(&sizes(m), room),
        )
    }));
    let rest = &d.mechanisms[shown.len()..];
    if !rest.is_empty() {
        let p: f64 = rest.iter().map(|m| m.probability).sum();
        let name = format!("{} more", rest.len());
        lines.push(line(&name, &probability(p), "", ""));
    }
    lines
}

/// The noises that may have made the errors.
fn noises(d: &Diagnosis, width: usize) -> Vec<String> {
    if d.noise.len() < 2 {
        return Vec::new();
    }
    let rows: Vec<NoiseRow> = d.noise.iter().map(noise_row).collect();
    let mut lines = vec![String::new()];
    lines.extend(noise_lines(&rows, width));
    lines
}

/// The main parameter with its interval, and ever shorter: without its name,
/// without its interval.
fn sizes(m: &Judged) -> [String; 3] {
    let Some(p) = m.parameters.first() else { return Default::default() };
    let middle = with_unit(&beside(p.q50, p.sd), &p.unit);
    let name = plain(own_name(p, &m.name));
    let both = format!("{middle} ({})", interval(p));
    [format!("{name} {both}"), both, middle]
}

/// The first of some texts that has room; the last one shortened where none
/// has.
fn fitting(texts: &[String; 3], room: usize) -> String {
    let fits = texts.iter().find(|text| text.chars().count() <= room);
    fits.map_or_else(|| shorten(&texts[2], room), String::clone)
}

fn compared(d: &Diagnosis) -> Vec<String> {
    let rows = before_and_after(d);
    let both = is_corrected(d);
    let widest = rows.iter().map(|r| r.what.chars().count()).max();
    let name = widest.unwrap_or(0).min(26);
    let line = |what: &str, before: &str, after: &str| {
        let what = shorten(what, name);
        let after = if both { after } else { "" };
        format!("{what:<name$}  {before:>8}  {after:>8}")
    };
    let head = if both { line("", "before", "after") } else { String::new() };
    let mut lines = vec![head];
    if both {
        lines.insert(0, String::new());
        lines.push("─".repeat(name + 20));
    }
    let told = |r: &&Row| both || r.before != "n/a";
    let kept = rows.iter().skip(usize::from(!both)).filter(told);
    lines.extend(kept.map(|r| line(&r.what, &r.before, &r.after)));
    lines
}

fn equation(d: &Diagnosis, width: usize) -> Vec<String> {
    let equation = &d.corrected.equation;
    if equation.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![String::new()];
    lines.push(if is_corrected(d) {
        "The corrected model:".to_owned()
    } else {
        "The model:".to_owned()
    });
    for text in equation {
        let text = plain(text);
        // A line that fits keeps the blanks that align it.
        if text.chars().count() + 2 <= width {
            lines.push(format!("  {text}"));
            continue;
        }
        for (i, line) in wrap(&text, width - 6).iter().enumerate() {
            let indent = if i == 0 { "  " } else { "      " };
            lines.push(format!("{indent}{line}"));
        }
    }
    lines
}
