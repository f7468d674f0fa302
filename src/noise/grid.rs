//! The times of a recording, as the noise sees them.

/// The times at which values were recorded, with what a correlated noise has
/// to know of them, worked out once.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    times: Vec<f64>,
    step: f64,
    spacing: Spacing,
    standard_errors: Option<Vec<f64>>,
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
    /// No grid.
    Uneven,
}

/// How far a time may lie from its grid point, in steps: recorded times are
/// rounded, and a clock that jitters by more is not a grid.
const TOLERANCE: f64 = 0.01;

impl Grid {
    /// From increasing times \[s\] and, where known, the standard error of
    /// each value in the unit of the recording.
    pub fn new(times: Vec<f64>, standard_errors: Option<Vec<f64>>) -> Self {
        let step = median_step(&times);
        let spacing = spacing(&times, step);
        Self { times, step, spacing, standard_errors }
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

    /// The median step \[s\]; 1 for fewer than two values.
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
}

fn median_step(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(1.0)
}

fn spacing(times: &[f64], step: f64) -> Spacing {
    let Some(&start) = times.first() else { return Spacing::Regular };
    let places: Vec<f64> = times.iter().map(|t| (t - start) / step).collect();
    if places.iter().any(|n| (n - n.round()).abs() > TOLERANCE) {
        return Spacing::Uneven;
    }
    let steps: Vec<usize> = std::iter::once(0)
        .chain(
            places.windows(2).map(|w| (w[1].round() - w[0].round()) as usize),
        )
        .collect();
    if steps.iter().skip(1).all(|&n| n == 1) {
        Spacing::Regular
    } else if steps.iter().skip(1).all(|&n| n >= 1) {
        Spacing::Gaps(steps)
    } else {
        Spacing::Uneven
    }
}
