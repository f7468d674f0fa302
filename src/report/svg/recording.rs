//! The recording over time with its predictive bands.

use super::axes::{Axes, Key, Labels, Scale, legend};
use super::canvas::{Canvas, Frame, Sheet};
use super::palette::{FLOW, FULL, INK, POSTERIOR, PRIOR, Pen};
use super::series::{FLOWS, MEDIAN_FLOW, RECORDED, WITH_ERRORS, least};
use super::{Picture, with_unit};
use crate::report::text::{shorten, thinned};
use crate::report::{Bands, CalibrationReport};

const HEIGHT: f64 = 400.0;
/// How many values are drawn.
const VALUES: usize = 2000;
/// How many values are drawn with error bars.
const BARRED: usize = 200;
/// At how many times the bands are drawn.
const TIMES: usize = 500;

/// What the prior's edges are called.
const BEFORE_DATA: &str = "90 % of flows before the data";

const MEDIAN: Pen = Pen::new(POSTERIOR, 2.0);
const PRIOR_EDGE: Pen = Pen::new(PRIOR, 1.5).dashed();

/// The recording with its bands, where there is a recording.
pub(super) fn draw(
    report: &CalibrationReport,
    sheet: Sheet,
) -> Option<Picture> {
    if report.times.is_empty() || report.values.is_empty() {
        return None;
    }
    let mut canvas = Canvas::on(sheet, "recording", HEIGHT);
    let y = value_scale(report);
    let left = Axes::margin(y, HEIGHT - 110.0);
    let top = legend(&mut canvas, left, 2.0, &entries(report));
    let (right, bottom) = (sheet.width() - 14.0, HEIGHT - 46.0);
    let frame = Frame { left, right, top, bottom };
    let times = report.times.iter().chain(&report.bands.times);
    let axes = Axes { frame, x: Scale::of(times.copied()).padded(0.01), y };
    let name = with_unit(&shorten(&report.quantity, 24), &report.unit);
    let labels = Labels { x: Some("time [s]"), y: Some(&name) };
    axes.draw(&mut canvas, labels);
    canvas.clip(frame);
    draw_fills(&mut canvas, &axes, report);
    if let Some(prior) = &report.prior_bands {
        draw_edges(&mut canvas, &axes, prior);
    }
    draw_median(&mut canvas, &axes, &report.bands);
    let shown = draw_values(&mut canvas, &axes, report);
    canvas.unclip();
    Some(Picture {
        name: "recording",
        title: "Recording and prediction",
        caption: caption(report, shown),
        phone: String::new(),
        svg: canvas.finish("The recording over time with predictive bands"),
    })
}

fn entries(report: &CalibrationReport) -> Vec<(Key, &'static str)> {
    let mut out = vec![(Key::Dot(Pen::new(INK, 5.0)), RECORDED)];
    if !report.bands.times.is_empty() {
        out.push((Key::Line(MEDIAN), MEDIAN_FLOW));
        out.push((Key::Fill(FLOW), FLOWS));
        out.push((Key::Fill(FULL), WITH_ERRORS));
    }
    if report.prior_bands.is_some() {
        out.push((Key::Line(PRIOR_EDGE), BEFORE_DATA));
    }
    out
}

/// Recording and posterior in full, and of the prior what is near them.
fn value_scale(report: &CalibrationReport) -> Scale {
    let b = &report.bands;
    let least = least(&report.quantity);
    let posterior = b.full_low.iter().chain(&b.full_high).chain(&b.median);
    let posterior = posterior.map(|value| value.max(least));
    let bars = error_bars(report).flat_map(|(_, low, high)| [low, high]);
    let values = report.values.iter().copied().chain(bars);
    let base = Scale::of(values.chain(posterior)).padded(0.04);
    let Some(prior) = &report.prior_bands else { return base };
    let edges = prior.flow_low.iter().chain(&prior.flow_high);
    let prior = Scale::of(edges.copied()).padded(0.02);
    prior.within(base.padded(0.35)).with(base)
}

fn draw_fills(canvas: &mut Canvas, axes: &Axes, report: &CalibrationReport) {
    let (b, least) = (&report.bands, least(&report.quantity));
    let cut = |v: &[f64]| -> Vec<f64> {
        v.iter().map(|value| value.max(least)).collect()
    };
    let edge = |v: &[f64]| edge(axes, &b.times, &cut(v));
    canvas.of(WITH_ERRORS);
    canvas.area(&edge(&b.full_low), &edge(&b.full_high), FULL, 1.0);
    canvas.of(FLOWS);
    canvas.area(&edge(&b.flow_low), &edge(&b.flow_high), FLOW, 1.0);
}

fn draw_median(canvas: &mut Canvas, axes: &Axes, b: &Bands) {
    canvas.of(MEDIAN_FLOW);
    canvas.curve(&edge(axes, &b.times, &b.median), MEDIAN);
}

fn draw_edges(canvas: &mut Canvas, axes: &Axes, prior: &Bands) {
    canvas.of(BEFORE_DATA);
    for side in [&prior.flow_low, &prior.flow_high] {
        canvas.curve(&edge(axes, &prior.times, side), PRIOR_EDGE);
    }
}

fn edge(axes: &Axes, times: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let count = times.len().min(values.len());
    let kept = thinned(count, TIMES).into_iter();
    kept.map(|i| axes.at(times[i], values[i])).collect()
}

/// Time and both ends of each error bar, where they are known and few.
fn error_bars(
    report: &CalibrationReport,
) -> impl Iterator<Item = (f64, f64, f64)> {
    let few = report.values.len() <= BARRED;
    let errors = report.standard_errors.iter().filter(move |_| few).flatten();
    let values = report.times.iter().zip(&report.values);
    let bars = values.zip(errors).filter(|(_, se)| se.is_finite());
    bars.map(|((t, v), se)| (*t, v - se, v + se))
}

/// Draws the values and returns how many.
fn draw_values(
    canvas: &mut Canvas,
    axes: &Axes,
    report: &CalibrationReport,
) -> usize {
    let all = axes.points(&report.times, &report.values);
    let kept = thinned(all.len(), VALUES);
    let points: Vec<_> = kept.iter().map(|&i| all[i]).collect();
    canvas.of(RECORDED);
    for (t, low, high) in error_bars(report) {
        let ends = (axes.at(t, low), axes.at(t, high));
        canvas.line(ends.0, ends.1, Pen::new(INK, 1.0));
    }
    let size = if points.len() > 300 { 2.5 } else { 5.0 };
    canvas.dots(&points, Pen::new(INK, size));
    points.len()
}

fn caption(report: &CalibrationReport, shown: usize) -> String {
    let mut out = if report.bands.times.is_empty() {
        "The recorded values."
    } else {
        "Nine of ten recorded values should lie in the outer band. The inner \
         band holds nine of ten flows that the parameters left open by the \
         recording produce; the outer band adds the errors."
    }
    .to_owned();
    if report.prior_bands.is_some() {
        out.push_str(
            " Dashed: nine of ten flows before the recording was used, \
             drawn as far as they fit.",
        );
    }
    let count = report.times.len().min(report.values.len());
    if shown < count {
        out.push_str(&format!(
            " Of {count} values, {shown} evenly spread ones are drawn."
        ));
    } else if report.standard_errors.is_some() && count <= BARRED {
        out.push_str(" Bars: one standard error of a value, up and down.");
    }
    out
}
