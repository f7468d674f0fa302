//! What several events may lack: the catalogue, spread over them.
//!
//! A mechanism of the physics or of the sensor is the same in all of them, or
//! each event has an amount of its own about a common one; what belongs to a
//! start or a clock is each event's own, and so are sensors that do
//! not record the same quantity.

use crate::mechanism::catalogue::{Catalogue, applies};
use crate::mechanism::{Family, Mechanism, PerEvent, Pooled};
use crate::model::{Member, Together};
use crate::observe::Event;

/// How far a mechanism of the physics or of a sensor is the same in all
/// events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// The same amplitude at the same places.
    Shared,
    /// The same places; each event's amplitude is drawn from a common
    /// distribution.
    Pooled,
}

impl<M: Member> Together<M> {
    /// Every mechanism of a catalogue that applies: those of the physics and
    /// of sensors to all events, with amounts shared as told; the others to
    /// each on its own.
    pub fn catalogue(
        &self,
        known: &Catalogue,
        sharing: Sharing,
    ) -> Vec<Box<dyn Mechanism>> {
        let all = known.of(&self.extent(), &[]).into_iter();
        all.filter_map(|mechanism| self.spread(known, mechanism, sharing))
            .collect()
    }

    /// Whether it can be missing from every event's model.
    fn applies(&self, mechanism: &dyn Mechanism) -> bool {
        self.blocks().iter().all(|blocks| applies(mechanism, blocks))
    }

    /// A mechanism of the catalogue as it is for several events; `None` where
    /// the model of any has what is shared, or of all what is each one's own.
    fn spread(
        &self,
        known: &Catalogue,
        mechanism: Box<dyn Mechanism>,
        sharing: Sharing,
    ) -> Option<Box<dyn Mechanism>> {
        match sharing {
            _ if self.is_each_ones(mechanism.as_ref()) => {
                self.each(known, mechanism.as_ref())
            }
            _ if !self.applies(mechanism.as_ref()) => None,
            Sharing::Shared => Some(mechanism),
            Sharing::Pooled => {
                Some(Box::new(Pooled::new(mechanism, self.labels())))
            }
        }
    }

    /// Whether no amount of it is common to the events: sensors may be one
    /// and the same only where all record the same, on ground.
    fn is_each_ones(&self, mechanism: &dyn Mechanism) -> bool {
        let recorded = |event: &Event| {
            let what = event.recordings().map(|s| (s.quantity(), s.window()));
            (what.collect::<Vec<_>>(), event.extent().carried)
        };
        let alike = || {
            let mut all = self.events().map(recorded);
            let first = all.next();
            all.all(|other| Some(other) == first)
        };
        let sensor = mechanism.family() == Family::Measurement;
        mechanism.is_each_events_own() || (sensor && !alike())
    }

    /// A mechanism in an amount of each event's own, where its model has none.
    fn each(
        &self,
        known: &Catalogue,
        mechanism: &dyn Mechanism,
    ) -> Option<Box<dyn Mechanism>> {
        let label = mechanism.label();
        let of = |(event, blocks): (&Event, &Vec<String>)| {
            known.find(&label, &event.extent(), blocks).ok()
        };
        let each = self.events().zip(self.blocks()).map(of).collect();
        let own = PerEvent::new(each, self.labels())?;
        Some(Box::new(own))
    }
}
