//! The track with the located stretch on it.

use super::figure::Figure;
use crate::diagnosis::tell::phrases::range;
use crate::diagnosis::{Diagnosis, Pictured};
use crate::report::digits::short;
use crate::report::svg::axes::{Axes, Key, Labels, Scale, legend};
use crate::report::svg::canvas::{
    Anchor, Canvas, Frame, Point, Sheet, text_width,
};
use crate::report::svg::palette::{GREY, MASS, Pen};
use crate::report::text::thinned;

/// How many points are drawn.
const POINTS: usize = 1500;
/// The least and the greatest height of the panel.
const HEIGHTS: (f64, f64) = (150.0, 380.0);

/// From one line of text to the next.
const LINE: f64 = 14.0;

const SURVEY: Pen = Pen::new(GREY, 2.0);
const MARK: Pen = Pen::new(MASS, 6.0);

/// The track of a recording, where it has at least two points.
pub(crate) fn track(d: &Diagnosis, p: &Pictured, id: &str) -> Option<Figure> {
    Figure::both(|sheet| drawn(d, p, id, sheet))
}

fn drawn(
    d: &Diagnosis,
    p: &Pictured,
    id: &str,
    sheet: Sheet,
) -> Option<Figure> {
    let (x, z) = (&p.track.0, &p.track.1);
    if x.len().min(z.len()) < 2 {
        return None;
    }
    let up = Scale::of(z.iter().copied()).padded(0.10);
    let left = Axes::margin(up, 250.0);
    let right = sheet.width() - 22.0;
    let (across, height) = fitted(x, up, right - left);
    let mut canvas = Canvas::on(sheet, id, height + 84.0);
    let top = legend(&mut canvas, left, 2.0, &entries(p)).max(26.0);
    let frame = Frame { left, right, top, bottom: top + height };
    let axes = Axes { frame, x: across, y: up };
    let labels = Labels {
        x: Some("horizontal distance [m]"),
        y: Some("elevation [m]"),
    };
    axes.draw(&mut canvas, labels);
    let kept = thinned(x.len().min(z.len()), POINTS);
    let line: Vec<Point> = kept.iter().map(|&i| axes.at(x[i], z[i])).collect();
    canvas.curve(&line, SURVEY);
    mark(&mut canvas, &axes, d, p);
    let stretched = (height / up.span()) / ((right - left) / across.span());
    Some(Figure {
        id: id.to_owned(),
        caption: caption(p, stretched),
        phone: String::new(),
        svg: canvas.finish("The track with the located stretch on it"),
    })
}

/// The scale across and the height of the panel: true to scale where the
/// track is neither flat nor upright.
fn fitted(x: &[f64], up: Scale, width: f64) -> (Scale, f64) {
    let across = Scale::of(x.iter().copied()).padded(0.02);
    let height = width * up.span() / across.span();
    if height <= HEIGHTS.1 {
        return (across, height.max(HEIGHTS.0));
    }
    // An upright track stays upright, in a wider field.
    let wider = width * up.span() / HEIGHTS.1;
    let share = 0.5 * (wider / across.span() - 1.0);
    (across.padded(share), HEIGHTS.1)
}

fn entries(p: &Pictured) -> Vec<(Key, &'static str)> {
    let mut out = vec![(Key::Line(SURVEY), "track")];
    if p.is_marked() {
        let words = "where simulation and recording differ";
        out.push((Key::Line(MARK), words));
    }
    out
}

/// Each stretch that is on the track, with its label.
fn mark(canvas: &mut Canvas, axes: &Axes, d: &Diagnosis, p: &Pictured) {
    let mut labels: Vec<Point> = Vec::new();
    for (stretch, m) in p.marked.iter().zip(&d.mismatch) {
        let kept = thinned(stretch.len(), POINTS).into_iter();
        let at = |i: usize| axes.at(stretch[i].0, stretch[i].1);
        let line: Vec<Point> = kept.map(at).collect();
        canvas.curve(&line, MARK);
        let whole = |p: &Point| p.0.is_finite() && p.1.is_finite();
        let points: Vec<Point> = line.into_iter().filter(whole).collect();
        let text = range(m.place_from, m.place_to, "m");
        label(canvas, axes.frame, &points, &text, &mut labels);
    }
}

/// The label of a stretch above its middle, on the side to which it falls, and
/// above other labels that it would lie on.
fn label(
    canvas: &mut Canvas,
    frame: Frame,
    points: &[Point],
    text: &str,
    labels: &mut Vec<Point>,
) {
    let Some(&(x, y)) = points.get(points.len() / 2) else { return };
    let rises = points[0].1 > points[points.len() - 1].1 + 1.0;
    let room = text_width(text) + 12.0;
    let fits = x - room > frame.left;
    let (x, anchor) = match rises && fits {
        true => (x - 10.0, Anchor::End),
        false => (x.min(canvas.width() - room) + 10.0, Anchor::Start),
    };
    let begin = if anchor == Anchor::End { x - room } else { x };
    let mut y = (y - 12.0).max(frame.top + 12.0);
    let near = |(left, height): &Point, y: f64| {
        (left - begin).abs() < room && (height - y).abs() < LINE
    };
    while labels.iter().any(|other| near(other, y)) {
        y -= LINE;
    }
    labels.push((begin, y));
    canvas.text((x, y), anchor, MASS, text);
}

fn caption(p: &Pictured, stretched: f64) -> String {
    let mut out = if p.is_marked() {
        "Distances of what is marked are along the slope, on the axis that \
         events share."
    } else {
        "The track."
    }
    .to_owned();
    if stretched.is_finite() && (stretched - 1.0).abs() > 0.05 {
        let times = short(stretched, 2);
        out += &format!(
            " Heights are drawn {times} times as large as distances."
        );
    } else {
        out += " Heights and distances have the same scale.";
    }
    out
}
