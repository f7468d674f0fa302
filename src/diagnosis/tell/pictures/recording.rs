//! A recording with what the model predicts, before and after, over time and
//! over distance.

use super::along::{along_in, interpolate};
use super::figure::{Figure, roomy, shade};
use crate::diagnosis::{Diagnosis, Pictured};
use crate::physics::forces::Axis;
use crate::predict::Bands;
use crate::report::digits::ticks;
use crate::report::svg::axes::{Axes, Key, Labels, Scale, legend};
use crate::report::svg::canvas::{Canvas, FONT, Frame, Point, Sheet};
use crate::report::svg::palette::{
    FAINT, FLOW, FULL, INK, MARKED, MASS, POSTERIOR, Pen,
};
use crate::report::svg::series::{
    FLOWS, LOCATED, MEDIAN_FLOW, RECORDED, WITH_ERRORS, least,
};
use crate::report::svg::with_unit;
use crate::report::text::{shorten, thinned};

const PANEL: f64 = 190.0;
const ROW: f64 = PANEL + 78.0;
const GAP: f64 = 24.0;
/// How many values a panel shows.
const VALUES: usize = 1000;
/// At how many times the bands are drawn.
const TIMES: usize = 400;
const MEDIAN: Pen = Pen::new(POSTERIOR, 1.8);

/// Before and after, in two columns; over time and over distance, in two
/// rows. Nothing where nothing was recorded.
pub(crate) fn recording(
    d: &Diagnosis,
    p: &Pictured,
    id: &str,
) -> Option<Figure> {
    Figure::both(|sheet| drawn(d, p, id, sheet))
}

fn drawn(
    d: &Diagnosis,
    p: &Pictured,
    id: &str,
    sheet: Sheet,
) -> Option<Figure> {
    if p.times.is_empty() || p.values.is_empty() {
        return None;
    }
    let columns = columns(p);
    let rows = rows(p);
    let side_by_side = sheet.columns(columns.len());
    let lines = rows.len() * columns.len() / side_by_side;
    let head = legend_height(d, sheet);
    let mut canvas = Canvas::on(sheet, id, head + ROW * lines as f64);
    legend(&mut canvas, 12.0, 2.0, &entries(d));
    let y = value_scale(p, &columns);
    let margin = Axes::margin(y, PANEL);
    let width = (sheet.width() - margin - 14.0 + GAP) / side_by_side as f64;
    let panels =
        rows.iter().flat_map(|row| columns.iter().map(move |c| (row, c)));
    for (i, (row, (title, bands))) in panels.enumerate() {
        let left = margin + width * (i % side_by_side) as f64;
        let top = head + ROW * (i / side_by_side) as f64 + 22.0;
        let (right, bottom) = (left + width - GAP, top + PANEL);
        let frame = Frame { left, top, right, bottom };
        let first = i % side_by_side == 0;
        let panel = Panel { p, bands, over: *row, first };
        canvas.heading((left, top - 8.0), title);
        panel.draw(&mut canvas, frame, y, &along_in(d, p, *row));
    }
    Some(Figure {
        id: id.to_owned(),
        caption: caption(d, p),
        phone: String::new(),
        svg: canvas.finish("The recording with the bands of both models"),
    })
}

fn columns(p: &Pictured) -> Vec<(&'static str, &Bands)> {
    if p.after.times.is_empty() {
        return vec![("the model as it is", &p.before)];
    }
    vec![("before", &p.before), ("after", &p.after)]
}

/// A position over the place would be a straight line.
fn rows(p: &Pictured) -> Vec<Axis> {
    if p.quantity == "position" || p.places.len() < p.times.len().min(2) {
        vec![Axis::Time]
    } else {
        vec![Axis::Time, Axis::Place]
    }
}

fn entries(d: &Diagnosis) -> Vec<(Key, &'static str)> {
    let mut out = vec![
        (Key::Dot(Pen::new(INK, 5.0)), RECORDED),
        (Key::Line(MEDIAN), MEDIAN_FLOW),
        (Key::Fill(FLOW), FLOWS),
        (Key::Fill(FULL), WITH_ERRORS),
    ];
    if !d.mismatch.is_empty() {
        out.push((Key::Fill(MARKED), LOCATED));
    }
    out
}

fn legend_height(d: &Diagnosis, sheet: Sheet) -> f64 {
    let lines = match (sheet, d.mismatch.is_empty()) {
        (Sheet::Page, true) => 1.0,
        (Sheet::Page, false) | (Sheet::Phone, true) => 2.0,
        (Sheet::Phone, false) => 3.0,
    };
    lines * (FONT + 6.0) + 6.0
}

/// One scale for all panels, so that they can be compared.
fn value_scale(p: &Pictured, columns: &[(&str, &Bands)]) -> Scale {
    let bands = columns.iter().flat_map(|(_, b)| {
        [&b.full_low, &b.full_high, &b.median].into_iter().flatten()
    });
    let least = least(&p.quantity);
    let bands = bands.map(|value| value.max(least));
    roomy(p.values.iter().copied().chain(bands))
}

/// One panel: a recording, one model's bands, over one axis.
struct Panel<'a> {
    p: &'a Pictured,
    bands: &'a Bands,
    over: Axis,
    first: bool,
}

impl Panel<'_> {
    fn draw(
        &self,
        canvas: &mut Canvas,
        frame: Frame,
        y: Scale,
        stretches: &[(f64, f64)],
    ) {
        let axes = Axes { frame, x: self.scale(), y };
        shade(canvas, &axes, stretches);
        let quantity = shorten(&self.p.quantity, 24);
        let name = with_unit(&quantity, &self.p.unit);
        let x = if self.over == Axis::Time { "time [s]" } else { PLACE };
        if !self.first {
            grid(canvas, &axes);
        }
        let shown = self.first.then_some(name.as_str());
        axes.draw(canvas, Labels { x: Some(x), y: shown });
        axes.describe(canvas, [x, &name]);
        canvas.clip(frame);
        let b = self.bands;
        let edge = |v: &[f64]| self.edge(&axes, v);
        canvas.of(WITH_ERRORS);
        canvas.area(&edge(&b.full_low), &edge(&b.full_high), FULL, 0.9);
        canvas.of(FLOWS);
        canvas.area(&edge(&b.flow_low), &edge(&b.flow_high), FLOW, 0.9);
        canvas.of(MEDIAN_FLOW);
        canvas.curve(&edge(&b.median), MEDIAN);
        canvas.of(RECORDED);
        self.dots(canvas, &axes);
        canvas.of(LOCATED);
        // The edges of the stretch lie over the bands, which hide its fill.
        for x in stretches.iter().flat_map(|s| [s.0, s.1]) {
            let ends = (axes.at(x, axes.y.low), axes.at(x, axes.y.high));
            canvas.line(ends.0, ends.1, EDGE);
        }
        canvas.unclip();
    }

    fn scale(&self) -> Scale {
        let at = match self.over {
            Axis::Time => &self.p.times,
            _ => &self.p.places,
        };
        Scale::of(at.iter().copied()).padded(0.01)
    }

    /// A line of the bands; over distance as far as the places are known.
    fn edge(&self, axes: &Axes, values: &[f64]) -> Vec<Point> {
        let (times, least) = (&self.bands.times, least(&self.p.quantity));
        let kept = thinned(times.len().min(values.len()), TIMES);
        kept.into_iter()
            .map(|i| (self.x_of(times[i]), values[i].max(least)))
            .map(|(x, y)| axes.at(x, y))
            .collect()
    }

    fn x_of(&self, time: f64) -> f64 {
        match self.over {
            Axis::Time => time,
            _ => interpolate(&self.p.times, &self.p.places, time, false)
                .unwrap_or(f64::NAN),
        }
    }

    fn dots(&self, canvas: &mut Canvas, axes: &Axes) {
        let at = match self.over {
            Axis::Time => &self.p.times,
            _ => &self.p.places,
        };
        let points = axes.points(at, &self.p.values);
        let kept = thinned(points.len(), VALUES);
        let points: Vec<Point> = kept.into_iter().map(|i| points[i]).collect();
        let size = if points.len() > 150 { 2.2 } else { 3.6 };
        canvas.dots(&points, Pen::new(INK, size));
    }
}

/// The lines of a panel whose labels stand at its neighbour.
fn grid(canvas: &mut Canvas, axes: &Axes) {
    let Frame { left, right, .. } = axes.frame;
    let count = (PANEL / 42.0) as usize;
    for (value, _) in ticks(axes.y.low, axes.y.high, count) {
        let y = axes.at(0.0, value).1;
        canvas.line((left, y), (right, y), Pen::new(FAINT, 1.0));
    }
}

const PLACE: &str = "distance along the slope [m]";
const EDGE: Pen = Pen::new(MASS, 1.2).dashed();

fn caption(d: &Diagnosis, p: &Pictured) -> String {
    let mut out = "Nine of ten recorded values should lie in the outer \
         band, and without a pattern. The inner band holds nine of ten flows \
         that the parameters left open by the recording produce; the outer \
         band adds the errors."
        .to_owned();
    if !d.mismatch.is_empty() {
        out += " A speed differs from where the mismatch begins and goes on \
                differing beyond its end.";
    }
    if p.times.len() > VALUES {
        out += &format!(
            " Of {} values, {VALUES} evenly spread ones are drawn.",
            p.times.len()
        );
    }
    out
}
