//! A line fitted to the values near a place: smooth, and without a bend at
//! the ends, as a plain mean would have.

/// A value and its slope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fit {
    pub(super) value: f64,
    pub(super) slope: f64,
}

/// The straight line fitted to the samples within `half` of a place, those
/// near it weighing more (tricube); nothing where there are fewer than two
/// places. `samples` are places, which do not fall, with their values.
pub(super) fn fit(
    samples: &[(f64, f64)],
    place: f64,
    half: f64,
) -> Option<Fit> {
    let first = samples.partition_point(|s| s.0 <= place - half);
    let last = samples.partition_point(|s| s.0 < place + half);
    let near = samples.get(first..last)?;
    let (mut w, mut wu, mut wuu, mut wy, mut wuy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (at, value) in near {
        // In widths of the window, so that the sums are near 1.
        let u = (at - place) / half;
        let weight = (1.0 - u.abs().powi(3)).powi(3);
        w += weight;
        wu += weight * u;
        wuu += weight * u * u;
        wy += weight * value;
        wuy += weight * u * value;
    }
    let spread = w * wuu - wu * wu;
    if near.len() < 2 || spread.is_nan() || spread <= 1e-9 * w * w {
        return None;
    }
    let value = (wuu * wy - wu * wuy) / spread;
    let slope = (w * wuy - wu * wy) / spread / half;
    Some(Fit { value, slope })
}

/// The value between two samples; that of the nearest beyond their ends, and
/// nothing where there are none.
pub(super) fn between(samples: &[(f64, f64)], place: f64) -> Option<f64> {
    let above = samples.partition_point(|s| s.0 < place);
    let below = above.checked_sub(1).and_then(|i| samples.get(i));
    match (below, samples.get(above)) {
        (Some(a), Some(b)) => {
            let share = (place - a.0) / (b.0 - a.0);
            Some(a.1 + share * (b.1 - a.1))
        }
        (Some(end), None) | (None, Some(end)) => Some(end.1),
        (None, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_stays_a_line_to_its_ends() {
        let line = |x: f64| 100.0 - 0.7 * x;
        let samples: Vec<_> =
            (0..50).map(|i| (f64::from(i), line(f64::from(i)))).collect();
        for at in [0.0, 0.5, 20.0, 49.0] {
            let found = fit(&samples, at, 10.0).unwrap();
            assert!((found.value - line(at)).abs() < 1e-9);
            assert!((found.slope + 0.7).abs() < 1e-9);
        }
        assert_eq!(fit(&samples, 200.0, 10.0), None);
        assert_eq!(fit(&[(1.0, 2.0); 9], 1.0, 10.0), None);
        assert!((between(&samples, 3.5).unwrap() - line(3.5)).abs() < 1e-9);
        assert_eq!(between(&samples, -3.0), Some(100.0));
        assert_eq!(between(&[], 0.0), None);
    }
}
