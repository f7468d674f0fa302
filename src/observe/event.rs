//! An event: the ground, how the mass starts, and what was recorded.

use super::scatter::reach_error;
use super::series::{Quantity, Series, path_length};
use crate::error::{Error, Result};
use crate::physics::{Depth, DepthSteps, Path, Release, Track};
use crate::scalar::Kind;

/// How many standard errors of the distance that speeds add up to are put
/// down to their scatter: more happen once in 30 000 recordings.
const MOST_ERRORS: f64 = 4.0;

/// One avalanche, or another mass that slid, with its recording.
///
/// ```
/// use couloir::{Event, Series, physics::Track};
/// let event = Event::on(Track::incline(35.0, 500.0)?)
///     .named("a slope")
///     .depth(1.5)
///     .velocity(Series::velocity(vec![1.0, 2.0], vec![2.9, 5.6])?)
///     .build()?;
/// assert_eq!(event.velocity.len(), 2);
/// # Ok::<(), couloir::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    name: String,
    track: Track,
    depth: f64,
    /// How the depth changes with time.
    steps: Option<DepthSteps>,
    distance: f64,
    speed: f64,
    clock: f64,
    /// Recorded speeds; empty where none were.
    pub velocity: Series,
    /// Recorded distances since the release; empty where none were.
    pub position: Series,
    /// Recorded accelerations; empty where none were.
    pub acceleration: Series,
    /// Every time at which the motion is needed, increasing [s].
    samples: Vec<f64>,
}

/// An event in the making; [`Event::on`] starts one.
#[derive(Debug, Clone)]
pub struct EventBuilder {
    event: Event,
    depth: Depth,
    x: f64,
}

impl EventBuilder {
    /// Its name, for titles.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.event.name = name.into();
        self
    }

    /// Where the mass starts: horizontal distance \[m\], and its speed at
    /// t = 0 \[m/s\].
    #[must_use]
    pub fn release(mut self, x: f64, speed: f64) -> Self {
        self.x = x;
        self.event.speed = speed;
        self
    }

    /// The mean flow depth h: a number \[m\], or a [`Depth`] that changes
    /// along the track or with time.
    ///
    /// ```
    /// use couloir::Event;
    /// use couloir::physics::{Depth, DepthRows, Track};
    /// let rows = DepthRows::new(vec![0.0, 300.0], vec![1.0, 2.5])?;
    /// let event = Event::on(Track::incline(35.0, 500.0)?)
    ///     .depth(Depth::Along(rows))
    ///     .build()?;
    /// assert_eq!(event.depth(), 1.0);
    /// # Ok::<(), couloir::Error>(())
    /// ```
    #[must_use]
    pub fn depth(mut self, depth: impl Into<Depth>) -> Self {
        self.depth = depth.into();
        self
    }

    /// The moment of t = 0 on a clock that several events share \[s\]: those
    /// of sensors in one flow.
    #[must_use]
    pub fn clock(mut self, start: f64) -> Self {
        self.event.clock = start;
        self
    }

    /// The recorded speeds.
    #[must_use]
    pub fn velocity(mut self, series: Series) -> Self {
        self.event.velocity = series;
        self
    }

    /// The recorded distances.
    #[must_use]
    pub fn position(mut self, series: Series) -> Self {
        self.event.position = series;
        self
    }

    /// The recorded accelerations.
    #[must_use]
    pub fn acceleration(mut self, series: Series) -> Self {
        self.event.acceleration = series;
        self
    }

    /// A series of whichever quantity.
    #[must_use]
    pub fn series(self, series: Series) -> Self {
        match series.quantity() {
            Quantity::Velocity => self.velocity(series),
            Quantity::Position => self.position(series),
            Quantity::Acceleration => self.acceleration(series),
        }
    }

    /// The event.
    ///
    /// # Errors
    /// A depth or a speed that is impossible, a release off the track, a
    /// mass that can never move, a recording that goes further than the
    /// track, or a value at t = 0 beside a release speed.
    pub fn build(self) -> Result<Event> {
        let mut event = self.event;
        event.set_depth(&self.depth, self.x)?;
        if !(event.depth > 0.0 && event.depth.is_finite()) {
            return Err(Error::input(format!(
                "flow.depth is {}; expected metres, more than 0",
                event.depth
            )));
        }
        if !(event.speed >= 0.0 && event.speed.is_finite()) {
            return Err(Error::input(format!(
                "release.velocity is {}; expected m/s, 0 or more",
                event.speed
            )));
        }
        if !event.clock.is_finite() {
            return Err(Error::input(format!(
                "event.start is {}; expected seconds on the shared clock",
                event.clock
            )));
        }
        event.distance = event
            .track
            .distance_at(self.x)
            .map_err(|error| error.within("release.x"))?;
        event.check_that_it_moves()?;
        event.check_recordings()?;
        event.plan();
        Ok(event)
    }
}

impl Event {
    /// Starts an event on a track; depth 1 m, released at rest at the
    /// track's first point, nothing recorded.
    pub fn on(track: Track) -> EventBuilder {
        let event = Self {
            name: String::new(),
            track,
            depth: 1.0,
            steps: None,
            distance: 0.0,
            speed: 0.0,
            clock: 0.0,
            velocity: Series::absent(Quantity::Velocity),
            position: Series::absent(Quantity::Position),
            acceleration: Series::absent(Quantity::Acceleration),
            samples: Vec::new(),
        };
        let x = event.track.points().0[0];
        EventBuilder { event, depth: Depth::Even(1.0), x }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The terrain.
    pub fn track(&self) -> &Track {
        &self.track
    }

    /// The mean flow depth \[m\]; that at the release where it changes.
    pub fn depth(&self) -> f64 {
        self.depth
    }

    /// Distance along the slope \[m\] and speed \[m/s\] at t = 0.
    pub fn release<K: Kind>(&self) -> Release<K> {
        Release { distance: self.distance.into(), speed: self.speed.into() }
    }

    /// The moment of t = 0 on the shared clock \[s\].
    pub fn clock(&self) -> f64 {
        self.clock
    }

    /// The recorded series; most events have one.
    pub fn recordings(&self) -> impl Iterator<Item = &Series> {
        [&self.velocity, &self.position, &self.acceleration]
            .into_iter()
            .filter(|series| !series.is_empty())
    }

    /// The ground the flow runs on.
    pub fn path(&self) -> Path<'_> {
        Path::new(&self.track, self.depth).during(self.steps.as_ref())
    }

    /// The same event with another recording in place of its own of the same
    /// quantity.
    ///
    /// # Errors
    /// As in [`EventBuilder::build`].
    pub fn with_recording(&self, series: Series) -> Result<Self> {
        let mut event = self.clone();
        let recorded = match series.quantity() {
            Quantity::Velocity => &mut event.velocity,
            Quantity::Position => &mut event.position,
            Quantity::Acceleration => &mut event.acceleration,
        };
        *recorded = series;
        event.check_recordings()?;
        event.plan();
        Ok(event)
    }

    /// The same event with the first `count` values of its one recording.
    ///
    /// # Errors
    /// No recording or several, no value, or more than there are.
    pub fn first(&self, count: usize) -> Result<Self> {
        let mut all = self.recordings();
        let (Some(one), None) = (all.next(), all.next()) else {
            return Err(Error::input(
                "the first values of an event are those of its one \
                 recording, and this event has none or several",
            ));
        };
        self.with_recording(one.first(count)?)
    }

    /// Whether the flow depth changes with time.
    pub(super) fn has_depth_steps(&self) -> bool {
        self.steps.is_some()
    }

    fn set_depth(&mut self, depth: &Depth, x: f64) -> Result<()> {
        match depth {
            Depth::Even(depth) => self.depth = *depth,
            Depth::Along(rows) => {
                self.depth = rows.at(x);
                let cut = self.track.with_depths(rows);
                self.track = cut.map_err(|e| e.within("flow.depth"))?;
            }
            Depth::During(rows) => {
                self.depth = rows.at(0.0);
                self.steps = Some(rows.steps());
            }
        }
        Ok(())
    }

    fn check_that_it_moves(&self) -> Result<()> {
        let piece = &self.track.pieces()[self.track.piece_at(self.distance)];
        if self.speed == 0.0 && piece.pull <= 0.0 {
            return Err(Error::input(format!(
                "the mass never moves: it starts at rest where the slope is \
                 {:.1} degrees (positive is downhill); start it where the \
                 track goes down, or give release.velocity",
                self.track.angle(self.distance).to_degrees()
            )));
        }
        Ok(())
    }

    fn check_recordings(&self) -> Result<()> {
        for series in self.recordings() {
            if series.times()[0] == 0.0 && self.speed != 0.0 {
                return Err(Error::input(format!(
                    "the recording has a value at t = 0 ({}) beside \
                     release.velocity = {}; both say how the mass starts: \
                     drop one of them",
                    series.values()[0],
                    self.speed
                )));
            }
            let reach = self.reach(series);
            let left = self.track.length() - self.distance;
            let errors = MOST_ERRORS * reach_error(series);
            if reach > left + errors {
                return Err(Error::input(format!(
                    "the recording covers {reach:.1} m ({errors:.1} m of it \
                     may be its scatter), but the track has only {left:.1} m \
                     beyond the release; extend the track, or shorten the \
                     recording"
                )));
            }
        }
        Ok(())
    }

    /// The distance that a recording itself shows \[m\]: its greatest
    /// position, or its speeds summed by the trapezoidal rule.
    pub(super) fn reach(&self, series: &Series) -> f64 {
        match series.quantity() {
            Quantity::Position => {
                series.values().iter().copied().fold(0.0, f64::max)
            }
            Quantity::Velocity => {
                path_length(self.speed, series.times(), series.values())
            }
            Quantity::Acceleration => 0.0,
        }
    }

    /// Works out at which times the motion is needed, and for each value of
    /// each series which of them are its own.
    fn plan(&mut self) {
        let mut samples = Vec::new();
        for series in self.recordings() {
            for &t in series.times() {
                samples.push(t);
                if series.window() > 0.0 {
                    samples.push((t - series.window()).max(0.0));
                }
            }
        }
        samples.sort_by(f64::total_cmp);
        samples.dedup();
        let index = |t: f64| samples.partition_point(|&s| s < t);
        for series in
            [&mut self.velocity, &mut self.position, &mut self.acceleration]
        {
            let window = series.window();
            series.at = series.times().iter().map(|&t| index(t)).collect();
            series.since = series
                .times()
                .iter()
                .map(|&t| index((t - window).max(0.0)))
                .collect();
        }
        self.samples = samples;
    }

    /// The times at which the motion is solved \[s\].
    pub(super) fn samples(&self) -> &[f64] {
        &self.samples
    }
}

/// The release as plain numbers, for pictures.
impl Event {
    /// Distance along the slope \[m\] at which the mass starts.
    pub fn start(&self) -> f64 {
        self.distance
    }

    /// The speed at t = 0 \[m/s\].
    pub fn release_speed(&self) -> f64 {
        self.speed
    }
}
