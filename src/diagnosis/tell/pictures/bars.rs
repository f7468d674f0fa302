//! Mechanisms as bars of probability, with their Bayes factors.

use super::figure::Figure;
use crate::diagnosis::tell::phrases::{called, log10, probability};
use crate::diagnosis::{Diagnosis, Hypothesis, Judged};
use crate::mechanism::Family;
use crate::report::svg::axes::{Axes, Key, Labels, Scale, legend};
use crate::report::svg::canvas::{
    Anchor, Canvas, FONT, Frame, Sheet, text_width,
};
use crate::report::svg::palette::{FAINT, GREY, INK, Pen};
use crate::report::text::{capital, shorten};

/// How many mechanisms have a bar.
const SHOWN: usize = 12;
const ROW: f64 = 40.0;
/// Where bars begin, and how far from the right they and the first column of
/// numbers end.
const LEFT: f64 = 12.0;
const BESIDE: f64 = 164.0;
const COLUMN: f64 = 84.0;
/// Where the second column ends, from the right.
const LAST: f64 = 14.0;

/// The mechanisms, most probable first; nothing where none was weighed.
pub(crate) fn bars(d: &Diagnosis) -> Option<Figure> {
    Figure::both(|sheet| drawn(d, sheet))
}

fn drawn(d: &Diagnosis, sheet: Sheet) -> Option<Figure> {
    let shown = &d.mechanisms[..d.mechanisms.len().min(SHOWN)];
    if shown.is_empty() {
        return None;
    }
    let head = 2.0 * FONT + 46.0;
    let height = head + ROW * shown.len() as f64 + 52.0;
    let mut canvas = Canvas::on(sheet, "mechanisms", height);
    legend(&mut canvas, 12.0, 2.0, &entries(shown));
    let bottom = height - 52.0;
    let (right, width) = (sheet.width() - BESIDE, sheet.width());
    let frame = Frame { left: LEFT, right, top: head, bottom };
    let axes = Axes {
        frame,
        x: Scale { low: 0.0, high: 1.0 },
        y: Scale { low: 0.0, high: 1.0 },
    };
    grid(&mut canvas, &axes);
    axes.draw(&mut canvas, Labels { x: Some("probability"), y: None });
    for (text, x) in [("prob.", width - COLUMN), ("log10 BF", width - LAST)] {
        canvas.text((x, head - 8.0), Anchor::End, GREY, text);
    }
    for (i, m) in shown.iter().enumerate() {
        row(&mut canvas, &axes, d, m, head + ROW * i as f64);
    }
    Some(Figure {
        id: "mechanisms".to_owned(),
        caption: caption(d),
        phone: String::new(),
        svg: canvas.finish("The probability of each mechanism"),
    })
}

fn grid(canvas: &mut Canvas, axes: &Axes) {
    for p in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0] {
        let ends = (axes.at(p, 0.0), axes.at(p, 1.0));
        canvas.line(ends.0, ends.1, Pen::new(FAINT, 1.0));
    }
}

fn row(canvas: &mut Canvas, axes: &Axes, d: &Diagnosis, m: &Judged, top: f64) {
    let width = canvas.width();
    let letters = ((width - LEFT - LAST) / text_width("n")) as usize;
    let (at, name) = ((LEFT, top + FONT), capital(&called(m)));
    let name = shorten(&name, letters);
    if d.selected.contains(&m.name) {
        canvas.bold(at, Anchor::Start, &name);
    } else {
        canvas.text(at, Anchor::Start, INK, &name);
    }
    let p = if m.probability.is_finite() { m.probability } else { 0.0 };
    let left = axes.frame.left;
    // No bar is quite invisible.
    let right = axes.at(p.clamp(0.0, 1.0), 0.0).0.max(left + 1.5);
    let base = top + ROW - 9.0;
    let (top, bottom) = (top + FONT + 7.0, top + ROW - 6.0);
    let bar = Frame { left, top, right, bottom };
    canvas.rectangle(bar, style(m.kind).1, 1.0);
    let text = probability(m.probability);
    canvas.text((width - COLUMN, base), Anchor::End, INK, &text);
    let text = match m.kind {
        Hypothesis::Baseline => "0".to_owned(),
        _ => log10(m.log10_bayes_factor).replace('-', "−"),
    };
    canvas.text((width - LAST, base), Anchor::End, INK, &text);
}

/// What bars of a kind are called, and their colour, told apart by the
/// colour-blind.
fn style(kind: Hypothesis) -> (&'static str, &'static str) {
    match kind {
        Hypothesis::Mechanism(Family::Physics) => ("force", "#0072b2"),
        Hypothesis::Mechanism(Family::Start) => ("start", "#009e73"),
        Hypothesis::Mechanism(Family::Measurement) => {
            ("measurement", "#e69f00")
        }
        Hypothesis::Unknown => ("force of free form", "#56b4e9"),
        Hypothesis::Baseline => ("nothing missing", "#8c8c8c"),
    }
}

/// The kinds in the order of the legend.
const KINDS: [Hypothesis; 5] = [
    Hypothesis::Mechanism(Family::Physics),
    Hypothesis::Mechanism(Family::Start),
    Hypothesis::Mechanism(Family::Measurement),
    Hypothesis::Unknown,
    Hypothesis::Baseline,
];

fn entries(shown: &[Judged]) -> Vec<(Key, &'static str)> {
    KINDS
        .into_iter()
        .filter(|kind| shown.iter().any(|m| m.kind == *kind))
        .map(|kind| {
            let (name, colour) = style(kind);
            (Key::Fill(colour), name)
        })
        .collect()
}

fn caption(d: &Diagnosis) -> String {
    let mut out = "Half of the prior probability is on nothing missing, the \
         other half shared evenly"
        .to_owned();
    if !d.odds.is_empty() {
        let told = |(name, odds): (&String, &f64)| format!("{name} {odds}");
        let told: Vec<String> = d.odds.iter().map(told).collect();
        out += &format!(", times the odds given: {}", told.join(", "));
    }
    out += ". log10 BF: the Bayes factor against the model as it was; above \
         2 is called decisive.";
    if !d.selected.is_empty() {
        out += " Bold: what the corrected model has.";
    }
    let rest = d.mechanisms.get(SHOWN..).unwrap_or_default();
    if !rest.is_empty() {
        let p: f64 = rest.iter().map(|m| m.probability).sum();
        out += &format!(
            " {} more are not drawn, of probability {} together.",
            rest.len(),
            probability(p)
        );
    }
    out
}
