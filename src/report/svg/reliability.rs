//! Probabilities stated against how often they were right.

use super::Picture;
use super::axes::{Axes, Labels, Scale};
use super::canvas::{Anchor, Canvas, Frame};
use super::palette::{GREY, INK, POSTERIOR, Pen};

/// Answers that stated about the same probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// The mean probability stated.
    pub stated: f64,
    /// The share that was right.
    pub right: f64,
    /// Its standard error.
    pub se: f64,
    /// How many answers there are.
    pub count: usize,
}

/// A dot for each bin, with one standard error either way, and the line on
/// which they lie if probabilities mean what they say.
///
/// ```
/// use couloir::report::svg::{Bin, reliability};
/// let bin = Bin { stated: 0.9, right: 0.8, se: 0.1, count: 12 };
/// let picture = reliability("stated", "Stated and right", "", &[bin]);
/// assert!(picture.svg.contains(">12</text>"));
/// ```
pub fn reliability(
    name: &'static str,
    title: &'static str,
    caption: &str,
    bins: &[Bin],
) -> Picture {
    let mut canvas = Canvas::new(name, 372.0);
    let frame = Frame { left: 170.0, top: 12.0, right: 490.0, bottom: 322.0 };
    let unit = Scale { low: 0.0, high: 1.0 };
    let axes = Axes { frame, x: unit.padded(0.02), y: unit.padded(0.02) };
    let (x, y) = (Some("stated probability"), Some("share that was right"));
    axes.draw(&mut canvas, Labels { x, y });
    let diagonal = Pen::new(GREY, 1.2).dashed();
    canvas.line(axes.at(0.0, 0.0), axes.at(1.0, 1.0), diagonal);
    for bin in bins {
        let end = |by: f64| {
            axes.at(bin.stated, (bin.right + by * bin.se).clamp(0.0, 1.0))
        };
        canvas.line(end(-1.0), end(1.0), Pen::new(POSTERIOR, 1.5));
        canvas.dots(&[end(0.0)], Pen::new(POSTERIOR, 9.0));
        let (x, y) = end(0.0);
        let beside = (x - 10.0, y - 6.0);
        canvas.text(beside, Anchor::End, INK, &bin.count.to_string());
    }
    Picture {
        name,
        title,
        caption: caption.to_owned(),
        phone: String::new(),
        svg: canvas.finish(title),
    }
}
