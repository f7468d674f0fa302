//! Blocks that add up to a noise: what each says of memory, tails and size.

use smallvec::SmallVec;

use super::{Grid, Spacing};
use crate::block::Sum;
use crate::error::{Error, Stop};
use crate::scalar::{Kind, Real};

/// A block of which noises are put together with `+`.
///
/// A noise answers three questions: what an error remembers of those before
/// it, how heavy the tails are of what it does not remember, and how large
/// errors are along the recording. Memories and white errors add up; tails and
/// size are those of the whole.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no summand of a noise",
    label = "noises are sums of `White`, `Ou`, `Matern32`, `Ar`, `Tails` and \
             `Growth`; `Iid` in a sum is `White`"
)]
pub trait Part<K: Kind> {
    /// Says what it is of the whole.
    fn join<'a>(&'a self, whole: &mut Whole<'a, K>);
}

impl<K: Kind, A: Part<K>, B: Part<K>> Part<K> for Sum<A, B> {
    fn join<'a>(&'a self, whole: &mut Whole<'a, K>) {
        self.first.join(whole);
        self.second.join(whole);
    }
}

/// A stationary Gaussian process of errors in state space: its value is the
/// first number of a state x, which moves over a lapse to F x + N(0, Q).
pub trait Memory<K: Kind>: std::fmt::Debug {
    /// How many numbers its state has.
    fn states(&self) -> usize;

    /// Whether it is defined at those times; an input error that names the
    /// mend where it is not.
    ///
    /// # Errors
    /// Times at which there is no such process.
    fn exists(&self, at: &Grid) -> crate::Result<()>;

    /// Rejects parameters of which there is no process at those times.
    ///
    /// # Errors
    /// [`Stop::Reject`] for such parameters.
    fn allows(&self, at: &Grid) -> Result<(), Stop>;

    /// The covariance of its state at any time, row after row.
    fn covariance(&self) -> Square<K>;

    /// How its state moves.
    fn over(&self, lapse: Lapse) -> Transition<K>;
}

/// A square matrix, row after row.
pub type Square<K> = SmallVec<[Real<K>; 4]>;

/// How far a value lies behind the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Lapse {
    /// In seconds.
    pub seconds: f64,
    /// In steps of the recording, a whole number where its times are regular.
    pub steps: f64,
}

impl Lapse {
    /// That before the value `i`; none before the first.
    pub(super) fn before(at: &Grid, i: usize) -> Self {
        let steps = at.distance(i);
        Self { seconds: steps * at.step(), steps }
    }
}

/// How a state x moves over a lapse: to F x + N(0, Q).
#[derive(Debug, Clone)]
pub struct Transition<K: Kind> {
    /// F, row after row.
    pub matrix: Square<K>,
    /// Q, row after row.
    pub noise: Square<K>,
}

/// What the parts of a noise say together.
#[derive(Debug, Clone)]
pub struct Whole<'a, K: Kind> {
    memories: [Option<&'a dyn Memory<K>>; MOST_MEMORIES],
    white: Option<Real<K>>,
    tails: Option<Real<K>>,
    growth: Option<Real<K>>,
    /// Of what two parts speak.
    twice: Option<&'static str>,
    /// Whether there are more processes than places for them.
    is_full: bool,
}

impl<'a, K: Kind> Whole<'a, K> {
    /// Of no part yet.
    pub(super) fn new() -> Self {
        Self {
            memories: [None; MOST_MEMORIES],
            white: None,
            tails: None,
            growth: None,
            twice: None,
            is_full: false,
        }
    }

    /// Of a part, or a sum of them.
    pub fn of(part: &'a (impl Part<K> + ?Sized)) -> Self {
        let mut whole = Self::new();
        part.join(&mut whole);
        whole
    }

    /// Adds a process.
    pub fn remember(&mut self, memory: &'a dyn Memory<K>) {
        match self.memories.iter_mut().find(|place| place.is_none()) {
            Some(place) => *place = Some(memory),
            None => self.is_full = true,
        }
    }

    /// Adds independent errors of a variance, in the squared unit of the
    /// recording.
    pub fn scatter(&mut self, variance: Real<K>) {
        self.white =
            Some(self.white.map_or(variance, |white| white + variance));
    }

    /// Gives what is not remembered the tails of a Student distribution with
    /// so many degrees of freedom.
    pub fn tail(&mut self, nu: Real<K>) {
        if self.tails.replace(nu).is_some() {
            self.twice = Some("tails");
        }
    }

    /// Lets errors grow along the recording: the logarithm of the last size
    /// over the first.
    pub fn grow(&mut self, growth: Real<K>) {
        if self.growth.replace(growth).is_some() {
            self.twice = Some("growth");
        }
    }

    pub(super) fn memories(&self) -> impl Iterator<Item = &'a dyn Memory<K>> {
        self.memories.iter().flatten().copied()
    }

    /// The variance of its white errors.
    pub(super) fn white(&self) -> Real<K> {
        self.white.unwrap_or(Real::new(0.0))
    }

    pub(super) fn tails(&self) -> Option<Real<K>> {
        self.tails
    }

    /// How large errors are at the value `i`, in ln; 0 in the middle of the
    /// recording.
    pub(super) fn log_size(&self, at: &Grid, i: usize) -> Option<Real<K>> {
        self.growth.map(|growth| growth * (at.share(i) - 0.5))
    }

    /// How many numbers its state has.
    pub(super) fn states(&self) -> usize {
        self.memories().map(|memory| memory.states()).sum()
    }

    /// Whether it is a noise, and defined at those times.
    pub(super) fn check(&self, at: &Grid) -> crate::Result<()> {
        if let Some(what) = self.twice {
            return Err(Error::input(format!(
                "the noise has {what} twice; expected once: drop one of them"
            )));
        }
        if self.memories().next().is_none() && self.white.is_none() {
            return Err(Error::input(
                "tails and growth shape errors that another block makes, and \
                 there is none; add one, as in \"white + tails\"",
            ));
        }
        if self.is_full {
            return Err(Error::input(format!(
                "the noise is a sum of more than {MOST_MEMORIES} processes; \
                 take fewer"
            )));
        }
        if self.states() > MOST_STATES {
            return Err(Error::input(format!(
                "the noise has {} states, expected {MOST_STATES} at the \
                 most: take a lower order",
                self.states()
            )));
        }
        self.memories().try_for_each(|memory| memory.exists(at))
    }

    /// Rejects parameters of which there is no such noise.
    pub(super) fn admit(&self, at: &Grid) -> Result<(), Stop> {
        let positive = |x: Real<K>| x > 0.0 && x.value().is_finite();
        if !self.white.is_none_or(positive) {
            return Err(Stop::Reject("the variance sigma2 is not positive"));
        }
        if !self.tails.is_none_or(positive) {
            return Err(Stop::Reject("nu is not positive"));
        }
        if !self.growth.is_none_or(|growth| growth.value().is_finite()) {
            return Err(Stop::Reject("growth is not a finite number"));
        }
        self.memories().try_for_each(|memory| memory.allows(at))
    }
}

/// The most processes of a noise.
const MOST_MEMORIES: usize = 6;

/// The most states of a noise.
pub(super) const MOST_STATES: usize = 24;

/// Fails where a process would have to be known twice at one time.
pub(super) fn check_increasing(name: &str, at: &Grid) -> crate::Result<()> {
    if *at.spacing() != Spacing::Uneven {
        return Ok(());
    }
    let late = |w: &&[f64]| w[1] <= w[0];
    match at.times().windows(2).find(late) {
        None => Ok(()),
        Some(w) => Err(Error::input(format!(
            "{name} needs increasing times, and {} s follows {} s; merge the \
             two values, or use iid",
            w[1], w[0]
        ))),
    }
}
