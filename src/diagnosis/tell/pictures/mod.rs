//! The pictures of a diagnosis, one a file, on the canvas of all reports.

mod bars;
mod force;
mod recording;
mod track;

pub(crate) use bars::bars;
pub(crate) use force::forces;
use recording::recording;
use track::track;

use crate::diagnosis::{Diagnosis, Mismatch, Pictured};
use crate::physics::forces::Axis;
use crate::report::svg::axes::{Axes, Scale};
use crate::report::svg::canvas::{Canvas, Frame};
use crate::report::svg::palette::MASS;

/// How strongly a located stretch is filled.
const SHADE: f64 = 0.14;

/// A picture with what the reader has to know to read it.
#[derive(Debug)]
pub(crate) struct Figure {
    /// Unique on the page.
    pub(crate) id: String,
    #[cfg_attr(not(feature = "pages"), expect(dead_code))]
    pub(crate) caption: String,
    pub(crate) svg: String,
}

/// The track and the recording of an event, which is the i-th.
pub(crate) fn of_event(
    d: &Diagnosis,
    p: &Pictured,
    i: usize,
) -> [Option<Figure>; 2] {
    let name = |what: &str| format!("{what}-{i}");
    [track(d, p, &name("track")), recording(d, p, &name("recording"))]
}

/// All pictures of a diagnosis.
pub(crate) fn figures(d: &Diagnosis) -> Vec<Figure> {
    let events = d.pictured.iter().enumerate();
    let each = events.flat_map(|(i, p)| of_event(d, p, i));
    each.chain([forces(d), bars(d)]).flatten().collect()
}

/// The pictures of a diagnosis as files: the name of each, and an SVG document
/// on white that needs nothing else.
///
/// ```
/// use couloir::diagnosis::{Diagnosis, pictures};
/// assert!(pictures(&Diagnosis::default()).is_empty());
/// ```
pub fn pictures(d: &Diagnosis) -> Vec<(String, String)> {
    let white = "<svg style=\"background: #fff\" ";
    let file = |f: Figure| {
        (format!("{}.svg", f.id), f.svg.replacen("<svg ", white, 1))
    };
    figures(d).into_iter().map(file).collect()
}

/// Fills the stretches of a panel in which the mismatch lies.
fn shade(canvas: &mut Canvas, axes: &Axes, stretches: &[(f64, f64)]) {
    let Frame { top, bottom, .. } = axes.frame;
    for &(from, to) in stretches {
        let low = from.max(axes.x.low);
        let high = to.min(axes.x.high);
        if low < high {
            let (left, right) = (axes.at(low, 0.0).0, axes.at(high, 0.0).0);
            canvas.rectangle(Frame { left, top, right, bottom }, MASS, SHADE);
        }
    }
}

/// Where the stretches lie along an axis, as the diagnosis has them.
fn along(mismatch: &[Mismatch], axis: Axis) -> Vec<(f64, f64)> {
    let ends = |m: &Mismatch| match axis {
        axis if axis == m.axis => Some((m.from, m.to)),
        Axis::Place => Some((m.place_from, m.place_to)),
        Axis::Time => Some((m.time_from, m.time_to)),
        Axis::Speed => None,
    };
    mismatch.iter().filter_map(ends).collect()
}

/// The same on one of several recordings, each of which comes to a place at
/// its own time.
fn along_in(d: &Diagnosis, p: &Pictured, axis: Axis) -> Vec<(f64, f64)> {
    if d.pictured.len() < 2 {
        return along(&d.mismatch, axis);
    }
    let ends = |m: &Mismatch| -> Option<(f64, f64)> {
        match (axis, m.axis) {
            (Axis::Place, Axis::Time) => Some((
                interpolate(&p.times, &p.places, m.from, true)?,
                interpolate(&p.times, &p.places, m.to, true)?,
            )),
            (Axis::Time, Axis::Place) => Some((
                interpolate(&p.places, &p.times, m.from, true)?,
                interpolate(&p.places, &p.times, m.to, true)?,
            )),
            _ => along(std::slice::from_ref(m), axis).first().copied(),
        }
    };
    d.mismatch.iter().filter_map(ends).collect()
}

/// y at a place between two of `x`, which increases; beyond them nothing, or
/// the nearest.
fn interpolate(x: &[f64], y: &[f64], at: f64, clamped: bool) -> Option<f64> {
    let n = x.len().min(y.len());
    let (x, y) = (&x[..n], &y[..n]);
    let (first, last) = (*x.first()?, *x.last()?);
    let at = if clamped && first <= last { at.clamp(first, last) } else { at };
    if !(first..=last).contains(&at) {
        return None;
    }
    let right = x.partition_point(|v| *v < at).min(n - 1);
    let left = right.saturating_sub(1);
    let step = x[right] - x[left];
    let share = if step > 0.0 { (at - x[left]) / step } else { 1.0 };
    Some(y[left] + share.clamp(0.0, 1.0) * (y[right] - y[left]))
}

/// A scale over the numbers, with some room at both ends.
fn roomy(numbers: impl IntoIterator<Item = f64>) -> Scale {
    Scale::of(numbers).padded(0.04)
}

#[cfg(test)]
mod tests {
    use super::interpolate;

    #[test]
    fn a_time_belongs_to_each_place() {
        let at =
            |x, clamped| interpolate(&[0.0, 2.0], &[1.0, 3.0], x, clamped);
        assert_eq!(at(0.5, false), Some(1.5));
        assert_eq!(at(2.5, false), None);
        assert_eq!(at(2.5, true), Some(3.0));
        assert_eq!(interpolate(&[], &[], 0.0, true), None);
        assert_eq!(interpolate(&[1.0], &[4.0], 1.0, true), Some(4.0));
        assert_eq!(interpolate(&[f64::NAN], &[4.0], 1.0, true), None);
    }
}
