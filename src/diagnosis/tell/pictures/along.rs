//! Where on a picture the mismatch lies.

use crate::diagnosis::{Diagnosis, Mismatch, Pictured};
use crate::physics::forces::Axis;

/// Where the stretches lie along an axis, as the diagnosis has them.
pub(super) fn along(mismatch: &[Mismatch], axis: Axis) -> Vec<(f64, f64)> {
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
pub(super) fn along_in(
    d: &Diagnosis,
    p: &Pictured,
    axis: Axis,
) -> Vec<(f64, f64)> {
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
pub(super) fn interpolate(
    x: &[f64],
    y: &[f64],
    at: f64,
    clamped: bool,
) -> Option<f64> {
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
