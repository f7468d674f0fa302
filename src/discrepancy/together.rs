//! Several recordings together: one program over several events.
//!
//! Each event keeps its own noise, and its own friction law unless one is
//! shared. A mechanism of the physics is the same in all of them, or each
//! event has an amount of its own about a common one; what belongs to a
//! start, a sensor or a noise is each event's own. `Run::of_event` tells
//! which event's body runs, so that of a change with a part for each event
//! each sees its own, and fits know nothing of it.

use std::sync::Arc;

use crate::block::List;
use crate::change::{
    Candidate, Change, ChangeKind, ChangeOf, Concern, Family, Mechanism, Noun,
    Reach, Unknown,
};
use crate::error::{Error, Outcome, Result, Stop};
use crate::model::{Assembled, Number, Program, Run};
use crate::observe::Extent;
use crate::physics::forces::Axis;
use crate::prior::AnyPrior;
use crate::scalar::Real;

use super::mechanisms::{catalogue, find, is_held};

/// How many characters a label has at the most.
const LONGEST: usize = 16;
/// The prior scale of how far the logarithm of an event's own amplitude lies
/// from that of the common one, where amplitudes have one sign.
const RATIO: f64 = 0.5;

/// Several events under one model.
#[derive(Debug)]
pub struct Together {
    events: Vec<Assembled>,
    labels: Vec<String>,
    shared_friction: bool,
}

/// How far a mechanism of the physics is the same in all events.
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
            .map(|(event, label)| {
                let laws = event.friction_dimension();
                event.labelled(label, if shared_friction { laws } else { 0 })
            })
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

    /// Every mechanism that applies: those of the physics to all events, with
    /// amounts shared as told; the others to each on its own.
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
    /// a law of any has it, or the noise or the sensor of all.
    fn spread(
        &self,
        mechanism: Box<dyn Mechanism>,
        sharing: Sharing,
    ) -> Option<Box<dyn Mechanism>> {
        match (mechanism.family(), sharing) {
            (Family::Physics, _) if self.has(mechanism.as_ref()) => None,
            (Family::Physics, Sharing::Shared) => Some(mechanism),
            (Family::Physics, Sharing::Pooled) => {
                Some(Box::new(Pooled::new(mechanism, &self.labels)))
            }
            _ => {
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
            .priors()
            .take(model.friction_dimension())
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

/// Short and different names: the first words, numbered where they are alike.
fn labels<'n>(names: impl Iterator<Item = &'n str>) -> Vec<String> {
    let mut labels: Vec<String> = Vec::new();
    for name in names {
        let word = name.split_whitespace().next().unwrap_or_default();
        let plain = |c: &char| c.is_ascii_alphanumeric() || "_-".contains(*c);
        let short: String = word.chars().filter(plain).take(LONGEST).collect();
        let short = if short.is_empty() { "event".into() } else { short };
        let mut label = short.clone();
        let mut number = 1;
        while labels.contains(&label) {
            number += 1;
            label = format!("{short}-{number}");
        }
        labels.push(label);
    }
    labels
}

/// An event's own mechanism.
#[derive(Debug, Clone)]
struct Own {
    /// Which event.
    event: usize,
    mechanism: Arc<dyn Mechanism>,
    /// How much is unknown about it.
    count: usize,
}

/// A mechanism that each of several events has in an amount of its own.
#[derive(Debug)]
pub struct PerEvent {
    each: Vec<Own>,
    events: usize,
    unknowns: Vec<Unknown>,
}

impl PerEvent {
    /// One mechanism for each event, of one name, or none where it does not
    /// apply; `None` if it applies to no event.
    pub fn new(
        each: Vec<Option<Box<dyn Mechanism>>>,
        labels: &[String],
    ) -> Option<Self> {
        let events = each.len();
        let (mut own, mut unknowns) = (Vec::new(), Vec::new());
        for (event, mechanism) in each.into_iter().enumerate() {
            let Some(mechanism) = mechanism else { continue };
            let label = labels.get(event).map_or("", String::as_str);
            let added = mechanism.unknowns();
            let (mechanism, count) = (Arc::from(mechanism), added.len());
            own.push(Own { event, mechanism, count });
            unknowns.extend(added.iter().map(|one| of_event(one, label)));
        }
        (!own.is_empty()).then_some(Self { each: own, events, unknowns })
    }

    fn one(&self) -> &dyn Mechanism {
        self.each[0].mechanism.as_ref()
    }
}

fn of_event(unknown: &Unknown, label: &str) -> Unknown {
    let name = format!("{label}.{}", unknown.name);
    Unknown { name, ..unknown.clone() }
}

/// What is said of a mechanism with others inside, it says by one of them.
macro_rules! says_as {
    ($inner:ident) => {
        fn name(&self) -> &'static str {
            self.$inner().name()
        }
        fn label(&self) -> String {
            self.$inner().label()
        }
        fn family(&self) -> Family {
            self.$inner().family()
        }
        fn noun(&self, amplitude: f64) -> Noun {
            self.$inner().noun(amplitude)
        }
        fn says(&self) -> &'static str {
            self.$inner().says()
        }
        fn unknowns(&self) -> Vec<Unknown> {
            self.unknowns.clone()
        }
        fn leading(&self) -> usize {
            self.$inner().leading()
        }
        fn coordinate(&self) -> Option<Axis> {
            self.$inner().coordinate()
        }
        fn form(&self) -> Option<&'static str> {
            self.$inner().form()
        }
        fn reach(&self, values: &[f64]) -> Option<Reach> {
            self.$inner().reach(values)
        }
        fn contained_in(&self) -> &'static [&'static str] {
            self.$inner().contained_in()
        }
        fn formula(&self) -> String {
            self.$inner().formula()
        }
    };
}

impl Candidate for PerEvent {
    says_as!(one);
}

impl<K: ChangeKind> ChangeOf<K> for PerEvent {
    fn change_of(&self, values: &[Real<K>]) -> Change<K> {
        let mut own = vec![Change::default(); self.events];
        let mut rest = values;
        for Own { event, mechanism, count } in &self.each {
            let (values, others) = rest.split_at(*count);
            own[*event] = K::change(mechanism.as_ref(), values);
            rest = others;
        }
        Change { own, ..Change::default() }
    }
}

impl Mechanism for PerEvent {
    fn of_event(&self, event: usize) -> Concern {
        let mut begin = 0;
        let mut mechanism: Option<Box<dyn Mechanism>> = None;
        for own in &self.each {
            let unknowns = &self.unknowns[begin..begin + own.count];
            begin += own.count;
            if own.event == event {
                mechanism = Some(Box::new(Self {
                    each: vec![own.clone()],
                    events: self.events,
                    unknowns: unknowns.to_vec(),
                }));
            }
        }
        Concern::Own { common: 0, mechanism }
    }
}

/// A mechanism at the same places in all events, with amplitudes that differ
/// about a common one.
///
/// An amplitude that may have either sign is the common one plus spread times
/// a standard normal deviate; one of a single sign is the common one times
/// exp(spread times deviate), which keeps its sign.
#[derive(Debug)]
pub struct Pooled {
    inner: Arc<dyn Mechanism>,
    unknowns: Vec<Unknown>,
    /// How many of these all events have in common.
    common: usize,
    /// Which event the first deviate is of; the others follow.
    first: usize,
    signed: bool,
}

impl Pooled {
    /// Pools a mechanism over events with these labels. After its own
    /// unknowns come the spread and each event's deviate.
    pub fn new(inner: Box<dyn Mechanism>, labels: &[String]) -> Self {
        let mut unknowns = inner.unknowns();
        let (signed, scale, unit) = match unknowns.first() {
            Some(Unknown { prior: AnyPrior::Normal(_, sd), unit, .. }) => {
                (true, 0.5 * sd, *unit)
            }
            _ => (false, RATIO, "1"),
        };
        let spread = AnyPrior::HalfNormal(scale);
        unknowns.push(Unknown { name: "spread".into(), unit, prior: spread });
        let common = unknowns.len();
        unknowns.extend(labels.iter().map(|label| {
            let prior = AnyPrior::Normal(0.0, 1.0);
            let name = "deviation".into();
            of_event(&Unknown { name, unit: "1", prior }, label)
        }));
        let inner = Arc::from(inner);
        Self { inner, unknowns, common, first: 0, signed }
    }

    fn inner(&self) -> &dyn Mechanism {
        self.inner.as_ref()
    }

    /// The amplitude of an event whose deviation is `deviate`.
    fn amplitude<K: ChangeKind>(
        &self,
        common: Real<K>,
        spread: Real<K>,
        deviate: Real<K>,
    ) -> Real<K> {
        match self.signed {
            true => common + spread * deviate,
            false => common * (spread * deviate).exp(),
        }
    }
}

impl Candidate for Pooled {
    says_as!(inner);
}

impl<K: ChangeKind> ChangeOf<K> for Pooled {
    fn change_of(&self, values: &[Real<K>]) -> Change<K> {
        let (common, deviates) = values.split_at(self.common);
        let (mut amounts, spread): (List<Real<K>>, _) = match common {
            [amounts @ .., spread] => {
                (amounts.iter().copied().collect(), *spread)
            }
            [] => return Change::default(),
        };
        let mut own = vec![Change::default(); self.first];
        own.extend(deviates.iter().map(|&deviate| {
            amounts[0] = self.amplitude(common[0], spread, deviate);
            K::change(self.inner.as_ref(), &amounts)
        }));
        Change { own, ..Change::default() }
    }
}

impl Mechanism for Pooled {
    fn of_event(&self, event: usize) -> Concern {
        let of_common = self.unknowns[..self.common].iter();
        let own = &self.unknowns[self.common + event];
        let mechanism = Self {
            inner: Arc::clone(&self.inner),
            unknowns: of_common.chain([own]).cloned().collect(),
            common: self.common,
            first: event,
            signed: self.signed,
        };
        let mechanism = Some(Box::new(mechanism) as Box<dyn Mechanism>);
        Concern::Own { common: self.common, mechanism }
    }
}
