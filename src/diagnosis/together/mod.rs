//! Several recordings together: one program over several events.
//!
//! Each event keeps its own noise, and its own friction law unless one is
//! shared. A mechanism of the physics or of the sensor is the same in all of
//! them, or each event has an amount of its own about a common one; what
//! belongs to a start, a clock or a noise is each event's own, and so are
//! sensors that do not record the same quantity. `Run::of_event` tells which
//! event's body runs, so that of a change with a part for each event each sees
//! its own, and fits know nothing of it.

mod labels;

use crate::block::List;
use crate::error::{Error, Outcome, Result, Stop};
use crate::mechanism::{Family, Mechanism, PerEvent, Pooled};
use crate::model::{Assembled, Number, Program, Run};
use crate::observe::Extent;
use crate::prior::AnyPrior;
use crate::scalar::Real;
use labels::labels;

use crate::mechanism::catalogue::{catalogue, find, is_held};

/// Several events under one model.
#[derive(Debug)]
pub struct Together {
    events: Vec<Assembled>,
    labels: Vec<String>,
    shared_friction: bool,
}

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

impl Together {
    /// Puts events together: each with its own friction law, or all with the
    /// parameters of the first one's.
    ///
    /// # Errors
    /// No event; with a shared friction, laws or priors that differ.
    pub fn new(events: Vec<Assembled>, shared_friction: bool) -> Result<Self> {
        let Some(first) = events.first() else {
            return Err(Error::input(
                "no event was given; expected one or more",
            ));
        };
        if shared_friction {
            for other in &events[1..] {
                check_alike(first, other)?;
            }
        }
        let labels = labels(events.iter().map(|e| e.event().name()));
        let events = events
            .into_iter()
            .zip(&labels)
            .map(|(event, label)| event.labelled(label, shared_friction))
            .collect();
        Ok(Self { events, labels, shared_friction })
    }

    /// The events with their models, in order.
    pub fn events(&self) -> &[Assembled] {
        &self.events
    }

    /// What each event's parameters are called by, in order.
    pub fn labels(&self) -> &[String] {
        &self.labels
    }

    /// The extent of all events together.
    pub fn extent(&self) -> Extent {
        Extent::of_all(self.events.iter().map(Assembled::event))
    }

    /// Every mechanism that applies: those of the physics and of sensors to
    /// all events, with amounts shared as told; the others to each on its own.
    pub fn catalogue(&self, sharing: Sharing) -> Vec<Box<dyn Mechanism>> {
        catalogue(&self.extent(), &[])
            .into_iter()
            .filter_map(|mechanism| self.spread(mechanism, sharing))
            .collect()
    }

    /// The event whose laws all share, where they do.
    fn first_shared(&self) -> Option<&Assembled> {
        self.events.first().filter(|_| self.shared_friction)
    }

    /// The parameters of the laws that all share, where they do.
    fn shared_laws<K: Number>(
        &self,
        run: &mut Run<'_, K>,
    ) -> std::result::Result<Option<List<Real<K>>>, Stop> {
        self.first_shared().map(|first| first.ask_laws(run)).transpose()
    }

    /// Runs one event under what is changed of it.
    fn run_one<K: Number>(
        &self,
        index: usize,
        shared: Option<&[Real<K>]>,
        run: &mut Run<'_, K>,
    ) -> Outcome {
        let event = &self.events[index];
        run.of_event(index, |run| match shared {
            Some(laws) => event.score(run, laws),
            None => event.run(run),
        })
    }

    /// Whether any event's model has the mechanism already.
    fn has(&self, mechanism: &dyn Mechanism) -> bool {
        self.events.iter().any(|event| is_held(mechanism, &event.blocks()))
    }

    /// A mechanism of the catalogue as it is for several events; `None` where
    /// the model of any has what is shared, or of all what is each one's own.
    fn spread(
        &self,
        mechanism: Box<dyn Mechanism>,
        sharing: Sharing,
    ) -> Option<Box<dyn Mechanism>> {
        match sharing {
            _ if self.is_each_ones(mechanism.as_ref()) => {
                self.each(mechanism.as_ref())
            }
            _ if self.has(mechanism.as_ref()) => None,
            Sharing::Shared => Some(mechanism),
            Sharing::Pooled => {
                Some(Box::new(Pooled::new(mechanism, &self.labels)))
            }
        }
    }

    /// Whether no amount of it is common to the events: sensors may be one
    /// and the same only where all record the same, on ground.
    fn is_each_ones(&self, mechanism: &dyn Mechanism) -> bool {
        let recorded = |event: &Assembled| {
            let event = event.event();
            let what = event.recordings().map(|s| (s.quantity(), s.window()));
            (what.collect::<Vec<_>>(), event.extent().carried)
        };
        let alike = || {
            let mut all = self.events.iter().map(recorded);
            let first = all.next();
            all.all(|other| Some(other) == first)
        };
        let sensor = mechanism.family() == Family::Measurement;
        mechanism.is_each_events_own() || (sensor && !alike())
    }

    /// A mechanism in an amount of each event's own, where its model has none.
    fn each(&self, mechanism: &dyn Mechanism) -> Option<Box<dyn Mechanism>> {
        let label = mechanism.label();
        let of = |event: &Assembled| {
            let extent = event.event().extent();
            find(&label, &extent, &event.blocks()).ok()
        };
        let each = self.events.iter().map(of).collect();
        let own = PerEvent::new(each, &self.labels)?;
        Some(Box::new(own))
    }
}

impl Program for Together {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let shared = self.shared_laws(run)?;
        for i in 0..self.events.len() {
            self.run_one(i, shared.as_deref(), run)?;
        }
        Ok(())
    }

    fn events(&self) -> usize {
        self.events.len()
    }

    fn common(&self) -> usize {
        self.first_shared().map_or(0, Assembled::friction_dimension)
    }

    fn run_common<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        self.shared_laws(run).map(|_| ())
    }

    fn run_event<K: Number>(
        &self,
        event: usize,
        run: &mut Run<'_, K>,
    ) -> Outcome {
        let shared = self.shared_laws(run)?;
        self.run_one(event, shared.as_deref(), run)
    }
}

fn check_alike(first: &Assembled, other: &Assembled) -> Result<()> {
    let laws = |model: &Assembled| -> Vec<(String, AnyPrior)> {
        model
            .law_priors()
            .map(|(name, prior)| (name.to_owned(), *prior))
            .collect()
    };
    let names = (first.event().name(), other.event().name());
    if first.friction() != other.friction() {
        return Err(Error::input(format!(
            "{:?} has the friction {:?} and {:?} has {:?}; events that share \
             one law must name the same: change one, or let each have its own",
            names.0,
            first.friction(),
            names.1,
            other.friction()
        )));
    }
    let differ = laws(first)
        .into_iter()
        .zip(laws(other))
        .find(|(mine, theirs)| mine != theirs);
    match differ {
        None => Ok(()),
        Some((mine, theirs)) => Err(Error::input(format!(
            "the prior of {} is {} in {:?} and {} in {:?}; events that share \
             one law must have the same priors: change one",
            mine.0, mine.1, names.0, theirs.1, names.1
        ))),
    }
}
