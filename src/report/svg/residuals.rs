//! Standardised innovations over time and their autocorrelation.

use super::Picture;
use super::axes::{Axes, Key, Labels, Scale, legend};
use super::canvas::{Canvas, Frame, Sheet};
use super::palette::{GREY, INK, MASS, POSTERIOR, Pen};
use crate::report::CalibrationReport;
use crate::report::text::thinned;

/// How many innovations are drawn.
const VALUES: usize = 2000;
/// How many lags are drawn.
const LAGS: usize = 30;
const UPPER: f64 = 170.0;
const LOWER: f64 = 130.0;
const BETWEEN: f64 = 62.0;

const DOT: Pen = Pen::new(INK, 5.0);
const BOUND: Pen = Pen::new(MASS, 1.5).dashed();

/// The residuals, where there are any.
pub(super) fn draw(
    report: &CalibrationReport,
    sheet: Sheet,
) -> Option<Picture> {
    let values = &report.innovations;
    let count = values.len().min(report.innovation_times.len());
    if count == 0 {
        return None;
    }
    let lags = report.autocorrelation.len().min(LAGS);
    let lower = if lags > 0 { LOWER + BETWEEN } else { 0.0 };
    let mut canvas =
        Canvas::on(sheet, "residuals", 34.0 + UPPER + 46.0 + lower);
    let left = 62.0;
    let mut keys = vec![
        (Key::Dot(DOT), "innovation"),
        (Key::Line(BOUND), "95 % of pure noise lies inside"),
    ];
    if lags > 0 {
        keys.push((Key::Fill(POSTERIOR), "autocorrelation"));
    }
    let top = legend(&mut canvas, left, 2.0, &keys);
    let (right, bottom) = (sheet.width() - 14.0, top + UPPER);
    over_time(&mut canvas, Frame { left, top, right, bottom }, report);
    if lags > 0 {
        let top = bottom + BETWEEN;
        let frame = Frame { left, top, right, bottom: top + LOWER };
        let shown = &report.autocorrelation[..lags];
        over_lags(&mut canvas, frame, shown, values.len());
    }
    Some(Picture {
        name: "residuals",
        title: "Residuals",
        caption: caption(count, lags, report.autocorrelation.len()),
        phone: String::new(),
        svg: canvas.finish("Standardised innovations, autocorrelation"),
    })
}

fn caption(count: usize, lags: usize, all: usize) -> String {
    let mut out = "What is left of each value after the median flow and the \
         errors before it, in standard deviations: it should look like \
         noise without a pattern, 19 of 20 dots between the dashed lines."
        .to_owned();
    if lags > 0 {
        out.push_str(
            " Bars beyond the dashed lines show a memory that the model of \
             the errors does not have.",
        );
    }
    if count > VALUES {
        out.push_str(&format!(
            " Of {count} values, {VALUES} evenly spread ones are drawn."
        ));
    }
    if lags < all {
        out.push_str(&format!(" The first {lags} of {all} lags are drawn."));
    }
    out
}

fn bounds(canvas: &mut Canvas, axes: &Axes, bound: f64) {
    let Frame { left, right, .. } = axes.frame;
    for (level, pen) in
        [(bound, BOUND), (-bound, BOUND), (0.0, Pen::new(GREY, 1.0))]
    {
        let y = axes.at(0.0, level).1;
        canvas.line((left, y), (right, y), pen);
    }
}

fn over_time(canvas: &mut Canvas, frame: Frame, report: &CalibrationReport) {
    let (times, values) = (&report.innovation_times, &report.innovations);
    let largest = values.iter().filter(|v| v.abs() < 1e150);
    let largest = largest.fold(2.4_f64, |m, v| m.max(v.abs())) * 1.08;
    let x = Scale::of(times.iter().copied()).padded(0.01);
    let axes = Axes { frame, x, y: Scale { low: -largest, high: largest } };
    let y = Some("innovation [sd]");
    axes.draw(canvas, Labels { x: Some("time [s]"), y });
    bounds(canvas, &axes, 1.96);
    let kept = thinned(times.len().min(values.len()), VALUES);
    let points: Vec<_> =
        kept.iter().map(|&i| axes.at(times[i], values[i])).collect();
    if points.len() <= 200 {
        for &(x, y) in &points {
            let zero = axes.at(0.0, 0.0).1;
            canvas.line((x, zero), (x, y), Pen::new("#b5b5b5", 1.0));
        }
    }
    let size = if points.len() > 300 { 2.5 } else { 5.0 };
    canvas.dots(&points, Pen { width: size, ..DOT });
}

fn over_lags(canvas: &mut Canvas, frame: Frame, shown: &[f64], n: usize) {
    let bound = 1.96 / (n.max(1) as f64).sqrt();
    let largest = shown.iter().filter(|v| v.is_finite());
    let largest = largest.fold(bound, |m, v| m.max(v.abs()));
    let high = (1.15 * largest).clamp(0.3, 1.0);
    let x = Scale { low: 0.4, high: shown.len() as f64 + 0.6 };
    let axes = Axes { frame, x, y: Scale { low: -high, high } };
    let labels = Labels { x: Some("lag [values]"), y: Some("correlation") };
    axes.draw(canvas, labels);
    canvas.clip(frame);
    for (lag, r) in (1_u32..).zip(shown).filter(|p| p.1.is_finite()) {
        let (left, a) = axes.at(f64::from(lag) - 0.3, r.max(0.0));
        let (right, b) = axes.at(f64::from(lag) + 0.3, r.min(0.0));
        let bar = Frame { left, right, top: a, bottom: b };
        canvas.rectangle(bar, POSTERIOR, 1.0);
    }
    bounds(canvas, &axes, bound);
    canvas.unclip();
}
