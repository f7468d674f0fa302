//! The motion at the moments that a recording needs, under whatever law and
//! change there is.

use super::event::Event;
use crate::context::{Buffer, Context};
use crate::error::Stop;
use crate::mechanism::Change;
use crate::physics::{Friction, Rest, State, rest, rest_changed, sample};
use crate::scalar::{Kind, of_each_kind};

/// A window \[s\] so short that a mean over it is the value itself.
const NO_WINDOW: f64 = 1e-6;

/// A kind of number that motions are solved in.
///
/// Its functions are compiled with the library, once for each kind of number,
/// and not again with each model. [`Event::slide`] compiles a model's law only
/// into the motion that calibrations spend their time in: the exact one, as it
/// is.
pub trait MotionKind: Kind {
    /// The motion of an event at its samples under any law and any change.
    ///
    /// # Errors
    /// [`Stop::Reject`] where the law has no flow with these values.
    fn moved(
        event: &Event,
        law: &dyn Friction<Self>,
        change: Option<&Change<Self>>,
        moments: &mut Moments<'_, Self>,
    ) -> Result<(), Stop>;

    /// Where and when the mass comes to rest under a law and a change; `None`
    /// if it never does.
    ///
    /// # Errors
    /// As [`MotionKind::moved`].
    fn rest(
        event: &Event,
        law: &dyn Friction<Self>,
        change: Option<&Change<Self>>,
    ) -> Result<Option<Rest<Self>>, Stop>;
}

// Written for each kind: a function that the trait had itself would be compiled
// where it is called.
macro_rules! motion_kind {
    ($($kind:ty),*) => {
        $(impl MotionKind for $kind {
            fn moved(
                event: &Event,
                law: &dyn Friction<Self>,
                change: Option<&Change<Self>>,
                moments: &mut Moments<'_, Self>,
            ) -> Result<(), Stop> {
                moved(event, law, change, moments)
            }

            fn rest(
                event: &Event,
                law: &dyn Friction<Self>,
                change: Option<&Change<Self>>,
            ) -> Result<Option<Rest<Self>>, Stop> {
                rest_of(event, law, change)
            }
        })*
    };
}
of_each_kind!(motion_kind);

/// The motion at the moments that were asked for.
#[derive(Debug)]
pub struct Moments<'a, K: Kind> {
    /// Whether speeds are all that is asked for.
    pub(super) speed_only: bool,
    pub(super) speed: Buffer<'a, K>,
    pub(super) distance: Buffer<'a, K>,
    pub(super) acceleration: Buffer<'a, K>,
    context: &'a Context<K>,
}

impl<'a, K: Kind> Moments<'a, K> {
    /// None yet.
    pub(super) fn new(context: &'a Context<K>, speed_only: bool) -> Self {
        let [speed, distance, acceleration] =
            [(); 3].map(|()| context.buffer());
        Self { speed_only, speed, distance, acceleration, context }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, state: State<K>) {
        self.speed.push(state.speed);
        if !self.speed_only {
            self.distance.push(state.distance);
            self.acceleration.push(state.acceleration);
        }
    }
}

fn moved<K: Kind>(
    event: &Event,
    law: &dyn Friction<K>,
    change: Option<&Change<K>>,
    moments: &mut Moments<'_, K>,
) -> Result<(), Stop> {
    let none = Change::default();
    let change = match change {
        Some(change) => change,
        None if event.has_depth_steps() => &none,
        None => {
            let (path, release) = (event.path(), event.release());
            let (samples, speed_only) = (event.samples(), moments.speed_only);
            let visit = |state| moments.push(state);
            return sample(&path, &law, release, samples, speed_only, visit);
        }
    };
    event.slide_changed(law, change, moments)
}

fn rest_of<K: Kind>(
    event: &Event,
    law: &dyn Friction<K>,
    change: Option<&Change<K>>,
) -> Result<Option<Rest<K>>, Stop> {
    match change {
        Some(change) if change.moves() => rest_changed(
            &event.path(),
            &law,
            &event.forces(change),
            event.release_changed(change),
        ),
        _ => rest(&event.path(), &law, event.release()),
    }
}

impl Event {
    /// The motion under a change, as the recording's clock shows it, with
    /// the speed as the mean over the change's window.
    fn slide_changed<K: Kind>(
        &self,
        law: &dyn Friction<K>,
        change: &Change<K>,
        moments: &mut Moments<'_, K>,
    ) -> Result<(), Stop> {
        let times = || self.samples().iter().map(|&t| t - change.clock);
        if change.window <= NO_WINDOW {
            let speed_only = moments.speed_only;
            let visit = |state| moments.push(state);
            return self.changed(law, change, times(), speed_only, visit);
        }
        let since = times().map(|t| (t - change.window).max(0.0));
        let mut begins = moments.context.buffer();
        let push = |s: State<K>| begins.push(s.distance);
        self.changed(law, change, since, false, push)?;
        let mut windows = times().zip(begins.iter());
        self.changed(law, change, times(), false, |state| {
            let Some((time, &begin)) = windows.next() else { return };
            let cut = change.window_begins && time < change.window;
            let lasts = if cut { time } else { change.window };
            let speed = if lasts > NO_WINDOW {
                (state.distance - begin) / lasts
            } else {
                state.speed
            };
            moments.push(State { speed, ..state });
        })
    }
}
