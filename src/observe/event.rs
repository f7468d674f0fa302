//! An event: the ground, how the mass starts, and what was recorded.

use std::borrow::Cow;

use super::extent::path_length;
use super::flow::Flow;
use super::scatter::reach_error;
use super::series::{Quantity, Series};
use crate::declared::Declared;
use crate::error::{Error, Result, Stop};
use crate::mechanism::Change;
use crate::physics::forces::STEPS;
use crate::physics::{
    Forces, Friction, Path, Release, Rest, State, Track, rest, rest_changed,
    sample, sample_changed, speeds,
};
use crate::scalar::{Kind, Plain, Real};

/// A window \[s\] so short that a mean over it is the value itself.
const NO_WINDOW: f64 = 1e-6;

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
    distance: f64,
    speed: f64,
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

    /// The mean flow depth h \[m\].
    #[must_use]
    pub fn depth(mut self, depth: f64) -> Self {
        self.event.depth = depth;
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
            distance: 0.0,
            speed: 0.0,
            velocity: Series::absent(Quantity::Velocity),
            position: Series::absent(Quantity::Position),
            acceleration: Series::absent(Quantity::Acceleration),
            samples: Vec::new(),
        };
        let x = event.track.points().0[0];
        EventBuilder { event, x }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The terrain.
    pub fn track(&self) -> &Track {
        &self.track
    }

    /// The mean flow depth \[m\].
    pub fn depth(&self) -> f64 {
        self.depth
    }

    /// Distance along the slope \[m\] and speed \[m/s\] at t = 0.
    pub fn release<K: Kind>(&self) -> Release<K> {
        Release { distance: self.distance.into(), speed: self.speed.into() }
    }

    /// The recorded series; most events have one.
    pub fn recordings(&self) -> impl Iterator<Item = &Series> {
        [&self.velocity, &self.position, &self.acceleration]
            .into_iter()
            .filter(|series| !series.is_empty())
    }

    /// Solves the motion under a declared friction law.
    ///
    /// Only what a model declared can slide, so that no law escapes a change
    /// to the model. This does not compile:
    ///
    /// ```compile_fail,E0308
    /// use couloir::prelude::*;
    /// fn undeclared<K: Kind>(event: &Event, mu: Real<K>) -> Outcome {
    ///     let law = Coulomb { mu };
    ///     event.slide(&law)?; // expected `&Declared<..>`
    ///     Ok(())
    /// }
    /// ```
    ///
    /// With `let law = run.declare(Coulomb { mu })` it does.
    ///
    /// # Errors
    /// [`Stop::Reject`] where the law has no flow with these values.
    #[inline]
    pub fn slide<'a, K: Kind, L: Friction<K>>(
        &'a self,
        friction: &'a Declared<'_, K, L>,
    ) -> Result<Flow<'a, K, L>, Stop> {
        let context = friction.context();
        context.count_slide();
        let mut flow = Flow::new(self, friction);
        let speed_only = self.velocity.window() == 0.0
            && self.position.is_empty()
            && self.acceleration.is_empty();
        if let Some(change) = friction.change()
            && change.moves()
        {
            let visit = |state| flow.push(state, speed_only);
            self.slide_changed(friction, change, speed_only, visit)?;
            return Ok(flow);
        }
        sample(
            &self.path(),
            friction.block(),
            self.release(),
            &self.samples,
            speed_only,
            |state| flow.push(state, speed_only),
        )?;
        Ok(flow)
    }

    /// The speeds \[m/s\] at increasing times \[s\] since the release under
    /// each of many laws: one simulation for each set of parameters, for maps
    /// of a misfit, ensembles and tables. Eight motions are solved side by
    /// side where the law's rates are the same along the whole track
    /// ([`Varies::Nowhere`](crate::physics::Varies), without a linear term or
    /// bends), the others one by one; the results are the same to round-off.
    ///
    /// What a model scores goes through [`Event::slide`], which sees changes
    /// to the model.
    ///
    /// ```
    /// use couloir::physics::{Track, friction::Voellmy};
    /// use couloir::{Event, Real};
    /// let event = Event::on(Track::incline(35.0, 500.0)?).build()?;
    /// let law = |mu: f64| Voellmy::<Real> {
    ///     mu: mu.into(),
    ///     xi: 1000.0.into(),
    /// };
    /// let speeds = event.slide_many(&[0.2, 0.3, 0.9].map(law), &[1.0, 10.0]);
    /// let [fast, slow, held] = &speeds[..] else { unreachable!() };
    /// assert!(fast.as_ref().unwrap()[1] > slow.as_ref().unwrap()[1]);
    /// assert_eq!(held.as_ref().unwrap(), &[0.0, 0.0]);
    /// # Ok::<(), couloir::Error>(())
    /// ```
    ///
    /// [`Stop::Reject`] stands where a law has no flow with its values.
    pub fn slide_many<L: Friction<Plain>>(
        &self,
        laws: &[L],
        times: &[f64],
    ) -> Vec<Result<Vec<f64>, Stop>> {
        speeds(&self.path(), laws, self.release(), times)
    }

    /// The motion under a change, as the recording's clock shows it, with
    /// the speed as the mean over the change's window.
    fn slide_changed<K: Kind, L: Friction<K>>(
        &self,
        friction: &Declared<'_, K, L>,
        change: &Change<K>,
        speed_only: bool,
        mut visit: impl FnMut(State<K>),
    ) -> Result<(), Stop> {
        let law = friction.block();
        let moments = || self.samples.iter().map(|&t| t - change.clock);
        if change.window <= NO_WINDOW {
            return self.changed(law, change, moments(), speed_only, visit);
        }
        let since = moments().map(|t| (t - change.window).max(0.0));
        let mut begins = friction.context().buffer();
        let push = |s: State<K>| begins.push(s.distance);
        self.changed(law, change, since, false, push)?;
        let mut windows = moments().zip(begins.iter());
        self.changed(law, change, moments(), false, |state| {
            let Some((time, &begin)) = windows.next() else { return };
            let cut = change.window_begins && time < change.window;
            let lasts = if cut { time } else { change.window };
            let speed = if lasts > NO_WINDOW {
                (state.distance - begin) / lasts
            } else {
                state.speed
            };
            visit(State { speed, ..state });
        })
    }

    /// The motion at increasing times of the recording's clock \[s\], under
    /// a change of it.
    pub(crate) fn motion<K: Kind, L: Friction<K>>(
        &self,
        law: &L,
        change: &Change<K>,
        times: &[f64],
        visit: impl FnMut(State<K>),
    ) -> Result<(), Stop> {
        if !change.moves() {
            let (path, release) = (self.path(), self.release());
            return sample(&path, law, release, times, false, visit);
        }
        let moments = times.iter().map(|&t| t - change.clock);
        self.changed(law, change, moments, false, visit)
    }

    /// The motion under a change at increasing times since the release.
    fn changed<K: Kind, L: Friction<K>>(
        &self,
        law: &L,
        change: &Change<K>,
        times: impl Iterator<Item = Real<K>>,
        speed_only: bool,
        visit: impl FnMut(State<K>),
    ) -> Result<(), Stop> {
        let release = self.release_changed(change);
        let forces = self.forces(change);
        let path = self.path();
        sample_changed(&path, law, &forces, release, times, speed_only, visit)
    }

    /// The forces of a change. Where none is added, nothing says how often a
    /// law that varies with the speed has to be looked at: as often as under
    /// a mechanism's force.
    fn forces<'c, K: Kind>(
        &self,
        change: &'c Change<K>,
    ) -> Cow<'c, Forces<K>> {
        if change.forces.step.is_finite() {
            return Cow::Borrowed(&change.forces);
        }
        let last = self.samples.last().copied().filter(|last| *last > 0.0);
        let step = last.unwrap_or(1.0) / STEPS;
        Cow::Owned(Forces { step, ..change.forces.clone() })
    }

    /// The release under a change.
    fn release_changed<K: Kind>(&self, change: &Change<K>) -> Release<K> {
        let Release { distance, speed } = self.release::<K>();
        Release {
            distance: distance + change.start_place,
            speed: speed + change.start_speed,
        }
    }

    /// Where and when the mass comes to rest under a friction law and a
    /// change; `None` if it never does.
    pub(crate) fn rest<K: Kind, L: Friction<K>>(
        &self,
        law: &L,
        change: Option<&Change<K>>,
    ) -> Result<Option<Rest<K>>, Stop> {
        match change {
            Some(change) if change.moves() => rest_changed(
                &self.path(),
                law,
                &self.forces(change),
                self.release_changed(change),
            ),
            _ => rest(&self.path(), law, self.release()),
        }
    }

    /// The ground the flow runs on.
    pub fn path(&self) -> Path<'_> {
        Path { track: &self.track, depth: self.depth }
    }

    /// The same event with another recording in place of its own of the same
    /// quantity.
    ///
    /// # Errors
    /// As in [`EventBuilder::build`].
    pub fn with_recording(&self, series: Series) -> Result<Self> {
        let builder = EventBuilder { event: self.clone(), x: 0.0 };
        let mut event = builder.series(series).event;
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
