//! The free-form force with its simultaneous band: over distance large, over
//! time and over speed small.

use std::f64::consts::LN_10;

use super::along::along;
use super::figure::{Figure, shade};
use crate::diagnosis::tell::phrases::log10;
use crate::diagnosis::{Band, Diagnosis, FreeForce};
use crate::physics::forces::Axis;
use crate::report::svg::axes::{Axes, Key, Labels, Scale, legend};
use crate::report::svg::canvas::{Anchor, Canvas, FONT, Frame, Point, Sheet};
use crate::report::svg::palette::{
    FLOW, FULL, GREY, INK, MARKED, MASS, POSTERIOR, Pen,
};
use crate::report::svg::series::LOCATED;

const LARGE: f64 = 230.0;
const SMALL: f64 = 130.0;
/// What the labels above and below a panel take.
const ROOM: f64 = 78.0;
const GAP: f64 = 26.0;

/// What the series are called.
const MEAN_FORCE: &str = "mean";
const BAND: &str = "90 % band";
const WHOLE: &str = "90 % band of the whole force";
const CLEAR: &str = "clear of zero";

const MEAN: Pen = Pen::new(POSTERIOR, 2.0);
const SURE: Pen = Pen::new(MASS, 3.6);
const ZERO: Pen = Pen::new(INK, 1.3);

/// The forces that were inferred, where there are any.
pub(crate) fn forces(d: &Diagnosis) -> Option<Figure> {
    Figure::both(|sheet| drawn(d, sheet))
}

fn drawn(d: &Diagnosis, sheet: Sheet) -> Option<Figure> {
    let large = main(&d.forces)?;
    let small: Vec<&FreeForce> =
        d.forces.iter().filter(|f| f.axis != large.axis).collect();
    let columns = sheet.columns(small.len().max(1));
    let below = (SMALL + ROOM) * small.len().div_ceil(columns) as f64;
    let lines = if sheet == Sheet::Page { 2.0 } else { 4.0 };
    let head = lines * (FONT + 6.0) + 2.0;
    let height = head + LARGE + ROOM + below;
    let mut canvas = Canvas::on(sheet, "force", height);
    let is_marked = !d.mismatch.is_empty();
    legend(&mut canvas, 12.0, 2.0, &entries(&d.forces, is_marked));
    let stretches = |f: &FreeForce| along(&d.mismatch, f.axis);
    let y = scale(large, LARGE);
    let (left, top) = (Axes::margin(y, LARGE), head + 22.0);
    let (right, bottom) = (sheet.width() - 14.0, top + LARGE);
    let frame = Frame { left, top, right, bottom };
    panel(&mut canvas, frame, large, &stretches(large));
    let width = (sheet.width() - 12.0) / columns as f64;
    for (i, force) in small.into_iter().enumerate() {
        let margin = Axes::margin(scale(force, SMALL), SMALL);
        let start = 4.0 + width * (i % columns) as f64;
        let top = bottom + ROOM + (SMALL + ROOM) * (i / columns) as f64;
        let (left, right) = (start + margin, start + width - GAP);
        let frame = Frame { left, top, right, bottom: top + SMALL };
        panel(&mut canvas, frame, force, &stretches(force));
    }
    Some(Figure {
        id: "force".to_owned(),
        caption: caption(d),
        phone: String::new(),
        svg: canvas.finish("The free-form force with its band"),
    })
}

/// The force that is left beside what was selected.
pub(crate) fn left_over(d: &Diagnosis) -> Option<Figure> {
    let force = d.left.as_ref().filter(|force| force.at.len() > 1)?;
    Figure::both(|sheet| {
        let entries = entries(std::slice::from_ref(force), false);
        let mut canvas = Canvas::on(sheet, "left", LARGE + ROOM + 40.0);
        let top = legend(&mut canvas, 12.0, 2.0, &entries) + 22.0;
        let (right, bottom) = (sheet.width() - 14.0, top + LARGE);
        let left = Axes::margin(scale(force, LARGE), LARGE);
        let frame = Frame { left, top, right, bottom };
        panel(&mut canvas, frame, force, &[]);
        Some(Figure {
            id: "left".to_owned(),
            caption: "The same force of any shape, beside what the corrected \
                 model has: where the band holds zero along the whole run, \
                 the recording asks for nothing more."
                .to_owned(),
            phone: String::new(),
            svg: canvas.finish("The force that is left, with its band"),
        })
    })
}

/// The force over distance, or the first there is.
fn main(forces: &[FreeForce]) -> Option<&FreeForce> {
    let drawable = |f: &&FreeForce| f.at.len() > 1;
    let mut all = forces.iter().filter(drawable);
    all.clone().find(|f| f.axis == Axis::Place).or_else(|| all.next())
}

/// What the legend of some forces names: what is drawn.
fn entries(forces: &[FreeForce], is_marked: bool) -> Vec<(Key, &'static str)> {
    let mut out = vec![(Key::Line(MEAN), MEAN_FORCE), (Key::Fill(FLOW), BAND)];
    if forces.iter().any(|force| force.whole.is_some()) {
        out.push((Key::Fill(FULL), WHOLE));
    }
    let has_clear = |f: &FreeForce| (0..f.at.len()).any(|i| is_clear(f, i));
    if forces.iter().any(has_clear) {
        out.push((Key::Line(SURE), CLEAR));
    }
    if is_marked {
        out.push((Key::Fill(MARKED), LOCATED));
    }
    out
}

/// The forces of a panel of such a height, with room above and below the bands
/// for which way they act.
fn scale(f: &FreeForce, height: f64) -> Scale {
    let bands = f.whole.iter().chain([&f.band]).map(Band::ends);
    let ends = bands.flat_map(|(low, high)| [low, high]).flatten();
    Scale::of(ends.chain([0.0])).padded((FONT + 8.0) / height)
}

fn panel(
    canvas: &mut Canvas,
    frame: Frame,
    f: &FreeForce,
    stretches: &[(f64, f64)],
) {
    let half = 0.5 * f.at.windows(2).next().map_or(0.0, |w| w[1] - w[0]);
    let ends = f.at.first().map(|x| x - half).into_iter();
    let x = Scale::of(ends.chain(f.at.last().map(|x| x + half)));
    let y = scale(f, frame.height());
    let axes = Axes { frame, x, y };
    shade(canvas, &axes, stretches);
    let (over, name) = names(f.axis);
    axes.draw(canvas, Labels { x: Some(name), y: Some("force [m/s²]") });
    canvas.clip(frame);
    let of = |y: &[f64]| axes.points(&f.at, y);
    let wide = f.whole.iter().map(|band| (WHOLE, band, FULL));
    for (name, band, colour) in wide.chain([(BAND, &f.band, FLOW)]) {
        let (low, high) = band.ends();
        canvas.of(name);
        canvas.area(&of(&low), &of(&high), colour, 0.85);
    }
    canvas.of(MEAN_FORCE);
    canvas.curve(&of(&f.band.mean), MEAN);
    canvas.of(CLEAR);
    canvas.curve(&sure(&axes, f), SURE);
    canvas.of("");
    canvas.line(axes.at(x.low, 0.0), axes.at(x.high, 0.0), ZERO);
    canvas.unclip();
    let (left, above) = (frame.left, frame.top - 8.0);
    canvas.heading((left, above), over);
    let factor = log10(f.log_bayes_factor / LN_10).replace('-', "−");
    // A small panel has no room for more.
    let small = frame.width() < 0.5 * Sheet::Page.width();
    let what = if small { "log10 BF" } else { "log10 Bayes factor" };
    let text = format!("{what} {factor}");
    canvas.text((frame.right, above), Anchor::End, GREY, &text);
    senses(canvas, &axes);
}

fn names(axis: Axis) -> (&'static str, &'static str) {
    match axis {
        Axis::Place => ("over distance", "distance along the slope [m]"),
        Axis::Time => ("over time", "time [s]"),
        Axis::Speed => ("over speed", "speed [m/s]"),
    }
}

/// Whether the band leaves zero out in a cell.
fn is_clear(f: &FreeForce, cell: usize) -> bool {
    f.band.sign(cell) != 0.0
}

/// The mean where the band leaves zero out; broken elsewhere.
fn sure(axes: &Axes, f: &FreeForce) -> Vec<Point> {
    let half = 0.5 * f.at.windows(2).next().map_or(0.0, |w| w[1] - w[0]);
    let mut points = Vec::new();
    for (i, (x, m)) in f.at.iter().zip(&f.band.mean).enumerate() {
        if is_clear(f, i) {
            // A cell alone is still a line.
            points.push(axes.at(x - 0.2 * half, *m));
            points.push(axes.at(x + 0.2 * half, *m));
        } else {
            points.push((f64::NAN, f64::NAN));
        }
    }
    points
}

/// Which way the force acts, where there is room to say it.
fn senses(canvas: &mut Canvas, axes: &Axes) {
    let zero = axes.at(0.0, 0.0).1;
    let Frame { left, top, bottom, .. } = axes.frame;
    let room = 2.0 * FONT;
    if zero - top > room {
        let at = (left + 6.0, top + FONT + 2.0);
        canvas.text(at, Anchor::Start, GREY, "drives");
    }
    if bottom - zero > room {
        let at = (left + 6.0, bottom - 6.0);
        canvas.text(at, Anchor::Start, GREY, "brakes");
    }
}

fn caption(d: &Diagnosis) -> String {
    let mut out = "A force of any shape, inferred together with the model's \
         own parameters: above zero it drives the mass, below it brakes. \
         Nine of ten such forces lie in the band along their whole length."
        .to_owned();
    if d.forces.iter().any(|force| force.whole.is_some()) {
        out += " What the friction law could do with other parameters is left \
                to it: no recording tells the two apart. The pale band is that \
                of the whole force.";
    }
    let best = FreeForce::likeliest(&d.forces);
    if let Some(best) = best.filter(|_| d.forces.len() > 1) {
        let over = names(best.axis).0;
        out += &format!(
            " The evidence is greatest for a force {over}; Bayes factors \
             (BF) are against the model without one."
        );
    }
    out
}
