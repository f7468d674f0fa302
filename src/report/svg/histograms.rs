//! Histograms of counts that ought to be even, a panel each quantity.

use super::Picture;
use super::axes::{Axes, Labels, Scale};
use super::canvas::{Canvas, Frame, WIDTH};
use super::palette::{FLOW, GREY, POSTERIOR, Pen};

/// A panel of a histogram.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// What is counted: `M0, mu: p 0.42`.
    pub label: String,
    /// How many fall into each bin.
    pub counts: Vec<usize>,
}

const PANEL: f64 = 70.0;
const ROW: f64 = PANEL + 50.0;
const GAP: f64 = 16.0;
const COLUMNS: usize = 3;

/// How many standard deviations of one count the band is wide: 99 %.
const BAND: f64 = 2.58;

/// Histograms with the mean and the band in which a bin of an even
/// distribution lies 99 times in 100.
///
/// ```
/// use couloir::report::svg::{Histogram, histograms};
/// let panel = Histogram { label: "mu".into(), counts: vec![9, 11] };
/// let picture = histograms("ranks", "Ranks", "", &[panel]);
/// assert!(picture.svg.contains("<svg"));
/// ```
pub fn histograms(
    name: &'static str,
    title: &'static str,
    caption: &str,
    panels: &[Histogram],
) -> Picture {
    let rows = panels.len().div_ceil(COLUMNS);
    let mut canvas = Canvas::new(name, 8.0 + ROW * rows as f64);
    let width = (WIDTH - 8.0) / COLUMNS as f64;
    for (i, panel) in panels.iter().enumerate() {
        let y = height(panel);
        let left = width * (i % COLUMNS) as f64;
        let top = 8.0 + ROW * (i / COLUMNS) as f64;
        let frame = Frame {
            left: left + Axes::margin(y, PANEL),
            top,
            right: left + width - GAP,
            bottom: top + PANEL,
        };
        draw(&mut canvas, frame, y, panel);
    }
    let caption = caption.to_owned();
    Picture {
        name,
        title,
        caption,
        phone: String::new(),
        svg: canvas.finish(title),
    }
}

/// The count to be expected in a bin, and how far the band goes from it.
fn expected(panel: &Histogram) -> (f64, f64) {
    let bins = panel.counts.len().max(1) as f64;
    let mean = panel.counts.iter().sum::<usize>() as f64 / bins;
    (mean, BAND * (mean * (1.0 - 1.0 / bins)).sqrt())
}

fn height(panel: &Histogram) -> Scale {
    let (mean, off) = expected(panel);
    let counts = panel.counts.iter().map(|n| *n as f64);
    let high = counts.fold(mean + off, f64::max);
    Scale { low: 0.0, high: 1.08 * high.max(1.0) }
}

fn draw(canvas: &mut Canvas, frame: Frame, y: Scale, panel: &Histogram) {
    let bins = panel.counts.len().max(1) as f64;
    let axes = Axes { frame, x: Scale { low: 0.0, high: bins }, y };
    axes.draw(canvas, Labels { x: None, y: None });
    for (i, count) in panel.counts.iter().enumerate() {
        let (left, top) = axes.at(i as f64 + 0.1, *count as f64);
        let (right, bottom) = axes.at(i as f64 + 0.9, 0.0);
        canvas.rectangle(Frame { left, top, right, bottom }, FLOW, 1.0);
    }
    let (mean, off) = expected(panel);
    let lines = [
        (mean, Pen::new(POSTERIOR, 1.6)),
        (mean - off, Pen::new(GREY, 1.2).dashed()),
        (mean + off, Pen::new(GREY, 1.2).dashed()),
    ];
    for (at, pen) in lines {
        let at = at.max(0.0);
        canvas.line(axes.at(0.0, at), axes.at(bins, at), pen);
    }
    canvas.heading((frame.left, frame.bottom + 20.0), &panel.label);
}
