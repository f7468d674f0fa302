//! Figures of the recording beside those of its replicates, a panel each.

use super::axes::{Axes, Key, Labels, Scale, legend};
use super::canvas::{Canvas, Frame, Sheet};
use super::palette::{FLOW, MASS, Pen};
use super::{Picture, with_unit};
use crate::predict::Statistic;
use crate::report::CalibrationReport;
use crate::report::digits::p_value;

/// How many bins a histogram has: odd, for a bin of its own in the middle.
const BINS: usize = 25;
const PANEL: f64 = 84.0;
const ROW: f64 = PANEL + 76.0;
const GAP: f64 = 26.0;
/// The shares of the replicates that are left out at either end, where a few
/// of heavy tails would squeeze the rest.
const TAILS: [f64; 2] = [0.002, 0.998];

const RECORDED: Pen = Pen::new(MASS, 2.4);

/// A panel for each figure, where there are any.
pub(super) fn draw(
    report: &CalibrationReport,
    sheet: Sheet,
) -> Option<Picture> {
    let shown: Vec<&Statistic> = report
        .statistics
        .iter()
        .filter(|s| !s.replicated.is_empty())
        .collect();
    if shown.is_empty() {
        return None;
    }
    let columns = sheet.columns(3);
    let rows = shown.len().div_ceil(columns);
    let mut canvas = Canvas::on(sheet, "predictive", 30.0 + ROW * rows as f64);
    let keys = [
        (Key::Fill(FLOW), "recordings the model would make"),
        (Key::Line(RECORDED), "this recording"),
    ];
    let top = legend(&mut canvas, 12.0, 2.0, &keys);
    let width = (sheet.width() - 24.0 + GAP) / columns as f64;
    for (i, statistic) in shown.into_iter().enumerate() {
        let left = 12.0 + width * (i % columns) as f64;
        let top = top + 22.0 + ROW * (i / columns) as f64;
        let (right, bottom) = (left + width - GAP, top + PANEL);
        panel(&mut canvas, Frame { left, top, right, bottom }, statistic);
    }
    Some(Picture {
        name: "predictive",
        title: "Would the model make such a recording?",
        caption: "Figures of the recording (upright lines) among those of \
             recordings drawn from the calibrated model, errors included. p \
             is the share of these that lie higher: near 0 or 1 the model \
             does not make such recordings."
            .to_owned(),
        phone: String::new(),
        svg: canvas.finish("Figures of the recording and of its replicates"),
    })
}

fn panel(canvas: &mut Canvas, frame: Frame, statistic: &Statistic) {
    let [low, high] = TAILS.map(|p| statistic.quantile(p));
    let x = Scale::of([low, high, statistic.recorded]).padded(0.04);
    let counts = counts(statistic, x);
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let y = Scale { low: 0.0, high: 1.06 * most as f64 };
    let axes = Axes { frame, x, y };
    let name = with_unit(statistic.name, &statistic.unit);
    axes.draw(canvas, Labels { x: Some(&name), y: None });
    axes.describe(canvas, [&name, "replicates"]);
    canvas.of("recordings the model would make");
    let width = x.span() / BINS as f64;
    for (i, count) in counts.into_iter().enumerate() {
        let from = x.low + width * i as f64;
        let (left, top) = axes.at(from, count as f64);
        let (right, bottom) = axes.at(from + width, 0.0);
        canvas.rectangle(Frame { left, top, right, bottom }, FLOW, 1.0);
    }
    canvas.of("this recording");
    let recorded = statistic.recorded;
    canvas.line(axes.at(recorded, 0.0), axes.at(recorded, y.high), RECORDED);
    canvas.of("");
    let p = format!("p = {}", p_value(statistic.p()));
    canvas.heading((frame.left, frame.top - 8.0), &p);
}

/// How many replicates fall into each bin.
fn counts(statistic: &Statistic, x: Scale) -> [usize; BINS] {
    let mut counts = [0; BINS];
    for value in &statistic.replicated {
        let bin = (value - x.low) / x.span() * BINS as f64;
        if (0.0..BINS as f64).contains(&bin) {
            counts[bin as usize] += 1;
        }
    }
    counts
}
