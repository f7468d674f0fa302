//! How large an event is: what default priors of mechanisms are scaled to.

/// Where a recording leads, how long it lasts, and how fast it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Where the recorded run begins on the shared axis \[m\].
    pub begin: f64,
    /// How long it is \[m\].
    pub run: f64,
    /// When the recorded run begins on the shared clock \[s\].
    pub since: f64,
    /// The time from then to the last value \[s\].
    pub duration: f64,
    /// The upper quartile of the recorded speeds \[m/s\].
    pub speed: f64,
    /// The median time between values \[s\].
    pub step: f64,
    /// How far the release lies from the track's first point \[m\].
    pub behind: f64,
    /// The speed at t = 0 \[m/s\].
    pub start_speed: f64,
    /// Whether the ground carries the mass at all.
    pub carried: bool,
    /// Whether the ground bends along the run.
    pub bends: bool,
    /// Whether a mean over a window can be formed of what is recorded.
    pub averages: bool,
    /// The unit of how fast what is recorded changes.
    pub rate_unit: &'static str,
}

/// Of the upper quartile of the speeds, what a released mass starts with at
/// the most: recordings begin at the first speed that a sensor tells from 0.
const SLOW: f64 = 0.2;

impl Extent {
    /// That of some event to which every mechanism applies.
    pub(crate) const EVERYTHING: Self = Self {
        begin: 0.0,
        run: 1.0,
        since: 0.0,
        duration: 1.0,
        speed: 1.0,
        step: 0.1,
        behind: 0.0,
        start_speed: 0.0,
        carried: true,
        bends: true,
        averages: true,
        rate_unit: "m/s2",
    };

    /// Whether the mass is hardly under way at t = 0: one that slides already
    /// was released before.
    pub(crate) fn is_released(&self) -> bool {
        self.start_speed < SLOW * self.speed
    }

    /// The same of an event to which every mechanism applies.
    pub(crate) fn of_everything(&self) -> Self {
        let start_speed = 0.0;
        let everything = Self { start_speed, ..*self };
        Self { carried: true, bends: true, averages: true, ..everything }
    }
}
