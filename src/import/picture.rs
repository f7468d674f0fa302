//! The picture of an import: the path from above, elevations, speeds.

use super::case::Case;
use super::crs::Place;
use crate::draws::median;
use crate::report::svg::axes::{Axes, Key, Labels, Scale, legend};
use crate::report::svg::canvas::{Canvas, Frame, WIDTH};
use crate::report::svg::palette::{GREY, INK, MASS, POSTERIOR, Pen};
use crate::report::text::{shorten, thinned};

/// How many values are drawn of anything.
const MOST: usize = 2000;

/// The heights of the panels.
const ABOVE: f64 = 300.0;
const PANEL: f64 = 190.0;
/// The room under a panel for its labels.
const UNDER: f64 = 62.0;
const LEFT: f64 = 76.0;

const TAKEN: Pen = Pen::new(MASS, 3.0);
const CUT: Pen = Pen::new(GREY, 2.0);
const TRACK: Pen = Pen::new(POSTERIOR, 2.0);
const LIMIT: Pen = Pen::new(INK, 1.2).dashed();

/// The picture as an SVG document.
pub(super) fn draw(case: &Case) -> String {
    let height = 70.0 + ABOVE + 2.0 * PANEL + 3.0 * UNDER;
    let mut canvas = Canvas::new("import", height);
    let title = format!("Import of {}", shorten(&case.name, 60));
    canvas.heading((12.0, 20.0), &title);
    let entries = [
        (Key::Dot(TAKEN), "taken"),
        (Key::Dot(CUT), "cut, or not used"),
        (Key::Line(TRACK), "path and track"),
        (Key::Line(LIMIT), "threshold"),
    ];
    let top = legend(&mut canvas, 12.0, 28.0, &entries);
    let frame = |top: f64, height: f64| {
        let (left, right, bottom) = (LEFT, WIDTH - 16.0, top + height);
        Frame { left, top, right, bottom }
    };
    from_above(&mut canvas, frame(top, ABOVE), case);
    let top = top + ABOVE + UNDER;
    elevations(&mut canvas, frame(top, PANEL), case);
    let top = top + PANEL + UNDER;
    speeds(&mut canvas, frame(top, PANEL), case);
    canvas.finish(&title)
}

/// Dots of some of the pairs.
fn dots(canvas: &mut Canvas, axes: &Axes, pairs: &[(f64, f64)], pen: Pen) {
    let kept = thinned(pairs.len(), MOST).into_iter();
    let points: Vec<_> =
        kept.map(|i| axes.at(pairs[i].0, pairs[i].1)).collect();
    canvas.dots(&points, pen);
}

fn curve(canvas: &mut Canvas, axes: &Axes, pairs: &[(f64, f64)], pen: Pen) {
    let kept = thinned(pairs.len(), MOST).into_iter();
    let points: Vec<_> =
        kept.map(|i| axes.at(pairs[i].0, pairs[i].1)).collect();
    canvas.curve(&points, pen);
}

/// The path from above, both directions to one scale, in metres from where
/// the recording begins.
fn from_above(canvas: &mut Canvas, frame: Frame, case: &Case) {
    let taken = case.moving.phase.first..=case.moving.phase.last;
    let origin = case.moving.places[case.moving.phase.first];
    let from = |all: &[Place]| -> Vec<Place> {
        all.iter().map(|p| (p.0 - origin.0, p.1 - origin.1)).collect()
    };
    let own = from(&case.moving.places[taken.clone()]);
    let line = from(case.line.places());
    let scale =
        |of: fn(&Place) -> f64| Scale::of(own.iter().map(of)).padded(0.15);
    let (x, y) = to_one_scale(scale(|p| p.0), scale(|p| p.1), frame);
    let axes = Axes { frame, x, y };
    let labels =
        Labels { x: Some("to the east [m]"), y: Some("to the north [m]") };
    axes.draw(canvas, labels);
    canvas.clip(frame);
    let before = from(&case.moving.places[..case.moving.phase.first]);
    let after = from(&case.moving.places[case.moving.phase.last + 1..]);
    dots(canvas, &axes, &before, CUT.faded(0.4));
    dots(canvas, &axes, &after, CUT.faded(0.4));
    dots(canvas, &axes, &own, Pen::new(MASS, 5.0));
    curve(canvas, &axes, &line, TRACK);
    canvas.unclip();
}

/// The scales with as many metres to the pixel on both.
fn to_one_scale(x: Scale, y: Scale, frame: Frame) -> (Scale, Scale) {
    let metres = (x.span() / frame.width()).max(y.span() / frame.height());
    let wide = |scale: Scale, pixels: f64| {
        let middle = 0.5 * (scale.low + scale.high);
        let half = 0.5 * metres * pixels;
        Scale { low: middle - half, high: middle + half }
    };
    (wide(x, frame.width()), wide(y, frame.height()))
}

fn elevations(canvas: &mut Canvas, frame: Frame, case: &Case) {
    let ground = &case.ground;
    let track: Vec<_> =
        ground.x.iter().copied().zip(ground.z.iter().copied()).collect();
    let end = track.last().map_or(0.0, |p| p.0);
    let samples: Vec<_> = ground
        .samples
        .iter()
        .filter(|s| (0.0..=end).contains(&s.0))
        .copied()
        .collect();
    // The log's heights as far as they tell of the slope: moved onto the
    // terrain by their median offset.
    let over = case.heights_over_terrain();
    let offset = if over.is_empty() { 0.0 } else { median(&over) };
    let distances = case.distances();
    let own = case.moving.rows().iter().zip(&distances);
    let own: Vec<_> = own
        .filter_map(|(fix, x)| Some((*x, fix.height? - offset)))
        .filter(|_| case.terrain.is_some())
        .collect();
    let y = Scale::of(track.iter().chain(&samples).map(|p| p.1)).padded(0.08);
    let x = Scale::of([0.0, end]).padded(0.02);
    let axes = Axes { frame, x, y };
    let labels = Labels {
        x: Some("horizontal distance [m]"),
        y: Some("elevation [m]"),
    };
    axes.draw(canvas, labels);
    canvas.clip(frame);
    dots(canvas, &axes, &own, CUT.faded(0.4));
    dots(canvas, &axes, &samples, CUT);
    let taken = distances.iter().filter_map(|x| Some((*x, ground.at(*x)?)));
    let taken: Vec<_> = taken.collect();
    dots(canvas, &axes, &taken, Pen::new(MASS, 5.0));
    curve(canvas, &axes, &track, TRACK);
    canvas.unclip();
}

fn speeds(canvas: &mut Canvas, frame: Frame, case: &Case) {
    let begin = case.moving.begin();
    let times = case.moving.times();
    let length = times.last().copied().unwrap_or(0.0);
    let around = (0.4 * length).max(5.0);
    let all =
        case.moving.log.fixes.iter().zip(&case.moving.speeds).enumerate();
    let cut: Vec<_> = all
        .filter(|(i, _)| {
            !(case.moving.phase.first..=case.moving.phase.last).contains(i)
        })
        .map(|(_, (fix, speed))| (fix.time - begin, *speed))
        .filter(|(t, _)| (-around..=length + around).contains(t))
        .collect();
    let taken: Vec<_> =
        times.iter().copied().zip(case.recorded.iter().copied()).collect();
    let both = || cut.iter().chain(&taken);
    let x = Scale::of(both().map(|p| p.0)).padded(0.02);
    let y = Scale::of(both().map(|p| p.1).chain([0.0])).padded(0.06);
    let axes = Axes { frame, x, y };
    let labels =
        Labels { x: Some("time from t = 0 [s]"), y: Some("speed [m/s]") };
    axes.draw(canvas, labels);
    canvas.clip(frame);
    let limit = [(x.low, case.threshold), (x.high, case.threshold)];
    curve(canvas, &axes, &limit, LIMIT);
    dots(canvas, &axes, &cut, CUT);
    dots(canvas, &axes, &taken, TAKEN);
    canvas.unclip();
}
