//! Several events together: one program of several.
//!
//! Each event keeps its own model; the parameters of each are called by its
//! label. What events may have in common, such as one friction law, is
//! declared first.

use super::assembled::Assembled;
use super::blocks::declared_blocks;
use super::labels::labels;
use super::number::Number;
use super::program::Program;
use super::run::Run;
use crate::block::List;
use crate::error::{Error, Outcome, Result, Stop};
use crate::observe::{Event, Extent};
use crate::prior::AnyPrior;
use crate::scalar::Real;

/// A program of one event that can stand beside others.
///
/// Any program is one together with its event, as a pair of both.
pub trait Member: Program + Sized {
    /// The event.
    fn event(&self) -> &Event;

    /// Declares what all events can have in common, such as the parameters of
    /// a law; by default nothing.
    ///
    /// # Errors
    /// As [`Program::run`].
    fn ask_common<K: Number>(
        &self,
        _run: &mut Run<'_, K>,
    ) -> Result<List<Real<K>>, Stop> {
        Ok(List::new())
    }

    /// Runs the body with given values of what is in common.
    ///
    /// # Errors
    /// As [`Program::run`].
    fn run_with<K: Number>(
        &self,
        _common: &[Real<K>],
        run: &mut Run<'_, K>,
    ) -> Outcome {
        self.run(run)
    }
}

impl<P: Program> Program for (P, Event) {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        self.0.run(run)
    }

    fn with_noise(&self, name: &str) -> Result<Option<Self>> {
        let other = self.0.with_noise(name)?;
        Ok(other.map(|program| (program, self.1.clone())))
    }
}

impl<P: Program> Member for (P, Event) {
    fn event(&self) -> &Event {
        &self.1
    }
}

impl Member for Assembled {
    fn event(&self) -> &Event {
        self.event()
    }

    fn ask_common<K: Number>(
        &self,
        run: &mut Run<'_, K>,
    ) -> Result<List<Real<K>>, Stop> {
        self.ask_laws(run)
    }

    fn run_with<K: Number>(
        &self,
        common: &[Real<K>],
        run: &mut Run<'_, K>,
    ) -> Outcome {
        self.score(run, common)
    }
}

/// Several events, each under a model of its own.
///
/// ```
/// use couloir::model::Together;
/// use couloir::prelude::*;
/// model! {
///     struct Dry { event: Event }
///     friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
///     errors ~ Iid { sigma2 = 1.0 };
///     likelihood {
///         let flow = event.slide(&friction)?;
///         event.velocity ~ flow.velocity() + errors;
///     }
/// }
/// let event = |name: &str| {
///     Event::on(Track::incline(35.0, 500.0)?)
///         .named(name)
///         .velocity(Series::velocity(vec![1.0, 2.0], vec![2.9, 5.6])?)
///         .build()
/// };
/// let of = |event: Event| (Dry::new(event.clone()), event);
/// let both = [of(event("north")?), of(event("south")?)];
/// let both = Together::new(both.into())?;
/// let posterior = Posterior::new(&both)?;
/// assert_eq!(posterior.parameters()[1].name, "south.mu");
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug)]
pub struct Together<M = Assembled> {
    members: Vec<M>,
    labels: Vec<String>,
    blocks: Vec<Vec<String>>,
    shares: bool,
}

impl<M: Member> Together<M> {
    /// Puts events together that have nothing in common.
    ///
    /// # Errors
    /// No event, or a model that fails.
    pub fn new(members: Vec<M>) -> Result<Self> {
        if members.is_empty() {
            return Err(Error::input(
                "no event was given; expected one or more",
            ));
        }
        let labels = labels(members.iter().map(|m| m.event().name()));
        let blocks = members.iter().map(|m| declared_blocks(m));
        let blocks = blocks.collect::<Result<_>>()?;
        Ok(Self { members, labels, blocks, shares: false })
    }

    /// Puts events together that have in common what the first one's
    /// [`Member::ask_common`] declares.
    ///
    /// # Errors
    /// As [`Together::new`].
    pub fn sharing(members: Vec<M>) -> Result<Self> {
        Ok(Self { shares: true, ..Self::new(members)? })
    }

    /// The events with their models, in order.
    pub fn members(&self) -> &[M] {
        &self.members
    }

    /// The events, in order.
    pub fn events(&self) -> impl Iterator<Item = &Event> {
        self.members.iter().map(Member::event)
    }

    /// What each event's parameters are called by, in order.
    pub fn labels(&self) -> &[String] {
        &self.labels
    }

    /// The names of the laws, noises and mechanisms of each event's model.
    pub fn blocks(&self) -> &[Vec<String>] {
        &self.blocks
    }

    /// The extent of all events together.
    pub fn extent(&self) -> Extent {
        Extent::of_all(self.events())
    }
}

impl Together<Assembled> {
    /// Puts events together that have the parameters of one law.
    ///
    /// # Errors
    /// As [`Together::new`]; laws that differ, or their priors.
    pub fn with_one_law(members: Vec<Assembled>) -> Result<Self> {
        if let Some((first, others)) = members.split_first() {
            others.iter().try_for_each(|other| check_alike(first, other))?;
        }
        Self::sharing(members)
    }
}

impl<M: Member> Program for Together<M> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let common = match self.members.first() {
            Some(first) if self.shares => Some(first.ask_common(run)?),
            _ => None,
        };
        let all = self.members.iter().zip(&self.labels).enumerate();
        for (i, (member, label)) in all {
            run.of_event(i, label, |run| match &common {
                Some(common) => member.run_with(common, run),
                None => member.run(run),
            })?;
        }
        Ok(())
    }

    fn events(&self) -> usize {
        self.members.len()
    }

    fn with_noise(&self, name: &str) -> Result<Option<Self>> {
        let members = self.members.iter().map(|one| one.with_noise(name));
        let members: Option<Vec<M>> = members.collect::<Result<_>>()?;
        Ok(members.map(|members| Self {
            members,
            labels: self.labels.clone(),
            blocks: self.blocks.clone(),
            shares: self.shares,
        }))
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
