//! Several events taken apart: what each has to itself is fitted by itself.

use crate::error::Result;
use crate::infer::{
    Group, Grouped, Inference, LaplaceMixture, Precision, Quiet,
};
use crate::mechanism::{Concern, Mechanism, Unknown};
use crate::model::{Alone, AnyProgram, Common, Posterior, Program, With};
use crate::seed::Seed;

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

    /// The mechanism as an event has it.
    fn of_event(&self, event: usize) -> Option<&dyn Mechanism> {
        match &self.own {
            None => Some(self.all),
            Some(own) => own[event].as_deref(),
        }
    }

    /// How much of it an event has to itself.
    fn count(&self, event: usize) -> usize {
        let own = self.of_event(event);
        own.map_or(0, |m| m.unknowns().len().saturating_sub(self.common))
    }

    /// What is in common, by name.
    fn added(&self) -> impl Iterator<Item = Unknown> {
        let unknowns = self.all.unknowns().into_iter().take(self.common);
        unknowns.map(|u| {
            let name = format!("{}.{}", self.all.name(), u.name);
            Unknown { name, ..u }
        })
    }
}

/// Evidence and draws of a program of several events with mechanisms, event by
/// event.
///
/// # Errors
/// As [`LaplaceMixture::explore_groups`].
pub(crate) fn estimate(
    program: &dyn AnyProgram,
    mechanisms: &[&dyn Mechanism],
    whole: &Posterior<'_>,
    backend: &LaplaceMixture,
    precision: Precision,
    seed: Seed,
) -> Result<Inference> {
    let events = program.events();
    let shares: Vec<Shares<'_>> =
        mechanisms.iter().map(|m| Shares::of(*m, events)).collect();
    let alone: Vec<Alone<'_>> =
        (0..events).map(|i| Alone::new(program, i)).collect();
    let with: Vec<With<'_>> = alone
        .iter()
        .enumerate()
        .map(|(i, one)| {
            let own = shares.iter().filter_map(|share| share.of_event(i));
            With::new(one, &own.collect::<Vec<_>>())
        })
        .collect();
    let posteriors: Vec<Posterior<'_>> =
        with.iter().map(|one| Posterior::new(one)).collect::<Result<_>>()?;
    let shared = Common::new(program, Vec::new()).dimension()?;
    let own = |(one, with): (&Posterior<'_>, &With<'_>)| {
        one.dimension() - with.added() - shared
    };
    let own: Vec<usize> = posteriors.iter().zip(&with).map(own).collect();
    let layout = Layout::of(&shares, shared, &own);
    let added = shares.iter().flat_map(Shares::added).collect();
    let of_common = Common::new(program, added);
    let common = match layout.common.is_empty() {
        true => None,
        false => Some(Posterior::new(&of_common)?),
    };
    let group = |(posterior, places)| Group { posterior, places };
    let common = common.as_ref().map(|one| group((one, layout.common)));
    let groups = posteriors.iter().zip(layout.events).map(group).collect();
    let grouped = Grouped { whole, common, groups };
    backend.estimate_groups(&grouped, precision, seed, &Quiet)
}
