//! The terrain with the mass of the median flow on it.

use super::Picture;
use super::axes::{Axes, Key, Labels, Scale, legend};
use super::canvas::{Anchor, Canvas, Frame, Point, Sheet, text_width};
use super::palette::{GREY, INK, MASS, Pen};
use crate::report::digits::short;
use crate::report::text::thinned;
use crate::report::{CalibrationReport, TrackReport};

/// How many surveyed points are drawn.
const POINTS: usize = 1500;
/// How many positions are drawn.
const POSITIONS: usize = 40;

const SURVEY: Pen = Pen::new(GREY, 2.0);
const DOT: Pen = Pen::new(MASS, 8.0);
const REST: Pen = Pen::new(INK, 11.0);

/// The track with the mass on it, where it has at least two points.
pub(super) fn draw(
    report: &CalibrationReport,
    sheet: Sheet,
) -> Option<Picture> {
    let track = &report.track;
    if track.x.len().min(track.z.len()) < 2 {
        return None;
    }
    let (x, y) = (across(track), upwards(track));
    let left = Axes::margin(y, 250.0);
    let right = sheet.width() - 22.0;
    let true_height = (right - left) * y.span() / x.span();
    let height = true_height.clamp(150.0, 400.0);
    let mut canvas = Canvas::on(sheet, "track", height + 84.0);
    let top = legend(&mut canvas, left, 2.0, &entries(track)).max(26.0);
    let frame = Frame { left, right, top, bottom: top + height };
    let axes = Axes { frame, x, y };
    let name = Some("elevation [m]");
    let labels = Labels { x: Some("horizontal distance [m]"), y: name };
    axes.draw(&mut canvas, labels);
    let kept = thinned(track.x.len().min(track.z.len()), POINTS);
    let line: Vec<Point> =
        kept.iter().map(|&i| axes.at(track.x[i], track.z[i])).collect();
    canvas.curve(&line, SURVEY);
    if line.len() <= 60 {
        canvas.dots(&line, Pen::new(GREY, 4.0));
    }
    draw_mass(&mut canvas, &axes, track);
    Some(Picture {
        name: "track",
        title: "Track",
        caption: caption(track, height / true_height),
        phone: String::new(),
        svg: canvas.finish("The track with the mass on it at some times"),
    })
}

fn across(track: &TrackReport) -> Scale {
    let mass = track.positions.iter().chain(&track.rest).map(|p| p.1);
    Scale::of(track.x.iter().copied().chain(mass)).padded(0.02)
}

fn upwards(track: &TrackReport) -> Scale {
    let mass = track.positions.iter().chain(&track.rest).map(|p| p.2);
    Scale::of(track.z.iter().copied().chain(mass)).padded(0.08)
}

fn entries(track: &TrackReport) -> Vec<(Key, &'static str)> {
    let mut out = vec![(Key::Line(SURVEY), "surveyed track")];
    if !track.positions.is_empty() {
        out.push((Key::Dot(DOT), "mass, median flow"));
    }
    if track.rest.is_some() {
        out.push((Key::Dot(REST), "where it comes to rest"));
    }
    out
}

/// Dots for the mass; a time beside each that leaves room for one.
fn draw_mass(canvas: &mut Canvas, axes: &Axes, track: &TrackReport) {
    let rest = track.rest.map(|(t, x, z)| (t, axes.at(x, z)));
    let kept = thinned(track.positions.len(), POSITIONS);
    let mass: Vec<(f64, Point)> = kept
        .into_iter()
        .map(|i| track.positions[i])
        .map(|(t, x, z)| (t, axes.at(x, z)))
        .collect();
    let dots: Vec<Point> = mass.iter().map(|m| m.1).collect();
    canvas.dots(&dots, DOT);
    let mut taken: Vec<Point> = Vec::new();
    if let Some((t, at)) = rest {
        canvas.dots(&[at], REST);
        label(canvas, axes, &mut taken, t, at);
    }
    for (t, at) in mass {
        label(canvas, axes, &mut taken, t, at);
    }
}

fn label(
    canvas: &mut Canvas,
    axes: &Axes,
    taken: &mut Vec<Point>,
    t: f64,
    (x, y): Point,
) {
    let text = format!("{} s", short(t, 3));
    let fits = x + 8.0 + text_width(&text) < canvas.width();
    let low = if fits { (x + 8.0, y - 7.0) } else { (x - 2.0, y - 12.0) };
    let at = (low.0, low.1.max(axes.frame.top));
    let apart = |other: &Point| {
        (other.0 - at.0).abs() > text_width(&text) + 8.0
            || (other.1 - at.1).abs() > 17.0
    };
    let inside = x.is_finite() && y.is_finite();
    if inside && t.is_finite() && taken.iter().all(apart) {
        let anchor = if fits { Anchor::Start } else { Anchor::End };
        canvas.text(at, anchor, MASS, &text);
        taken.push(at);
    }
}

fn caption(track: &TrackReport, exaggeration: f64) -> String {
    let mut out = "Where the mass of the median flow is, with its time. \
         Dots close together mean a slow mass."
        .to_owned();
    if track.positions.is_empty() {
        out = "The surveyed track.".to_owned();
    }
    if exaggeration.is_finite() && (exaggeration - 1.0).abs() > 0.05 {
        out.push_str(&format!(
            " Heights are drawn {} times as large as distances.",
            short(exaggeration, 2)
        ));
    } else {
        out.push_str(" Heights and distances have the same scale.");
    }
    if track.positions.len() > POSITIONS {
        out.push_str(&format!(" {POSITIONS} positions are drawn."));
    }
    out
}
