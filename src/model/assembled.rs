//! A model put together at run time, from the names in an event file.
//!
//! The same blocks as in a compiled model, reached through their names: what
//! the command runs.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::added::Added;
use super::default_prior::{default_prior, is_uneven};
use super::number::Number;
use super::program::Program;
use super::run::Run;
use crate::block::{Field, List};
use crate::error::{Error, Outcome, Result, Stop};
use crate::mechanism::{Change, Mechanism, Role, Unknown};
use crate::noise::{self, Form, NoiseEntry};
use crate::observe::{Event, MotionKind, Quantity};
use crate::physics::friction::LawSum;
use crate::physics::{Rest, State};
use crate::prior::AnyPrior;
use crate::scalar::{Plain, Real};
use crate::spelling::{nearest, quoted};

/// One event under a sum of named laws with a named noise, and under the
/// changes of mechanisms where there are some.
///
/// The mechanisms' parameters come first, then the laws', then the noise's.
#[derive(Debug)]
pub struct Assembled {
    event: Event,
    friction: LawSum,
    noise: Box<dyn NoiseEntry>,
    added: Added<Arc<dyn Mechanism>>,
    /// Of the laws, then of the noise.
    own: Vec<Unknown>,
    laws: usize,
}

impl Assembled {
    /// Puts a model together; parameters without a prior among `priors` keep
    /// their block's default. Priors of parameters that this model does not
    /// have are passed over; [`Assembled::check_priors`] refuses them.
    ///
    /// # Errors
    /// A prior that the recording's times do not allow.
    pub fn new(
        event: Event,
        friction: LawSum,
        noise: Box<dyn NoiseEntry>,
        priors: &BTreeMap<String, AnyPrior>,
    ) -> Result<Self> {
        let fields = fields(&friction, noise.as_ref());
        let unit = quantity(&event);
        let mut unknowns = Vec::new();
        for (name, own, field) in &fields {
            let given = [name.as_str(), own.as_str(), field.name]
                .into_iter()
                .find_map(|key| priors.get(key));
            let prior = match given {
                Some(prior) => *prior,
                None => default_prior(field, &event)?,
            };
            let unit = unit_of(field, unit);
            unknowns.push(Unknown::other(name, unit, prior));
        }
        check_uneven(&event, noise.as_ref(), &fields, &unknowns)?;
        let (laws, added) = (friction.dimension(), Added::default());
        Ok(Self { event, friction, noise, added, own: unknowns, laws })
    }

    /// The same model with mechanisms. Their parameters come before its own,
    /// each named `mechanism.parameter`; priors are looked for by that name.
    ///
    /// # Errors
    /// Two mechanisms of one name, whose parameters would have the same.
    pub fn with_mechanisms(
        mut self,
        mechanisms: Vec<Box<dyn Mechanism>>,
        priors: &BTreeMap<String, AnyPrior>,
    ) -> Result<Self> {
        for mechanism in mechanisms {
            let name = mechanism.name();
            if self.mechanisms().any(|m| m.name() == name) {
                return Err(Error::input(format!(
                    "{name:?} is there twice; expected each mechanism once, \
                     in one variant: drop one of them"
                )));
            }
            self.added.push(Arc::from(mechanism));
        }
        for unknown in self.added.unknowns_mut() {
            let Some(given) = priors.get(&unknown.name) else { continue };
            unknown.prior = *given;
            if let Role::Length { .. } = unknown.role {
                unknown.role = Role::Other;
            }
        }
        Ok(self)
    }

    /// All parameters, in order.
    fn unknowns(&self) -> impl Iterator<Item = &Unknown> {
        self.added.unknowns().iter().chain(&self.own)
    }

    /// How many parameters the mechanisms have; they come first.
    fn added(&self) -> usize {
        self.added.unknowns().len()
    }

    /// The priors of parameters that the model does not have.
    pub fn unused<'p>(
        &self,
        priors: &'p BTreeMap<String, AnyPrior>,
    ) -> Vec<&'p str> {
        let fields = fields(&self.friction, self.noise.as_ref());
        let known = |key: &str| {
            self.unknowns().any(|unknown| unknown.name == key)
                || fields
                    .iter()
                    .any(|(_, own, field)| key == own || key == field.name)
        };
        priors.keys().map(String::as_str).filter(|key| !known(key)).collect()
    }

    /// The priors that this model does not go by: of parameters that it does
    /// not have, or has with another prior.
    pub fn without_effect<'p>(
        &self,
        priors: &'p BTreeMap<String, AnyPrior>,
    ) -> Vec<&'p str> {
        let differs = |key: &str, given: &AnyPrior| {
            let mut known = self.priors();
            known.any(|(name, prior)| name == key && prior != given)
        };
        let differing = priors.iter().filter(|(key, p)| differs(key, p));
        let differing = differing.map(|(key, _)| key.as_str());
        self.unused(priors).into_iter().chain(differing).collect()
    }

    /// Refuses priors of parameters that the model does not have.
    ///
    /// # Errors
    /// The first such prior, with the parameters that there are.
    pub fn check_priors(
        &self,
        priors: &BTreeMap<String, AnyPrior>,
    ) -> Result<()> {
        match self.unused(priors).first() {
            None => Ok(()),
            Some(key) => {
                let names: Vec<_> =
                    self.unknowns().map(|u| u.name.as_str()).collect();
                let mend = match nearest(key, &names) {
                    Some(name) => format!("did you mean {name:?}?"),
                    None => "mend or drop the line".to_owned(),
                };
                let key = quoted(key);
                Err(Error::input(format!(
                    "priors.{}: the model has no parameter {key}; expected \
                     one of {}: {mend}",
                    key.trim_matches('"'),
                    names.join(", ")
                ))
                .on_page("formats"))
            }
        }
    }

    /// The same model of the first `count` values of its recording: the same
    /// parameters with the same priors.
    ///
    /// # Errors
    /// As [`Event::first`].
    pub fn first(&self, count: usize) -> Result<Self> {
        Ok(Self {
            event: self.event.first(count)?,
            friction: self.friction.clone(),
            noise: noise::parse(&self.noise.name())?,
            added: self.added.clone(),
            own: self.own.clone(),
            laws: self.laws,
        })
    }

    /// The event.
    pub fn event(&self) -> &Event {
        &self.event
    }

    /// The friction law's name.
    pub fn friction(&self) -> String {
        self.friction.to_string()
    }

    /// The noise's name.
    pub fn noise(&self) -> String {
        self.noise.name()
    }

    /// Its mechanisms.
    pub fn mechanisms(&self) -> impl Iterator<Item = &Arc<dyn Mechanism>> {
        self.added.each()
    }

    /// The labels of its mechanisms.
    pub fn labels(&self) -> Vec<String> {
        self.mechanisms().map(|m| m.label()).collect()
    }

    /// The names of its laws, of its noise and of its mechanisms, without
    /// arguments.
    pub fn blocks(&self) -> Vec<String> {
        let laws = self.friction.terms().iter().map(|law| law.name());
        let added = self.mechanisms().map(|m| m.name());
        let noises = self.noise.terms().into_iter().map(|(name, _)| name);
        let all = laws.chain(noises).chain(added);
        all.map(str::to_owned).collect()
    }

    /// Whether the parameter of this index says how the mass moves, and not
    /// only how it is recorded.
    pub fn is_of_motion(&self, index: usize) -> bool {
        index < self.added() + self.laws
    }

    /// How many of the parameters are the noise's; they come last.
    pub fn noise_dimension(&self) -> usize {
        self.noise.dimension()
    }

    /// The name of each block of the noise, with the field that each of its
    /// parameters is a value of.
    pub(crate) fn noise_terms(&self) -> Vec<(&'static str, Vec<Field>)> {
        self.noise.terms()
    }

    /// How many of the parameters are the friction law's; they come
    /// after those of the mechanisms.
    pub fn friction_dimension(&self) -> usize {
        self.laws
    }

    /// The motion at increasing times of the recording's clock \[s\],
    /// parameters as named.
    ///
    /// # Errors
    /// [`Stop::Reject`] where the law has no flow with these values.
    pub fn motion(
        &self,
        natural: &[f64],
        times: &[f64],
    ) -> Result<Vec<State<Plain>>, Stop> {
        let values = self.law_values(natural);
        let law = self.friction.with(&values);
        let change = self.change_with(natural)?;
        let mut states = Vec::with_capacity(times.len());
        self.event.motion(&law, &change, times, |s| states.push(s))?;
        Ok(states)
    }

    /// Where the mass comes to rest, and when by the recording's clock;
    /// `None` if it never does.
    ///
    /// # Errors
    /// [`Stop::Reject`] where the law has no flow with these values.
    pub fn rest(&self, natural: &[f64]) -> Result<Option<Rest<Plain>>, Stop> {
        let values = self.law_values(natural);
        let law = self.friction.with(&values);
        let change = self.change_with(natural)?;
        let rest = Plain::rest(&self.event, &law, Some(&change))?;
        let shown = |r: Rest<Plain>| Rest { time: r.time + change.clock, ..r };
        Ok(rest.map(shown))
    }

    /// The change that the mechanisms make with values as named.
    fn change_with(&self, natural: &[f64]) -> Result<Change<Plain>, Stop> {
        let Some(amounts) = natural.get(..self.added()) else {
            return Err(Stop::Fail(Error::inference(format!(
                "{} values for {} parameters",
                natural.len(),
                self.unknowns().count()
            ))));
        };
        let amounts: Vec<_> = amounts.iter().map(|&x| Real::new(x)).collect();
        Ok(self.added.change(&amounts))
    }

    fn law_values(&self, natural: &[f64]) -> List<Real<Plain>> {
        let laws = natural.iter().skip(self.added()).take(self.laws);
        laws.map(|&x| Real::new(x)).collect()
    }

    /// Name and prior of each parameter.
    pub fn priors(&self) -> impl Iterator<Item = (&str, &AnyPrior)> {
        self.unknowns().map(|u| (u.name.as_str(), &u.prior))
    }

    /// Name and prior of each parameter of the laws.
    pub(crate) fn law_priors(
        &self,
    ) -> impl Iterator<Item = (&str, &AnyPrior)> {
        let laws = self.own[..self.laws].iter();
        laws.map(|u| (u.name.as_str(), &u.prior))
    }

    /// The name of each parameter of the laws.
    pub(crate) fn law_names(&self) -> Vec<String> {
        self.law_priors().map(|(name, _)| name.to_owned()).collect()
    }

    /// What a parameter is to its mechanism; `Other` where it is of none, or
    /// has been given another prior than the mechanism's.
    pub fn role(&self, parameter: usize) -> Role {
        self.unknowns().nth(parameter).map_or(Role::Other, |own| own.role)
    }

    /// The middle of the prior of the parameter that comes after given
    /// values; `None` for a flat one.
    pub fn middle(&self, before: &[f64]) -> Option<f64> {
        let unknown = self.unknowns().nth(before.len())?;
        unknown.middle(before.last().copied())
    }
}

impl Assembled {
    /// Asks for the friction law's parameters.
    ///
    /// # Errors
    /// [`Stop::Reject`] where one lies outside its prior.
    pub(super) fn ask_laws<K: Number>(
        &self,
        run: &mut Run<'_, K>,
    ) -> Result<List<Real<K>>, Stop> {
        run.amounts(&self.own[..self.laws])
    }

    /// Asks for all other parameters and scores the recordings, the law's
    /// parameters being `laws`.
    ///
    /// # Errors
    /// As in [`Program::run`].
    pub(super) fn score<K: Number>(
        &self,
        run: &mut Run<'_, K>,
        laws: &[Real<K>],
    ) -> Outcome {
        let change = self.ask_change(run)?;
        self.score_under(run, change.as_ref(), laws)
    }

    fn ask_change<K: Number>(
        &self,
        run: &mut Run<'_, K>,
    ) -> Result<Option<Change<K>>, Stop> {
        match self.added() {
            0 => Ok(None),
            _ => self.added.ask(run).map(Some),
        }
    }

    fn score_under<K: Number>(
        &self,
        run: &mut Run<'_, K>,
        change: Option<&Change<K>>,
        laws: &[Real<K>],
    ) -> Outcome {
        let errors = run.amounts(&self.own[self.laws..])?;
        match change {
            None => self.observe(run, laws, &errors),
            Some(change) => {
                run.under(change, |run| self.observe(run, laws, &errors))
            }
        }
    }

    fn observe<K: Number>(
        &self,
        run: &mut Run<'_, K>,
        laws: &[Real<K>],
        errors: &[Real<K>],
    ) -> Outcome {
        let friction = run.declare(self.friction.with(laws));
        run.has(|say| self.noise.blocks(say));
        let flow = self.event.slide(&friction)?;
        let mut outcome = Ok(());
        K::noise(self.noise.as_ref()).with(errors, &mut |noise| {
            outcome = self.event.recordings().try_for_each(|series| {
                run.observe(series, flow.recorded(series.quantity()), &noise)
            });
        })?;
        outcome
    }
}

impl Program for Assembled {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let change = self.ask_change(run)?;
        let laws = self.ask_laws(run)?;
        self.score_under(run, change.as_ref(), &laws)
    }

    /// The law, the mechanisms and their priors stay. Those of the noise are
    /// its defaults, except where it remembers as this one does.
    fn with_noise(&self, name: &str) -> Result<Option<Self>> {
        let alike = |other: &str| Form::of(other).plain();
        let kept = match alike(name) == alike(&self.noise()) {
            true => &self.own[..],
            false => &self.own[..self.laws],
        };
        let priors = kept.iter().map(|own| (own.name.clone(), own.prior));
        let (event, friction) = (self.event.clone(), self.friction.clone());
        let noise = noise::parse(name)?;
        let own = Self::new(event, friction, noise, &priors.collect())?;
        Ok(Some(Self { added: self.added.clone(), ..own }))
    }
}

/// The parameters of laws and noise: full name, own name, field. A name that
/// two blocks share gets its block's before it.
fn fields(
    friction: &LawSum,
    noise: &dyn NoiseEntry,
) -> Vec<(String, String, Field)> {
    let laws = friction.terms().iter().flat_map(|law| {
        law.fields()
            .iter()
            .map(|f| (law.name().to_owned(), f.name.to_owned(), *f))
    });
    let errors = noise
        .parameters()
        .into_iter()
        .map(|(name, field)| ("errors".to_owned(), name, field));
    let all: Vec<_> = laws.chain(errors).collect();
    let shared =
        |name: &str| all.iter().filter(|(_, other, _)| other == name).count();
    all.iter()
        .map(|(block, name, field)| {
            let full = if shared(name) > 1 {
                format!("{block}.{name}")
            } else {
                name.clone()
            };
            (full, name.clone(), *field)
        })
        .collect()
}

fn quantity(event: &Event) -> Quantity {
    event.recordings().next().map_or(Quantity::Velocity, |s| s.quantity())
}

/// A field's unit, where it is the recorded value's or its square's.
fn unit_of(field: &Field, quantity: Quantity) -> &'static str {
    match field.unit {
        "value" => quantity.unit(),
        "value2" => quantity.squared_unit(),
        unit => unit,
    }
}

/// Uneven times have a correlated noise only in its continuous form, whose
/// phi is not negative: a prior that says otherwise is refused.
fn check_uneven(
    event: &Event,
    noise: &dyn NoiseEntry,
    fields: &[(String, String, Field)],
    unknowns: &[Unknown],
) -> Result<()> {
    if !is_uneven(event) {
        return Ok(());
    }
    for ((.., field), unknown) in fields.iter().zip(unknowns) {
        let low = unknown.prior.quantile(0.0).unwrap_or(f64::NEG_INFINITY);
        if field.name == "phi" && low < 0.0 {
            return Err(Error::input(format!(
                "priors.{}: {} reaches below 0, but the recording's times \
                 are uneven, where {} exists for phi >= 0 only; write \
                 \"Uniform(0, 1)\"",
                unknown.name,
                unknown.prior,
                noise.name()
            )));
        }
    }
    Ok(())
}
