//! Each pair of parameters: its draws and their correlation.

use super::Picture;
use super::axes::Scale;
use super::canvas::{Anchor, Canvas, FONT, Frame, Point, Sheet};
use super::palette::{FLOW, GREY, INK, POSTERIOR, Pen};
use crate::report::digits::ticks;
use crate::report::text::{plain, shorten, thinned, wrap};
use crate::report::{CalibrationReport, ParameterReport};

/// How many parameters are paired.
const PAIRED: usize = 6;
/// How many draws a panel shows.
const DRAWS: usize = 500;
const BARS: usize = 20;
const GAP: f64 = 8.0;
const LEFT: f64 = 12.0;

/// The pairs of the first parameters, where there are two or more.
pub(super) fn draw(
    report: &CalibrationReport,
    sheet: Sheet,
) -> Option<Picture> {
    let all: Vec<&ParameterReport> =
        report.parameters.iter().filter(|p| p.pooled.len() > 1).collect();
    let shown = &all[..all.len().min(PAIRED)];
    if shown.len() < 2 {
        return None;
    }
    let side = (sheet.width() - 2.0 * LEFT) / shown.len() as f64;
    let tall = side.min(150.0);
    let height = tall * shown.len() as f64 + 2.0 * FONT + 12.0;
    let mut canvas = Canvas::on(sheet, "pairs", height);
    for (row, a) in shown.iter().enumerate() {
        for (column, b) in shown.iter().enumerate() {
            let left = LEFT + side * column as f64;
            let top = 4.0 + tall * row as f64;
            let (right, bottom) = (left + side - GAP, top + tall - GAP);
            let frame = Frame { left, top, right, bottom };
            match row.cmp(&column) {
                std::cmp::Ordering::Equal => bars(&mut canvas, frame, a),
                std::cmp::Ordering::Greater => {
                    scatter(&mut canvas, frame, b, a);
                }
                std::cmp::Ordering::Less => {
                    figure(&mut canvas, frame, b, a);
                }
            }
            if row + 1 == shown.len() {
                foot(&mut canvas, frame, b);
            }
        }
    }
    Some(Picture {
        name: "pairs",
        title: "Pairs of parameters",
        caption: caption(shown.len(), all.len()),
        phone: String::new(),
        svg: canvas.finish("Draws of each pair of parameters"),
    })
}

fn caption(shown: usize, all: usize) -> String {
    let mut out = "Below the diagonal each dot is a posterior draw, the \
         parameter of the column across and that of the row upwards. Above \
         it stands the correlation of the same pair, shaded by its size: a strong one means \
         that the recording fixes a combination better than either alone."
        .to_owned();
    if shown < all {
        out.push_str(&format!(
            " The first {shown} of {all} parameters are shown."
        ));
    }
    out
}

fn border(canvas: &mut Canvas, f: Frame) {
    let corners = [
        (f.left, f.top),
        (f.right, f.top),
        (f.right, f.bottom),
        (f.left, f.bottom),
        (f.left, f.top),
    ];
    canvas.curve(&corners, Pen::new("#c4c4c4", 1.0));
}

fn scatter(
    canvas: &mut Canvas,
    frame: Frame,
    across: &ParameterReport,
    up: &ParameterReport,
) {
    let x = Scale::of(across.pooled.iter().copied()).padded(0.05);
    let y = Scale::of(up.pooled.iter().copied()).padded(0.05);
    let count = across.pooled.len().min(up.pooled.len());
    let points: Vec<Point> = thinned(count, DRAWS)
        .into_iter()
        .map(|i| {
            let right = (across.pooled[i] - x.low) / x.span();
            let above = (up.pooled[i] - y.low) / y.span();
            let x = frame.left + right * frame.width();
            (x, frame.bottom - above * frame.height())
        })
        .collect();
    canvas.clip(frame);
    canvas.dots(&points, Pen::new(POSTERIOR, 3.0).faded(0.45));
    canvas.unclip();
    border(canvas, frame);
}

fn figure(
    canvas: &mut Canvas,
    frame: Frame,
    a: &ParameterReport,
    b: &ParameterReport,
) {
    let r = correlation(&a.pooled, &b.pooled);
    let strength = r.map_or(0.0, |r| (50.0 * r.abs()).round() / 100.0);
    canvas.rectangle(frame, FLOW, strength);
    border(canvas, frame);
    let text = match r {
        Some(r) => format!("{r:.2}").replace("-0.00", "0.00"),
        None => "n/a".to_owned(),
    };
    let x = 0.5 * (frame.left + frame.right);
    let y = 0.5 * (frame.top + frame.bottom) + 4.5;
    let text = text.replace('-', "−");
    canvas.text((x, y), Anchor::Middle, INK, &text);
}

fn bars(canvas: &mut Canvas, frame: Frame, p: &ParameterReport) {
    let scale = Scale::of(p.pooled.iter().copied()).padded(0.05);
    let counts = histogram(&p.pooled, scale);
    let most = counts.iter().copied().max().unwrap_or(0).max(1) as f64;
    let step = frame.width() / BARS as f64;
    let name = name_lines(&p.name, (frame.width() / 8.2) as usize);
    let room = frame.height() - (FONT + 2.0) * name.len() as f64 - 10.0;
    for (i, count) in counts.into_iter().enumerate().filter(|c| c.1 > 0) {
        let left = frame.left + step * i as f64;
        let top = frame.bottom - room * count as f64 / most;
        let bar = Frame { left, top, right: left + step, ..frame };
        canvas.rectangle(bar, FLOW, 1.0);
    }
    border(canvas, frame);
    let mut y = frame.top + 3.0;
    for line in name {
        y += FONT + 1.0;
        canvas.heading((frame.left + 6.0, y), &line);
    }
}

/// The name on at most two lines of so many characters.
fn name_lines(name: &str, most: usize) -> Vec<String> {
    wrap(&shorten(&plain(name), 2 * most), most).into_iter().take(2).collect()
}

fn histogram(draws: &[f64], scale: Scale) -> [usize; BARS] {
    let mut counts = [0; BARS];
    for x in draws {
        let share = (x - scale.low) / scale.span();
        if (0.0..=1.0).contains(&share) {
            let bar = (share * BARS as f64) as usize;
            counts[bar.min(BARS - 1)] += 1;
        }
    }
    counts
}

/// Two or three numbers under a column, and its unit.
fn foot(canvas: &mut Canvas, frame: Frame, p: &ParameterReport) {
    let scale = Scale::of(p.pooled.iter().copied()).padded(0.05);
    let marks = ticks(scale.low, scale.high, 2);
    let mut free = f64::NEG_INFINITY;
    for (value, label) in marks {
        let share = (value - scale.low) / scale.span();
        let x = frame.left + share * frame.width();
        let label = label.replace('-', "−");
        let half = 0.5 * super::canvas::text_width(&label);
        let tick = Pen::new(GREY, 1.0);
        canvas.line((x, frame.bottom), (x, frame.bottom + 4.0), tick);
        if x - half > free.max(frame.left - GAP) && x + half < canvas.width() {
            let at = (x, frame.bottom + 5.0 + FONT);
            canvas.text(at, Anchor::Middle, GREY, &label);
            free = x + half + 4.0;
        }
    }
    let unit = shorten(&p.unit_shown(), 12);
    if !unit.is_empty() {
        let x = 0.5 * (frame.left + frame.right);
        let at = (x, frame.bottom + 8.0 + 2.0 * FONT);
        canvas.text(at, Anchor::Middle, GREY, &format!("[{unit}]"));
    }
}

/// Pearson's correlation of draws that are finite in both, if they vary.
fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let both = a.iter().zip(b).filter(|(a, b)| (**a + **b).is_finite());
    let both: Vec<(f64, f64)> = both.map(|(a, b)| (*a, *b)).collect();
    let n = both.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| both.iter().map(f).sum::<f64>() / n;
    let centre = (mean(|p| p.0), mean(|p| p.1));
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in both.iter().map(|p| (p.0 - centre.0, p.1 - centre.1)) {
        aa += x * x;
        ab += x * y;
        bb += y * y;
    }
    let r = ab / (aa.sqrt() * bb.sqrt());
    r.is_finite().then(|| r.clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_of_lines_and_constants() {
        let up = [1.0, 2.0, 3.0];
        let near = |b: &[f64], r: f64| {
            correlation(&up, b).is_some_and(|x| (x - r).abs() < 1e-12)
        };
        assert!(near(&[2.0, 4.0, 6.0], 1.0));
        assert!(near(&[3.0, 2.0, 1.0], -1.0));
        assert_eq!(correlation(&up, &[5.0; 3]), None);
        assert_eq!(correlation(&[], &[]), None);
    }
}
