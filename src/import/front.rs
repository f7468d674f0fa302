//! What the distances of a front over time say of its speed.

/// Steps that differ by this share are even.
const EVEN: f64 = 0.01;

/// Mean speeds between each distance and the one before, (c_t - c_(t-1)) / dt
/// (Heredia et al. 2020, equation 13) \[m/s\].
pub(super) fn mean_speeds(times: &[f64], way: &[f64]) -> Vec<f64> {
    let steps = times.windows(2).zip(way.windows(2));
    steps.map(|(t, s)| (s[1] - s[0]) / (t[1] - t[0])).collect()
}

/// The speed at the first distance \[m/s\]: the slope there of the parabola
/// through the first three, exact under a constant acceleration; 0 where that
/// would go backwards.
pub(super) fn speed_at_start(times: &[f64], way: &[f64]) -> f64 {
    let (&[t, u, v, ..], &[a, b, c, ..]) = (times, way) else { return 0.0 };
    let (first, second) = ((b - a) / (u - t), (c - b) / (v - u));
    let bend = (second - first) / (v - t);
    (first - bend * (u - t)).max(0.0)
}

/// The step of times that are even \[s\]; nothing where they are not.
pub(super) fn even_step(times: &[f64]) -> Option<f64> {
    let (first, last) = times.first().zip(times.last())?;
    let step = (last - first) / (times.len().checked_sub(1)? as f64);
    let near = |t: &[f64]| (t[1] - t[0] - step).abs() <= EVEN * step;
    times.windows(2).all(near).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_acceleration_is_found_from_distances() {
        let times = [0.0, 1.0, 2.5, 3.0, 5.0];
        let way = times.map(|t| 7.0 + 2.0 * t + 1.5 * t * t);
        assert!((speed_at_start(&times, &way) - 2.0).abs() < 1e-12);
        // The mean speed is that of the middle of the step.
        let middles = [0.5, 1.75, 2.75, 4.0];
        for (mean, at) in mean_speeds(&times, &way).into_iter().zip(middles) {
            assert!((mean - (2.0 + 3.0 * at)).abs() < 1e-12);
        }
        assert_eq!(speed_at_start(&times, &[0.0, 0.0, 1.0, 2.0, 3.0]), 0.0);
        assert_eq!(speed_at_start(&times[..2], &way[..2]), 0.0);
        assert_eq!(even_step(&times), None);
        assert_eq!(even_step(&[1.0, 1.5, 2.0]), Some(0.5));
        assert_eq!(even_step(&[]), None);
    }
}
