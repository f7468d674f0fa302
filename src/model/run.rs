//! One run of a model's body.
//!
//! The body asks for its parameters and offers its data; the run decides
//! where values come from (a point on the real line, a point as named, draws
//! from the prior) and who listens.

use super::along::Along;
use super::data::Data;
use super::label::Label;
use super::listener::{Declaration, Listener};
use crate::block::{List, Named};
use crate::context::Context;
use crate::declared::Declared;
use crate::error::{Error, Outcome, Stop};
use crate::mechanism::Change;
use crate::noise::{Noise, Wide};
use crate::observe::{Prediction, Series};
use crate::prior::{Distribution, Prior};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Where a run takes its parameters' values from.
#[derive(Debug)]
pub(super) enum Source<'r> {
    /// Places on the real line, and the directions of derivatives.
    Line { z: &'r [f64], along: Along<'r> },
    /// Values as named; outside a support the run is rejected.
    Natural { x: &'r [f64] },
    /// Draws from the prior, given the values that are known and not NaN.
    Prior { rng: &'r mut Rng, known: &'r [f64] },
    /// The middle of the line for every parameter, however many there are.
    Middle,
}

impl Source<'_> {
    fn reborrow(&mut self) -> Source<'_> {
        match self {
            Self::Line { z, along } => Source::Line { z, along: *along },
            Self::Natural { x } => Source::Natural { x },
            Self::Prior { rng, known } => Source::Prior { rng, known },
            Self::Middle => Source::Middle,
        }
    }
}

/// Which of several events a run enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Entered {
    /// All of them.
    All,
    /// One of them.
    Only(usize),
    /// None: what all have in common is declared, nothing is scored.
    Nothing,
}

/// Under what a run's body runs.
#[derive(Debug, Clone, Copy)]
struct Setting<'r, K: Kind> {
    change: Option<&'r Change<K>>,
    /// The label of the event; empty for none.
    event: &'r str,
    entered: Entered,
}

/// One run of a model's body over numbers of kind `K`.
#[derive(Debug)]
pub struct Run<'r, K: Kind> {
    context: &'r Context<K>,
    source: Source<'r>,
    position: usize,
    pub(super) log_prior: Real<K>,
    pub(super) log_jacobian: Real<K>,
    pub(super) log_likelihood: Real<K>,
    listener: Option<&'r mut dyn Listener<K>>,
    setting: Setting<'r, K>,
    /// Whether an event was come to in a run that does not enter all of them.
    is_past_common: bool,
}

impl<'r, K: Kind> Run<'r, K> {
    pub(super) fn new(
        context: &'r Context<K>,
        source: Source<'r>,
        listener: Option<&'r mut dyn Listener<K>>,
    ) -> Self {
        let zero = Real::new(0.0);
        Self {
            context,
            source,
            position: 0,
            log_prior: zero,
            log_jacobian: zero,
            log_likelihood: zero,
            listener,
            setting: Setting {
                change: None,
                event: "",
                entered: Entered::All,
            },
            is_past_common: false,
        }
    }

    /// Runs a body under a change; within a change, under both.
    ///
    /// # Errors
    /// Those of the body.
    pub fn under(
        &mut self,
        change: &Change<K>,
        body: impl FnOnce(&mut Run<'_, K>) -> Outcome,
    ) -> Outcome {
        let both = self.setting.change.map(|outer| outer.and(change));
        let change = Some(both.as_ref().unwrap_or(change));
        self.nested(Setting { change, ..self.setting }, body)
    }

    /// Runs the body of one of several events: of the change that this run
    /// is under, it sees what is of all events and what is its own. The names
    /// of its parameters have the label before them, where it is not empty.
    ///
    /// # Errors
    /// Those of the body.
    pub fn of_event(
        &mut self,
        index: usize,
        label: &str,
        body: impl FnOnce(&mut Run<'_, K>) -> Outcome,
    ) -> Outcome {
        self.is_past_common = self.setting.entered != Entered::All;
        match self.setting.entered {
            Entered::Only(one) if one != index => return Ok(()),
            Entered::Nothing => return Ok(()),
            _ => {}
        }
        let own = self.setting.change.map(|change| change.of_event(index));
        let change = own.as_ref();
        let entered = Entered::All;
        self.nested(Setting { change, event: label, entered }, body)
    }

    /// Runs a body that enters of several events only this one, or none.
    pub(super) fn entering(
        &mut self,
        entered: Entered,
        body: impl FnOnce(&mut Run<'_, K>) -> Outcome,
    ) -> Outcome {
        self.nested(Setting { entered, ..self.setting }, body)
    }

    fn nested(
        &mut self,
        setting: Setting<'_, K>,
        body: impl FnOnce(&mut Run<'_, K>) -> Outcome,
    ) -> Outcome {
        let mut inner = Run {
            context: self.context,
            source: self.source.reborrow(),
            position: self.position,
            log_prior: self.log_prior,
            log_jacobian: self.log_jacobian,
            log_likelihood: self.log_likelihood,
            listener: self.listener.as_mut().map(|l| &mut **l as _),
            setting,
            is_past_common: false,
        };
        let outcome = body(&mut inner);
        self.position = inner.position;
        self.log_prior = inner.log_prior;
        self.log_jacobian = inner.log_jacobian;
        self.log_likelihood = inner.log_likelihood;
        outcome
    }

    /// The label of the event that the run is in; empty for none.
    pub(super) fn event(&self) -> &'r str {
        self.setting.event
    }

    /// Who listens.
    pub(super) fn listener(&mut self) -> Option<&mut (dyn Listener<K> + 'r)> {
        self.listener.as_deref_mut()
    }

    /// Where draws from the prior come from, if the run makes such.
    pub(super) fn draws_prior(&mut self) -> Option<&mut Rng> {
        match &mut self.source {
            Source::Prior { rng, .. } => Some(rng),
            _ => None,
        }
    }

    /// Scores a datum of which only the log density is known.
    pub(super) fn score_one(&mut self, log_density: Real<K>) -> Outcome {
        self.admit_data()?;
        if let Some(listener) = &mut self.listener {
            listener.increment(log_density);
            if !listener.scores() {
                return Ok(());
            }
        }
        self.log_likelihood += log_density;
        match self.log_likelihood.value() == f64::NEG_INFINITY {
            true => {
                Err(Stop::Reject("the log density added is minus infinity"))
            }
            false => Ok(()),
        }
    }

    /// How many parameters were asked for so far.
    pub(super) fn position(&self) -> usize {
        self.position
    }

    /// Declares a scalar parameter and takes its value.
    ///
    /// # Errors
    /// [`Stop::Reject`] where the value lies outside the prior's support.
    #[inline]
    pub fn scalar<P: Prior<K>>(
        &mut self,
        label: Label<'_>,
        prior: P,
    ) -> Result<Real<K>, Stop> {
        if self.is_past_common {
            return Err(misplaced(&label));
        }
        let x = self.value(&prior, &label)?;
        self.position += 1;
        let log_density = prior.log_density(x);
        self.log_prior += log_density;
        if let Some(listener) = &mut self.listener {
            listener.parameter(&Declaration {
                label: &label.of_event(self.setting.event),
                value: x.value(),
                prior: &prior,
            });
            if listener.has_heard_enough() {
                return Err(Stop::Reject("nothing more is asked of the run"));
            }
        }
        if log_density.value() == f64::NEG_INFINITY && !self.looks_around() {
            return Err(Stop::Reject("a parameter lies outside its prior"));
        }
        Ok(x)
    }

    /// Whether the run only tells what there is: a middle may lie in a gap of
    /// its prior, and what comes after it is asked for all the same.
    fn looks_around(&self) -> bool {
        matches!(self.source, Source::Middle)
    }

    #[inline]
    fn value<P: Prior<K>>(
        &mut self,
        prior: &P,
        label: &Label<'_>,
    ) -> Result<Real<K>, Stop> {
        let i = self.position;
        let beyond = || one_too_many(label, i);
        match &mut self.source {
            Source::Line { z, along } => {
                let z = along.number(*z.get(i).ok_or_else(beyond)?, i);
                let (x, log_jacobian) = prior.support().from_line(z);
                self.log_jacobian += log_jacobian;
                Ok(x)
            }
            Source::Natural { x } => {
                Ok(Real::variable(*x.get(i).ok_or_else(beyond)?, i))
            }
            Source::Prior { rng, known } => {
                if let Some(x) = known.get(i).filter(|x| !x.is_nan()) {
                    return Ok(Real::new(*x));
                }
                let draw = prior.draw(rng).ok_or(Stop::Reject(
                    "a prior has no draws: it is improper, or its arguments \
                     are impossible",
                ))?;
                Ok(Real::new(draw))
            }
            Source::Middle => Ok(prior.support().from_line(Real::new(0.0)).0),
        }
    }

    /// Declares a vector of `n` parameters with the same prior.
    ///
    /// # Errors
    /// As [`Run::scalar`].
    pub fn vector<P: Prior<K>>(
        &mut self,
        label: Label<'_>,
        n: usize,
        prior: P,
    ) -> Result<List<Real<K>>, Stop> {
        (0..n).map(|i| self.scalar(label.at(i), &prior)).collect()
    }

    /// Declares a block, or a sum of blocks.
    #[inline]
    pub fn declare<B: Named<Real<K>>>(
        &mut self,
        block: B,
    ) -> Declared<'r, K, B> {
        self.has(|say| block.names(say));
        Declared::new(block, self.context).under(self.setting.change)
    }

    /// Declares what is no block, under a name of its own.
    pub fn declare_as<B>(
        &mut self,
        name: &str,
        part: B,
    ) -> Declared<'r, K, B> {
        self.has(|say| say(name));
        Declared::new(part, self.context).under(self.setting.change)
    }

    /// Says which other blocks or mechanisms the model has.
    pub(super) fn has(&mut self, names: impl FnOnce(&mut dyn FnMut(&str))) {
        if let Some(listener) = &mut self.listener {
            names(&mut |name| listener.block(name));
        }
    }

    /// Scores a series against what the model predicts, with a noise.
    ///
    /// # Errors
    /// [`Stop::Reject`] where no such noise exists, [`Stop::Fail`] where
    /// series, prediction and noise do not fit together.
    pub fn observe<N: Noise<K>>(
        &mut self,
        series: &impl AsRef<Series>,
        prediction: impl Prediction<K>,
        noise: &N,
    ) -> Outcome {
        let series = series.as_ref();
        if series.is_empty() {
            return Err(Stop::Fail(Error::input(format!(
                "the event has no {} recording to compare with",
                series.quantity()
            ))));
        }
        noise.check(series.grid())?;
        if let Some(change) = self.setting.change {
            return self.observe_under(change, series, prediction, noise);
        }
        let mut residuals = self.context.buffer();
        let mut values = series.values().iter();
        prediction.predict(series, |predicted| {
            let value = values.next().copied().unwrap_or(f64::NAN);
            residuals.push(value - predicted);
        })?;
        self.score_wide(series, &residuals, noise)
    }

    /// The same under a change of what is read off.
    fn observe_under<N: Noise<K>>(
        &mut self,
        change: &Change<K>,
        series: &Series,
        prediction: impl Prediction<K>,
        noise: &N,
    ) -> Outcome {
        let mut residuals = self.context.buffer();
        let mut recorded = series.times().iter().zip(series.values());
        prediction.predict(series, |predicted| {
            let (&time, &value) = recorded.next().unwrap_or((&0.0, &f64::NAN));
            residuals.push(value - change.read(time, predicted));
        })?;
        let known = change.known.map(|share| series.first(series.part(share)));
        let series = match &known {
            Some(Ok(first)) => first,
            Some(Err(error)) => return Err(Stop::Fail(error.clone())),
            None => series,
        };
        self.score_wide(series, &residuals[..series.len()], noise)
    }

    /// Scores residuals with errors as wide as the noise says they are where
    /// so much is predicted.
    #[inline]
    fn score_wide<N: Noise<K>>(
        &mut self,
        series: &Series,
        residuals: &[Real<K>],
        noise: &N,
    ) -> Outcome {
        let mut widths = self.context.buffer();
        for (value, residual) in series.values().iter().zip(residuals) {
            match noise.width(*value - *residual) {
                Some(width) => widths.push(width),
                None => return self.score(series, residuals, noise),
            }
        }
        let wide = Wide::new(noise, &widths, series.grid())?;
        self.score(series, residuals, &wide)
    }

    /// Scores residuals and lets the listener hear them.
    #[inline]
    fn score<N: Noise<K>>(
        &mut self,
        series: &Series,
        residuals: &[Real<K>],
        noise: &N,
    ) -> Outcome {
        self.admit_data()?;
        if let Some(listener) = &mut self.listener {
            listener.series(series, residuals, noise)?;
            if !listener.scores() {
                return Ok(());
            }
            if let Some(heard) = listener.log_likelihood() {
                self.log_likelihood += heard;
                return Ok(());
            }
        }
        self.log_likelihood +=
            noise.log_likelihood(series.grid(), residuals)?;
        Ok(())
    }

    /// Fails where events are taken apart and these data are of none.
    fn admit_data(&self) -> Outcome {
        match self.setting.entered {
            Entered::All => Ok(()),
            _ => Err(Stop::Fail(Error::input(
                "the model has several events and scores data outside of \
                 them; expected all data within `Run::of_event`: score these \
                 in one of the events, or let `Program::events` be 1",
            ))),
        }
    }

    /// What was made in the place of the datum just met, where data are made
    /// and not scored: what depends on it depends on that.
    pub(super) fn made(&self) -> Option<f64> {
        self.listener.as_ref().and_then(|listener| listener.made())
    }

    /// Scores each of the data against one distribution.
    ///
    /// # Errors
    /// [`Stop::Reject`] where a value lies outside the distribution.
    pub fn observe_each<P: Distribution<K>>(
        &mut self,
        data: &(impl Data + ?Sized),
        distribution: P,
    ) -> Outcome {
        self.admit_data()?;
        let scores = self.listener.as_ref().is_none_or(|l| l.scores());
        for i in 0..data.count() {
            let value = data.value(i);
            if scores && !value.is_finite() {
                return Err(not_finite(i, data.count(), value));
            }
            let log_density = distribution.log_density(Real::new(value));
            if let Some(listener) = &mut self.listener {
                listener.element(value, log_density, &distribution);
            }
            if scores {
                self.log_likelihood += log_density;
            }
        }
        let is_impossible = self.log_likelihood.value() == f64::NEG_INFINITY;
        if is_impossible && !self.looks_around() {
            return Err(Stop::Reject("a value lies outside its distribution"));
        }
        Ok(())
    }
}

/// A datum that is no number: no parameter's value would mend it.
#[cold]
fn not_finite(index: usize, count: usize, value: f64) -> Stop {
    Stop::Fail(Error::input(format!(
        "value {} of {count} is {value}; expected a finite number: mend it, \
         leave out what was not measured, or declare it with `given`",
        index + 1,
    )))
}

#[cold]
fn misplaced(label: &Label<'_>) -> Stop {
    Stop::Fail(Error::input(format!(
        "{} is declared after an event and outside of all; expected what \
         events have in common before the first of them: declare it there, \
         or within an event",
        label.name()
    )))
}

/// A parameter asked for beyond those that a point has a value for.
#[cold]
fn one_too_many(label: &Label<'_>, known: usize) -> Stop {
    Stop::Fail(Error::input(format!(
        "{} is one parameter more than the {known} that there are values \
         for; {SAME_PARAMETERS}",
        label.name()
    )))
}

/// What a model has to keep to, and how.
pub(super) const SAME_PARAMETERS: &str = "the number, names and order of a model's parameters must not depend on \
     their values: declare the same ones always, as many as there can be, \
     and use those that apply";
