//! A recorded series: what was measured, when, and how well.

use std::fmt;

use crate::error::{Error, Result};
use crate::noise::Grid;

/// What a value of a recording is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Speed along the slope \[m/s\].
    Velocity,
    /// Distance travelled along the slope since the release \[m\].
    Position,
    /// Rate of change of the speed \[m/s2\].
    Acceleration,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 3] =
        [Self::Velocity, Self::Position, Self::Acceleration];

    /// Its name in event files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Position => "position",
            Self::Acceleration => "acceleration",
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Velocity => "m/s",
            Self::Position => "m",
            Self::Acceleration => "m/s2",
        }
    }

    /// The unit of how fast it changes.
    pub fn rate_unit(self) -> &'static str {
        match self {
            Self::Velocity => "m/s2",
            Self::Position => "m/s",
            Self::Acceleration => "m/s3",
        }
    }

    /// The unit of its square.
    pub fn squared_unit(self) -> &'static str {
        match self {
            Self::Velocity => "m2/s2",
            Self::Position => "m2",
            Self::Acceleration => "m2/s4",
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A recorded series of one quantity.
///
/// ```
/// use couloir::Series;
/// let series = Series::velocity(vec![1.0, 2.0], vec![4.3, 8.1])?;
/// assert_eq!(series.len(), 2);
/// assert!(Series::velocity(vec![2.0, 1.0], vec![4.3, 8.1]).is_err());
/// # Ok::<(), couloir::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    quantity: Quantity,
    window: f64,
    grid: Grid,
    values: Vec<f64>,
    /// For each value, which of its event's samples it needs: at its time,
    /// and at the beginning of its window.
    pub(super) at: Vec<usize>,
    pub(super) since: Vec<usize>,
}

impl Series {
    /// A series of a quantity at times \[s\] after the release.
    ///
    /// # Errors
    /// Unequal lengths, no value, numbers that are not finite, times that
    /// are negative or do not increase.
    pub fn new(
        quantity: Quantity,
        times: Vec<f64>,
        values: Vec<f64>,
    ) -> Result<Self> {
        check(quantity, &times, &values)?;
        Ok(Self {
            quantity,
            window: 0.0,
            grid: Grid::new(times, None),
            values,
            at: Vec::new(),
            since: Vec::new(),
        })
    }

    /// Speeds \[m/s\] at times \[s\]; errors as in [`Series::new`].
    pub fn velocity(times: Vec<f64>, values: Vec<f64>) -> Result<Self> {
        Self::new(Quantity::Velocity, times, values)
    }

    /// Distances since the release \[m\]; errors as in [`Series::new`].
    pub fn position(times: Vec<f64>, values: Vec<f64>) -> Result<Self> {
        Self::new(Quantity::Position, times, values)
    }

    /// Accelerations \[m/s2\]; errors as in [`Series::new`].
    pub fn acceleration(times: Vec<f64>, values: Vec<f64>) -> Result<Self> {
        Self::new(Quantity::Acceleration, times, values)
    }

    /// A series that was not recorded.
    pub(super) fn absent(quantity: Quantity) -> Self {
        Self {
            quantity,
            window: 0.0,
            grid: Grid::new(Vec::new(), None),
            values: Vec::new(),
            at: Vec::new(),
            since: Vec::new(),
        }
    }

    /// Says that a value is the mean over the last `window` seconds, as
    /// speeds from two images are (Heredia et al. 2020, equation 13). Before
    /// the release there is no motion to average over: there the window
    /// begins at t = 0.
    ///
    /// # Errors
    /// A window that is negative, not finite, or on positions.
    pub fn with_window(mut self, window: f64) -> Result<Self> {
        if !(window >= 0.0 && window.is_finite()) {
            return Err(Error::input(format!(
                "the window is {window}; expected seconds, 0 or more"
            )));
        }
        if window > 0.0 && self.quantity == Quantity::Position {
            return Err(Error::input(
                "a window on positions is not supported; give the mean speed \
                 as velocity with this window, or window = 0",
            ));
        }
        self.window = window;
        Ok(self)
    }

    /// Gives each value its known standard error, in the series' unit.
    ///
    /// # Errors
    /// Another number of them, or one that is negative or not finite.
    pub fn with_standard_errors(mut self, errors: Vec<f64>) -> Result<Self> {
        if errors.len() != self.len() {
            return Err(Error::input(format!(
                "{} standard errors for {} values; expected one each",
                errors.len(),
                self.len()
            )));
        }
        if let Some(i) =
            errors.iter().position(|s| !(*s >= 0.0 && s.is_finite()))
        {
            return Err(Error::input(format!(
                "the standard error of value {} is {}; expected 0 or more",
                i + 1,
                errors[i]
            )));
        }
        self.grid = Grid::new(self.times().to_vec(), Some(errors));
        Ok(self)
    }

    /// What was measured.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Over how many last seconds a value is the mean \[s\]; 0:
    /// instantaneous.
    pub fn window(&self) -> f64 {
        self.window
    }

    /// The times, as a noise sees them.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The times \[s\].
    pub fn times(&self) -> &[f64] {
        self.grid.times()
    }

    /// The values, in the quantity's unit.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// How many values there are.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether nothing was recorded.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The same series with other values, such as a replicate's.
    ///
    /// # Errors
    /// Another number of values, or one that is not finite.
    pub fn with_values(&self, values: Vec<f64>) -> Result<Self> {
        check(self.quantity, self.times(), &values)?;
        Ok(Self { values, ..self.clone() })
    }
}

impl Series {
    /// How many values a share of them is: one at the least.
    pub fn part(&self, share: f64) -> usize {
        ((share * self.len() as f64) as usize).clamp(1, self.len())
    }

    /// The first `count` values, as if the recording had ended there.
    ///
    /// # Errors
    /// No value, or more than there are.
    pub fn first(&self, count: usize) -> Result<Self> {
        if count == 0 || count > self.len() {
            return Err(Error::input(format!(
                "the first {count} values of a {} series of {}; expected \
                 from 1 to all",
                self.quantity,
                self.len()
            )));
        }
        Ok(Self {
            quantity: self.quantity,
            window: self.window,
            grid: self.grid.first(count),
            values: self.values[..count].to_vec(),
            at: Vec::new(),
            since: Vec::new(),
        })
    }
}

impl AsRef<Series> for Series {
    fn as_ref(&self) -> &Series {
        self
    }
}

fn check(quantity: Quantity, times: &[f64], values: &[f64]) -> Result<()> {
    if times.len() != values.len() || times.is_empty() {
        return Err(Error::input(format!(
            "a {quantity} series has {} times and {} values; expected one \
             time for each value and at least one",
            times.len(),
            values.len()
        )));
    }
    for (i, (t, v)) in times.iter().zip(values).enumerate() {
        if !t.is_finite() || !v.is_finite() || *t < 0.0 {
            return Err(Error::input(format!(
                "value {} of the {quantity} series is {v} at t = {t}; \
                 expected finite numbers and a time of 0 or more",
                i + 1
            )));
        }
    }
    match times.windows(2).position(|w| w[1] <= w[0]) {
        Some(i) => Err(Error::input(format!(
            "the times of the {quantity} series do not increase: t = {} \
             follows t = {} at value {}",
            times[i + 1],
            times[i],
            i + 2
        ))),
        None => Ok(()),
    }
}

/// The distance covered at given speeds, by the trapezoidal rule.
pub(super) fn path_length(speed: f64, times: &[f64], speeds: &[f64]) -> f64 {
    let (mut time, mut before, mut distance) = (0.0, speed, 0.0);
    for (&t, &v) in times.iter().zip(speeds) {
        distance += 0.5 * (v + before) * (t - time);
        (time, before) = (t, v);
    }
    distance
}
