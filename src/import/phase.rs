//! Which part of a log is the avalanche.

/// Slower than the threshold for less than this is no rest \[s\].
pub(super) const REST: f64 = 1.0;

/// A log that is silent for longer than this does not go on \[s\].
pub(super) const SILENT: f64 = 10.0;

/// Rows of a log, both included; the first is t = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Phase {
    pub(super) first: usize,
    pub(super) last: usize,
}

/// The stretches of a log above a speed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stretches {
    /// The longest.
    pub(super) longest: Phase,
    /// The others.
    pub(super) others: Vec<Phase>,
}

/// The stretches above a threshold \[m/s\], those bridged that are less than
/// [`REST`] apart.
pub(super) fn stretches(
    times: &[f64],
    speeds: &[f64],
    threshold: f64,
) -> Option<Stretches> {
    let mut all: Vec<Phase> = Vec::new();
    for (i, (time, speed)) in times.iter().zip(speeds).enumerate() {
        // Not a number is not above.
        if !matches!(speed.partial_cmp(&threshold), Some(o) if o.is_gt()) {
            continue;
        }
        match all.last_mut() {
            Some(last) if goes_on(times, *last, i, *time) => last.last = i,
            _ => all.push(Phase { first: i, last: i }),
        }
    }
    let length = |p: &Phase| times[p.last] - times[p.first];
    let longest = (0..all.len())
        .max_by(|a, b| length(&all[*a]).total_cmp(&length(&all[*b])))?;
    let longest = all.remove(longest);
    Some(Stretches { longest, others: all })
}

fn goes_on(times: &[f64], last: Phase, i: usize, time: f64) -> bool {
    let since = time - times[last.last];
    since < REST || (last.last + 1 == i && since < SILENT)
}

/// The stretch with the row before it, at which it is still slower and t = 0,
/// and so many more seconds at either side.
pub(super) fn widened(times: &[f64], stretch: Phase, margin: f64) -> Phase {
    let before = stretch.first.saturating_sub(1);
    let is_near = times[stretch.first] - times[before] < SILENT;
    let first = if is_near { before } else { stretch.first };
    let (from, to) = (times[first] - margin, times[stretch.last] + margin);
    between(times, Some(from), Some(to)).unwrap_or(stretch)
}

/// The rows between two moments.
pub(super) fn between(
    times: &[f64],
    from: Option<f64>,
    to: Option<f64>,
) -> Option<Phase> {
    let first = from.map_or(0, |from| times.partition_point(|t| *t < from));
    let end = to.map_or(times.len(), |to| times.partition_point(|t| *t <= to));
    (first < end).then(|| Phase { first, last: end - 1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_stretch_is_found_and_widened() {
        let times: Vec<f64> = (0..40).map(|i| 0.4 * f64::from(i)).collect();
        let mut speeds = vec![0.1; 40];
        speeds[2..5].fill(9.0);
        speeds[10..20].fill(3.0);
        // A dip of one row is bridged, and not a number is none.
        speeds[15] = 0.2;
        speeds[30] = f64::NAN;
        let found = stretches(&times, &speeds, 0.6).unwrap();
        assert_eq!(found.longest, Phase { first: 10, last: 19 });
        assert_eq!(found.others, [Phase { first: 2, last: 4 }]);
        let wide = widened(&times, found.longest, 0.0);
        assert_eq!(wide, Phase { first: 9, last: 19 });
        let wide = widened(&times, found.longest, 1.0);
        assert_eq!(wide, Phase { first: 7, last: 21 });
        assert_eq!(stretches(&times, &speeds, 10.0), None);
        let all = between(&times, Some(-1.0), None);
        assert_eq!(all, Some(Phase { first: 0, last: 39 }));
        assert_eq!(between(&times, Some(3.0), Some(2.0)), None);
    }
}
