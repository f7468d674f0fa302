//! The times of a recording, as the noise sees them.

/// The times at which values were recorded, with what a correlated noise has
/// to know of them, worked out once.
///
/// ```
/// use couloir::noise::{Grid, Spacing};
/// let rounded = vec![0.0, 0.0667, 0.1333, 0.2, 0.3333];
/// let grid = Grid::new(rounded, None);
/// assert_eq!(*grid.spacing(), Spacing::Gaps(vec![0, 1, 1, 1, 2]));
/// assert!((grid.step() - 1.0 / 15.0).abs() < 1e-4);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    times: Vec<f64>,
    step: f64,
    spacing: Spacing,
    standard_errors: Option<Vec<f64>>,
    /// When the whole recording begins and ends [s].
    span: [f64; 2],
}

/// How the times are spaced.
#[derive(Debug, Clone, PartialEq)]
pub enum Spacing {
    /// Every step has a value.
    Regular,
    /// A regular grid on which values are missing: for each value, how many
    /// steps lie between it and the one before (1 where none is missing; the
    /// first entry is 0).
    Gaps(Vec<usize>),
    /// No grid, or a time that is not later than the one before.
    Uneven,
}

/// How far a time may lie from its grid point, in steps: recorded times are
/// rounded, and a clock that jitters by more is not a grid.
const TOLERANCE: f64 = 0.01;

/// How far it may lie off, in steps, where half the last decimal of the
/// recorded times explains it (0.07, 0.13, 0.20).
const COARSEST: f64 = 0.1;

impl Grid {
    /// From increasing times \[s\] and, where known, the standard error of
    /// each value in the unit of the recording.
    pub fn new(times: Vec<f64>, standard_errors: Option<Vec<f64>>) -> Self {
        let (step, spacing) = measure(&times);
        let ends = [times.first(), times.last()];
        let span = ends.map(|time| time.copied().unwrap_or(0.0));
        Self { times, step, spacing, standard_errors, span }
    }

    /// The first `count` times on the same grid: step, spacing and span stay
    /// those of all times, so that the parameters of a noise mean the same.
    #[must_use]
    pub fn first(&self, count: usize) -> Self {
        let count = count.min(self.len());
        let spacing = match &self.spacing {
            Spacing::Gaps(steps) => Spacing::Gaps(steps[..count].to_vec()),
            other => other.clone(),
        };
        let errors = self.standard_errors.as_ref();
        Self {
            times: self.times[..count].to_vec(),
            step: self.step,
            spacing,
            standard_errors: errors.map(|all| all[..count].to_vec()),
            span: self.span,
        }
    }

    /// The times \[s\].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// How many values there are.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Whether there is no value at all.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// The step of the grid \[s\], fitted to all times; the median step where
    /// the times are uneven, and 1 for fewer than two times.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// How the times are spaced.
    pub fn spacing(&self) -> &Spacing {
        &self.spacing
    }

    /// The known standard error of each value.
    pub fn standard_errors(&self) -> Option<&[f64]> {
        self.standard_errors.as_deref()
    }

    /// Which share of the recording's time has passed at the value `i`; a half
    /// where it takes none.
    pub(crate) fn share(&self, i: usize) -> f64 {
        let [begin, end] = self.span;
        let share = (self.times[i] - begin) / (end - begin);
        if share.is_finite() { share } else { 0.5 }
    }

    /// How far the value `i` lies behind the one before, in steps; 0 for the
    /// first.
    pub(crate) fn distance(&self, i: usize) -> f64 {
        if i == 0 {
            return 0.0;
        }
        match &self.spacing {
            Spacing::Regular => 1.0,
            Spacing::Gaps(steps) => steps[i] as f64,
            Spacing::Uneven => (self.times[i] - self.times[i - 1]) / self.step,
        }
    }
}

/// The step and the spacing of the times.
fn measure(times: &[f64]) -> (f64, Spacing) {
    let mut steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    let increasing = steps.iter().all(|&d| d > 0.0 && d.is_finite());
    steps.retain(|&d| d > 0.0 && d.is_finite());
    let Some(&median) = steps.get(steps.len() / 2) else {
        let empty =
            if increasing { Spacing::Regular } else { Spacing::Uneven };
        return (1.0, empty);
    };
    // Where more than half the values miss their neighbour, the median is a
    // multiple of the step, and the shortest distance is the step.
    for guess in [median, steps[0]] {
        if !increasing {
            break;
        }
        if let Some((step, counts)) = lattice(times, &steps, guess) {
            return (step, spacing(&counts));
        }
    }
    (median, Spacing::Uneven)
}

/// Regular, or with gaps, from the whole steps between values.
fn spacing(counts: &[f64]) -> Spacing {
    if counts.iter().all(|&n| n == 1.0) {
        return Spacing::Regular;
    }
    let first = std::iter::once(0);
    Spacing::Gaps(first.chain(counts.iter().map(|&n| n as usize)).collect())
}

/// The step and the whole steps between values where the times lie on a grid
/// with about the guessed step; `sorted` are the distances between times.
fn lattice(
    times: &[f64],
    sorted: &[f64],
    guess: f64,
) -> Option<(f64, Vec<f64>)> {
    // Short distances first: each sharpens the step for the longer ones, or
    // rounding would add up over a gap.
    let (mut step, mut time, mut count) = (guess, 0.0, 0.0);
    for d in sorted {
        time += d;
        count += (d / step).round();
        step = time / count;
    }
    let counts: Vec<f64> =
        times.windows(2).map(|w| ((w[1] - w[0]) / step).round()).collect();
    // A grid has neighbours; without, its step is the unit of the clock.
    let neighbours = counts.iter().filter(|&&n| n == 1.0).count();
    if !counts.iter().all(|&n| n >= 1.0) || 4 * neighbours < counts.len() {
        return None;
    }
    let (step, spread) = fit(times, &counts);
    let off = (0.5 * resolution(times) / step).clamp(TOLERANCE, COARSEST);
    (spread <= 2.0 * off * (1.0 + 1e-9)).then_some((step, counts))
}

/// The least-squares step of times at whole places, and how far the times
/// scatter about their places from end to end, in steps.
fn fit(times: &[f64], counts: &[f64]) -> (f64, f64) {
    let mut place = 0.0;
    let mut places = vec![place];
    places.extend(counts.iter().map(|n| {
        place += n;
        place
    }));
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (centre, middle) = (mean(&places), mean(times));
    let (mut across, mut along) = (0.0, 0.0);
    for (p, t) in places.iter().zip(times) {
        across += (p - centre) * (t - middle);
        along += (p - centre) * (p - centre);
    }
    let step = across / along;
    let (low, high) = places
        .iter()
        .zip(times)
        .map(|(p, t)| (t - middle) / step - (p - centre))
        .fold((f64::MAX, f64::MIN), |(a, b), d| (a.min(d), b.max(d)));
    (step, high - low)
}

/// The last decimal that the times were recorded to \[s\]; 0 where they have
/// more than six.
fn resolution(times: &[f64]) -> f64 {
    (0..=6)
        .map(|digits| 10_f64.powi(digits))
        .find(|unit| {
            times.iter().all(|t| {
                let scaled = t * unit;
                (scaled - scaled.round()).abs() < 1e-6
            })
        })
        .map_or(0.0, |unit| 1.0 / unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spacing_of(times: &[f64]) -> Spacing {
        Grid::new(times.to_vec(), None).spacing().clone()
    }

    /// Every place of a grid of 1/15 s, rounded to that many decimals.
    fn rounded(places: impl Iterator<Item = u32>, decimals: i32) -> Vec<f64> {
        let unit = 10_f64.powi(decimals);
        places
            .map(|i| 3.0 + f64::from(i) / 15.0)
            .map(|t| (t * unit).round() / unit)
            .collect()
    }

    #[test]
    fn rounded_times_are_a_grid_however_many_they_are() {
        for decimals in [2, 3, 4, 9] {
            for n in [2, 3, 4, 50, 3000] {
                let times = rounded(0..n, decimals);
                let grid = Grid::new(times, None);
                assert_eq!(*grid.spacing(), Spacing::Regular, "{n}");
                // Two roundings of half a unit, over n - 1 steps.
                let tolerance = 10_f64.powi(-decimals) / f64::from(n - 1);
                assert!((grid.step() - 1.0 / 15.0).abs() < tolerance);
            }
        }
    }

    #[test]
    fn missing_values_are_counted_in_steps() {
        let kept = (0..400).filter(|i| i % 7 != 3 && !(50..90).contains(i));
        let steps: Vec<usize> = std::iter::once(0)
            .chain(
                kept.clone()
                    .zip(kept.clone().skip(1))
                    .map(|(a, b)| (b - a) as usize),
            )
            .collect();
        assert!(steps.iter().any(|&n| n > 40));
        for decimals in [3, 4, 9] {
            let times = rounded(kept.clone(), decimals);
            assert_eq!(spacing_of(&times), Spacing::Gaps(steps.clone()));
        }
    }

    #[test]
    fn the_median_may_be_a_gap() {
        let times = [0.0, 2.0, 4.0, 5.0, 7.0, 9.0, 10.0];
        let expected = Spacing::Gaps(vec![0, 2, 2, 1, 2, 2, 1]);
        assert_eq!(spacing_of(&times), expected);
        assert_eq!(Grid::new(times.to_vec(), None).step(), 1.0);
    }

    #[test]
    fn jitter_and_scattered_times_are_uneven() {
        let jitter = |i: i32| (f64::from(i) * 12.9898).sin() * 0.05;
        let times: Vec<f64> =
            (0..40).map(|i| f64::from(i) + jitter(i)).collect();
        let grid = Grid::new(times, None);
        assert_eq!(*grid.spacing(), Spacing::Uneven);
        assert!((grid.step() - 1.0).abs() < 0.05);
        // Whole seconds, but no grid of seconds.
        let scattered = [0.0, 7.0, 15.0, 16.0, 29.0, 37.0, 48.0];
        assert_eq!(spacing_of(&scattered), Spacing::Uneven);
    }

    #[test]
    fn repeated_and_decreasing_times_are_uneven_with_a_usable_step() {
        for times in [&[0.0, 1.0, 1.0, 2.0][..], &[0.0, 2.0, 1.0], &[3.0, 3.0]]
        {
            let grid = Grid::new(times.to_vec(), None);
            assert_eq!(*grid.spacing(), Spacing::Uneven);
            assert!(grid.step() > 0.0);
        }
    }

    #[test]
    fn huge_gaps_do_not_overflow() {
        let times = vec![0.0, 1.0, 2.0, 2.0 + 1e6, 3.0 + 1e6];
        let expected = Spacing::Gaps(vec![0, 1, 1, 1_000_000, 1]);
        assert_eq!(spacing_of(&times), expected);
        let times = [0.0, 1.0, 2.0, 1e12, 1e12 + 1.0];
        let expected = Spacing::Gaps(vec![0, 1, 1, 999_999_999_998, 1]);
        assert_eq!(spacing_of(&times), expected);
        // More than a float resolves is no grid.
        assert_eq!(spacing_of(&[0.0, 1.0, 2.0, 1e300]), Spacing::Uneven);
        assert_eq!(spacing_of(&[-1e308, 0.0, 1e308]), Spacing::Uneven);
    }

    #[test]
    fn shares_are_of_the_time_that_passes() {
        let at = Grid::new(vec![5.0, 6.0, 9.0], None);
        assert_eq!([0, 1, 2].map(|i| at.share(i)), [0.0, 0.25, 1.0]);
        assert_eq!(Grid::new(vec![5.0], None).share(0), 0.5);
        assert!(!at.is_empty() && Grid::new(Vec::new(), None).is_empty());
    }

    #[test]
    fn few_times_are_regular() {
        assert_eq!(spacing_of(&[]), Spacing::Regular);
        assert_eq!(spacing_of(&[4.0]), Spacing::Regular);
        assert_eq!(spacing_of(&[4.0, 4.5]), Spacing::Regular);
        assert_eq!(Grid::new(vec![4.0], None).step(), 1.0);
    }
}
