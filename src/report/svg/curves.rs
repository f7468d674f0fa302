//! Several curves over one another, a panel each quantity.

use super::Picture;
use super::axes::{Axes, Key, Labels, Scale, legend};
use super::canvas::{Canvas, Frame, Point, WIDTH};
use super::palette::{CHAINS, Pen};

/// A panel of curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// The axis: `xi [m/s²]`.
    pub label: String,
    /// Each curve with its place in the list of names.
    pub curves: Vec<(usize, Vec<(f64, f64)>)>,
}

const PANEL: f64 = 130.0;
const ROW: f64 = PANEL + 58.0;
const GAP: f64 = 24.0;

/// Curves of several panels, all named once in the legend above.
///
/// ```
/// use couloir::report::svg::{Curves, curves};
/// let line = vec![(0.0, 1.0), (1.0, 2.0)];
/// let panel = Curves { label: "mu".into(), curves: vec![(0, line)] };
/// let picture = curves("sets", "Sets", "", &["set 1".into()], &[panel]);
/// assert!(picture.svg.contains("set 1"));
/// ```
pub fn curves(
    name: &'static str,
    title: &'static str,
    caption: &str,
    names: &[String],
    panels: &[Curves],
) -> Picture {
    let columns = panels.len().clamp(1, 2);
    let rows = panels.len().div_ceil(columns);
    let mut canvas = Canvas::new(name, 56.0 + ROW * rows as f64);
    let keys: Vec<_> = names
        .iter()
        .enumerate()
        .map(|(i, name)| (Key::Line(pen(i)), name.as_str()))
        .collect();
    let below = legend(&mut canvas, 12.0, 2.0, &keys);
    let width = (WIDTH - 12.0) / columns as f64;
    for (i, panel) in panels.iter().enumerate() {
        let left = 12.0 + width * (i % columns) as f64;
        let top = below + 4.0 + ROW * (i / columns) as f64;
        let (right, bottom) = (left + width - GAP, top + PANEL);
        draw(&mut canvas, Frame { left, top, right, bottom }, panel);
    }
    Picture {
        name,
        title,
        caption: caption.to_owned(),
        phone: String::new(),
        svg: canvas.finish(title),
    }
}

fn pen(index: usize) -> Pen {
    let pen = Pen::new(CHAINS[index % CHAINS.len()], 1.8);
    if index < CHAINS.len() { pen } else { pen.dashed() }
}

fn draw(canvas: &mut Canvas, frame: Frame, panel: &Curves) {
    let all = || panel.curves.iter().flat_map(|(_, curve)| curve);
    // A curve of next to no height says nothing and would stretch the scale.
    let top = all().map(|(_, y)| *y).fold(0.0, f64::max);
    let shown = all().filter(|(_, y)| *y > 0.01 * top).map(|(x, _)| *x);
    let x = Scale::of(shown).padded(0.03);
    let axes = Axes { frame, x, y: Scale { low: 0.0, high: 1.05 * top } };
    axes.draw(canvas, Labels { x: Some(&panel.label), y: None });
    canvas.clip(frame);
    for (index, curve) in &panel.curves {
        let points: Vec<Point> =
            curve.iter().map(|(x, y)| axes.at(*x, *y)).collect();
        canvas.curve(&points, pen(*index));
    }
    canvas.unclip();
}
