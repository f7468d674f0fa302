//! The motion of an event, as it is and under a change.

use std::borrow::Cow;

use super::event::Event;
use crate::error::Stop;
use crate::mechanism::Change;
use crate::physics::forces::STEPS;
use crate::physics::{
    Forces, Friction, Release, State, sample, sample_changed, speeds,
};
use crate::scalar::{Kind, Plain, Real};

impl Event {
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
    pub(super) fn changed<K: Kind>(
        &self,
        law: &dyn Friction<K>,
        change: &Change<K>,
        times: impl Iterator<Item = Real<K>>,
        speed_only: bool,
        visit: impl FnMut(State<K>),
    ) -> Result<(), Stop> {
        let release = self.release_changed(change);
        let forces = self.forces(change);
        let path = self.path();
        sample_changed(&path, &law, &forces, release, times, speed_only, visit)
    }

    /// The forces of a change, by the event's own clock. Where none is added,
    /// nothing says how often a law that varies with the speed has to be looked
    /// at: as often as under a mechanism's force.
    pub(super) fn forces<'c, K: Kind>(
        &self,
        change: &'c Change<K>,
    ) -> Cow<'c, Forces<K>> {
        let forces = match self.clock() {
            0.0 => Cow::Borrowed(&change.forces),
            clock => Cow::Owned(change.forces.clone().sooner(clock)),
        };
        if forces.step.is_finite() {
            return forces;
        }
        let last = self.samples().last().copied().filter(|last| *last > 0.0);
        let step = last.unwrap_or(1.0) / STEPS;
        Cow::Owned(Forces { step, ..forces.into_owned() })
    }

    /// The release under a change.
    pub(super) fn release_changed<K: Kind>(
        &self,
        change: &Change<K>,
    ) -> Release<K> {
        let Release { distance, speed } = self.release::<K>();
        Release {
            distance: distance + change.start_place,
            speed: speed + change.start_speed,
        }
    }
}
