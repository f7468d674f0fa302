//! A model with mechanisms, its derivatives taken event by event.
//!
//! Given what several events have in common each has its own data and its own
//! parameters, so that a run for the derivatives along one event's parameters
//! tells nothing of the others. The information of the whole is the sum of that
//! of each event along those directions alone that it knows.

use std::ops::Deref;

use nalgebra::DMatrix;

use super::added::Added;
use super::alone::{Alone, Common};
use super::along::check_width;
use super::any_program::AnyProgram;
use super::density::{Density, Weights};
use super::face::{Model, Point};
use super::information::Information;
use super::listener::{Collector, Listener};
use super::number::Number;
use super::program::Program;
use super::run::Run;
use super::with::With;
use crate::error::{Outcome, Result};
use crate::mechanism::{Concern, Mechanism, Unknown};
use crate::scalar::Plain;

/// A program with mechanisms as [`With`] has it; of several events, event by
/// event.
#[derive(Debug)]
pub(crate) struct ByEvent<'a> {
    whole: With<'a>,
    /// What all events have in common, under its prior alone; `None` of one
    /// event, and where there is nothing.
    common: Option<Part<Common<'a>>>,
    /// Each of several events.
    events: Vec<Part<Own<'a>>>,
}

/// Some coordinates of a model, as a model of their own.
#[derive(Debug)]
pub(crate) struct Part<M> {
    pub(crate) model: M,
    /// Which coordinate of the whole each of them is.
    pub(crate) places: Vec<usize>,
}

impl<'a> ByEvent<'a> {
    /// Adds mechanisms to a program.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn new(
        program: &'a dyn AnyProgram,
        mechanisms: &[&'a dyn Mechanism],
    ) -> Result<Self> {
        let whole = With::new(program, mechanisms);
        let count = program.count_of_events();
        if count < 2 {
            return Ok(Self { whole, common: None, events: Vec::new() });
        }
        let shares: Vec<Shares<'_>> =
            mechanisms.iter().map(|m| Shares::of(*m, count)).collect();
        let shared = declared(&Common::new(program, Vec::new()))?;
        let own = (0..count).map(|event| {
            let alone = Alone::new(program, event);
            Ok(declared(&alone)? - shared)
        });
        let own = own.collect::<Result<Vec<_>>>()?;
        let Layout { common, events, .. } = Layout::of(&shares, shared, &own);
        let added = shares.iter().flat_map(Shares::added).collect();
        let model = Common::new(program, added);
        let common =
            (!common.is_empty()).then_some(Part { model, places: common });
        let mut added: Vec<_> = (0..count).map(|_| Added::default()).collect();
        for share in shares {
            share.push_to(&mut added);
        }
        let events = events.into_iter().zip(added).enumerate();
        let events = events.map(|(event, (places, added))| {
            let alone = Alone::new(program, event);
            Part { model: Own { alone, added }, places }
        });
        Ok(Self { whole, common, events: events.collect() })
    }

    /// How many parameters the mechanisms add; they come first.
    pub(crate) fn added(&self) -> usize {
        self.whole.added()
    }

    /// What several events have in common.
    pub(crate) fn common(&self) -> Option<&Part<Common<'a>>> {
        self.common.as_ref()
    }

    /// Each of several events; none of one.
    pub(crate) fn events(&self) -> &[Part<Own<'a>>] {
        &self.events
    }

    /// The sum along so many directions of what all events say, each along some
    /// of them.
    fn summed(
        &self,
        directions: usize,
        said: impl Fn(&[usize], &dyn Model) -> Result<(Information, Vec<usize>)>,
    ) -> Result<Information> {
        let mut sum = Information::zero(directions);
        for Part { model, places } in &self.events {
            let (found, along) = said(places, model)?;
            sum.add(&found, &along, 1.0);
            if sum.density.rejected.is_some() {
                return Ok(sum);
            }
        }
        if let Some(Part { model, places }) = &self.common {
            // Each event counts its prior.
            let again = 1.0 - self.events.len() as f64;
            let (found, along) = said(places, model)?;
            sum.add(&found, &along, again);
        }
        Ok(sum)
    }
}

impl Model for ByEvent<'_> {
    fn evaluate(
        &self,
        point: Point<'_>,
        listener: Option<&mut dyn Listener<Plain>>,
    ) -> Result<Density> {
        self.whole.evaluate(point, listener)
    }

    fn gradient(
        &self,
        z: &[f64],
        weights: Weights,
        gradient: &mut [f64],
    ) -> Result<Density> {
        self.whole.gradient(z, weights, gradient)
    }

    fn information(&self, z: &[f64]) -> Result<Information> {
        if self.events.is_empty() {
            return self.whole.information(z);
        }
        let whole = |places: &[usize], model: &dyn Model| {
            Ok((model.information(&at(z, places))?, places.to_vec()))
        };
        self.summed(z.len(), whole)
    }

    fn information_along(
        &self,
        z: &[f64],
        directions: &DMatrix<f64>,
    ) -> Result<Information> {
        check_width(directions, z.len())?;
        if self.events.is_empty() {
            return self.whole.information_along(z, directions);
        }
        let along = |places: &[usize], model: &dyn Model| {
            known_along(model, &at(z, places), directions, places)
        };
        self.summed(directions.nrows(), along)
    }
}

/// Some coordinates of a place.
fn at(place: &[f64], some: &[usize]) -> Vec<f64> {
    some.iter().map(|&i| place[i]).collect()
}

/// What a model of some coordinates says along those directions of all that it
/// knows, and which these are.
fn known_along(
    model: &dyn Model,
    z: &[f64],
    directions: &DMatrix<f64>,
    places: &[usize],
) -> Result<(Information, Vec<usize>)> {
    let own = directions.select_columns(places);
    let is_known = |row: &usize| own.row(*row).iter().any(|x| *x != 0.0);
    let known: Vec<usize> = (0..own.nrows()).filter(is_known).collect();
    let found = match known.is_empty() {
        true => Information {
            density: model.evaluate(Point::Line(z), None)?,
            ..Information::zero(0)
        },
        false => model.information_along(z, &own.select_rows(&known))?,
    };
    Ok((found, known))
}

/// One of several events with what it has of the mechanisms.
#[derive(Debug)]
pub(crate) struct Own<'a> {
    alone: Alone<'a>,
    added: Added<Share<'a>>,
}

impl Program for Own<'_> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let change = self.added.ask(run)?;
        run.under(&change, |run| self.alone.run(run))
    }
}

/// A mechanism as one event has it.
#[derive(Debug)]
enum Share<'a> {
    /// The same as every event.
    All(&'a dyn Mechanism),
    Own(Box<dyn Mechanism>),
}

impl<'a> Deref for Share<'a> {
    type Target = dyn Mechanism + 'a;

    fn deref(&self) -> &(dyn Mechanism + 'a) {
        match self {
            Self::All(mechanism) => *mechanism,
            Self::Own(mechanism) => mechanism.as_ref(),
        }
    }
}

/// What one mechanism is to each of the events.
struct Shares<'a> {
    all: &'a dyn Mechanism,
    /// How many of its unknowns are in common.
    common: usize,
    /// The mechanism of each event; `None` of all where it is the same.
    own: Option<Vec<Option<Box<dyn Mechanism>>>>,
}

impl<'a> Shares<'a> {
    fn of(mechanism: &'a dyn Mechanism, events: usize) -> Self {
        let mut common = mechanism.unknowns().len();
        let mut own = Vec::new();
        for event in 0..events {
            match mechanism.of_event(event) {
                Concern::All => {
                    return Self { all: mechanism, common, own: None };
                }
                Concern::Own { common: first, mechanism } => {
                    common = first;
                    own.push(mechanism);
                }
            }
        }
        Self { all: mechanism, common, own: Some(own) }
    }

    /// How much of it an event has to itself.
    fn count(&self, event: usize) -> usize {
        let unknowns = match &self.own {
            None => self.all.unknowns().len(),
            Some(own) => own[event].as_ref().map_or(0, |m| m.unknowns().len()),
        };
        unknowns.saturating_sub(self.common)
    }

    /// What is in common, by name.
    fn added(&self) -> impl Iterator<Item = Unknown> {
        let unknowns = self.all.unknowns().into_iter().take(self.common);
        unknowns.map(|u| {
            let name = format!("{}.{}", self.all.name(), u.name);
            Unknown { name, ..u }
        })
    }

    /// Puts it after the other mechanisms of each event.
    fn push_to(self, events: &mut [Added<Share<'a>>]) {
        let Some(own) = self.own else {
            events.iter_mut().for_each(|e| e.push(Share::All(self.all)));
            return;
        };
        for (event, own) in events.iter_mut().zip(own) {
            if let Some(own) = own {
                event.push(Share::Own(own));
            }
        }
    }
}

/// Where the coordinates of a program of several events with mechanisms are:
/// those of each mechanism first, of the program last; within each of these
/// what all events have in common, then what each has to itself.
#[derive(Debug, Default)]
struct Layout {
    common: Vec<usize>,
    events: Vec<Vec<usize>>,
    next: usize,
}

impl Layout {
    /// That of mechanisms with a program which has so many in common, and so
    /// many of each event.
    fn of(shares: &[Shares<'_>], common: usize, own: &[usize]) -> Self {
        let events = vec![Vec::new(); own.len()];
        let mut layout = Self { events, ..Self::default() };
        for share in shares {
            let own = (0..own.len()).map(|event| share.count(event));
            layout.push(share.common, own);
        }
        layout.push(common, own.iter().copied());
        layout
    }

    /// The next coordinates: so many in common, and so many of each event.
    fn push(&mut self, common: usize, own: impl Iterator<Item = usize>) {
        let first = self.next..self.next + common;
        self.next += common;
        self.common.extend(first.clone());
        for (event, count) in self.events.iter_mut().zip(own) {
            event.extend(first.clone());
            event.extend(self.next..self.next + count);
            self.next += count;
        }
    }
}

/// How many parameters a model declares.
fn declared(model: &dyn Model) -> Result<usize> {
    let mut collector = Collector::default();
    model.evaluate(Point::Middle, Some(&mut collector))?;
    Ok(collector.collected.names.len())
}
