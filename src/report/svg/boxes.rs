//! Box plots of several samples side by side, a panel each quantity.

use super::Picture;
use super::axes::{Axes, Labels, Scale};
use super::canvas::{Anchor, Canvas, FONT, Frame, WIDTH};
use super::palette::{FLOW, GREY, INK, MASS, POSTERIOR, Pen};
use crate::draws::quantile;

/// A panel of box plots.
#[derive(Debug, Clone, PartialEq)]
pub struct Boxes {
    /// The axis: `xi [m/s²]`.
    pub label: String,
    /// A value to compare with, drawn across.
    pub truth: Option<f64>,
    /// What each box is called, a line for each part before a comma, and its
    /// sample.
    pub samples: Vec<(String, Vec<f64>)>,
}

const PANEL: f64 = 170.0;
const ROW: f64 = PANEL + 44.0;
const GAP: f64 = 22.0;

/// Box plots: quartiles in the box, 5 % to 95 % in the whiskers.
///
/// ```
/// use couloir::report::svg::{Boxes, box_plots};
/// let boxes = Boxes {
///     label: "mu".into(),
///     truth: Some(0.32),
///     samples: vec![("M0".into(), vec![0.2, 0.25, 0.3])],
/// };
/// assert!(box_plots("modes", "Modes", "", &[boxes]).svg.contains("<svg"));
/// ```
pub fn box_plots(
    name: &'static str,
    title: &'static str,
    caption: &str,
    panels: &[Boxes],
) -> Picture {
    let columns = panels.len().clamp(1, 2);
    let rows = panels.len().div_ceil(columns);
    let mut canvas = Canvas::new(name, 8.0 + ROW * rows as f64);
    let width = (WIDTH - 8.0) / columns as f64;
    for (i, panel) in panels.iter().enumerate() {
        let left = width * (i % columns) as f64;
        let top = 8.0 + ROW * (i / columns) as f64;
        let scale = scale(panel);
        let margin = Axes::margin(scale, PANEL);
        let frame = Frame {
            left: left + margin,
            top,
            right: left + width - GAP,
            bottom: top + PANEL,
        };
        draw(&mut canvas, frame, scale, panel);
    }
    Picture {
        name,
        title,
        caption: caption.to_owned(),
        phone: String::new(),
        svg: canvas.finish(title),
    }
}

fn scale(panel: &Boxes) -> Scale {
    let ends = panel.samples.iter().flat_map(|(_, sample)| {
        let sorted = sorted(sample);
        [0.05, 0.95].map(|p| quantile(&sorted, p))
    });
    Scale::of(ends.chain(panel.truth)).padded(0.06)
}

fn sorted(sample: &[f64]) -> Vec<f64> {
    let mut sorted: Vec<f64> =
        sample.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted
}

fn draw(canvas: &mut Canvas, frame: Frame, y: Scale, panel: &Boxes) {
    let count = panel.samples.len() as f64;
    let axes = Axes { frame, x: Scale { low: 0.0, high: count }, y };
    axes.draw(canvas, Labels { x: None, y: Some(&panel.label) });
    let across = |canvas: &mut Canvas, from: f64, to: f64, at: f64, pen| {
        canvas.line(axes.at(from, at), axes.at(to, at), pen);
    };
    if let Some(truth) = panel.truth {
        across(canvas, 0.0, count, truth, Pen::new(MASS, 1.6).dashed());
    }
    for (i, (label, sample)) in panel.samples.iter().enumerate() {
        let middle = i as f64 + 0.5;
        let (x, _) = axes.at(middle, y.low);
        for (line, part) in label.split(", ").enumerate() {
            let below = frame.bottom + 6.0 + FONT * (1.0 + 1.1 * line as f64);
            canvas.text((x, below), Anchor::Middle, INK, part);
        }
        let sorted = sorted(sample);
        if sorted.is_empty() {
            continue;
        }
        let q = |p: f64| quantile(&sorted, p);
        let whisker = Pen::new(GREY, 1.2);
        canvas.line(
            axes.at(middle, q(0.05)),
            axes.at(middle, q(0.95)),
            whisker,
        );
        for p in [0.05, 0.95] {
            across(canvas, middle - 0.1, middle + 0.1, q(p), whisker);
        }
        let (left, top) = axes.at(middle - 0.25, q(0.75));
        let (right, bottom) = axes.at(middle + 0.25, q(0.25));
        canvas.rectangle(Frame { left, top, right, bottom }, FLOW, 1.0);
        let pen = Pen::new(POSTERIOR, 2.0);
        across(canvas, middle - 0.25, middle + 0.25, q(0.5), pen);
    }
}
