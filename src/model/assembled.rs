//! A model put together at run time, from the names in an event file.
//!
//! The same blocks as in a compiled model, reached through their names: what
//! the command runs.

use std::collections::BTreeMap;

use super::number::Number;
use super::program::Program;
use super::run::{Label, Run};
use crate::block::{Field, List};
use crate::error::{Error, Outcome, Result, Stop};
use crate::noise::{self, NoiseEntry, Spacing};
use crate::observe::{Event, Quantity};
use crate::physics::friction::LawSum;
use crate::physics::{Rest, State, rest, sample};
use crate::prior::AnyPrior;
use crate::scalar::{Plain, Real};

/// One event under a sum of named laws with a named noise.
#[derive(Debug)]
pub struct Assembled {
    event: Event,
    friction: LawSum,
    noise: Box<dyn NoiseEntry>,
    unknowns: Vec<Unknown>,
    laws: usize,
}

/// A parameter with its prior.
#[derive(Debug, Clone)]
struct Unknown {
    name: String,
    unit: String,
    prior: AnyPrior,
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
            unknowns.push(Unknown {
                name: name.clone(),
                unit: unit_of(field, unit),
                prior,
            });
        }
        check_uneven(&event, noise.as_ref(), &fields, &unknowns)?;
        let laws = friction.dimension();
        Ok(Self { event, friction, noise, unknowns, laws })
    }

    /// Refuses priors of parameters that the model does not have.
    ///
    /// # Errors
    /// The first such prior, with the parameters that there are.
    pub fn check_priors(
        &self,
        priors: &BTreeMap<String, AnyPrior>,
    ) -> Result<()> {
        let fields = fields(&self.friction, self.noise.as_ref());
        let known = |key: &str| {
            fields.iter().any(|(full, own, field)| {
                key == full || key == own || key == field.name
            })
        };
        match priors.keys().find(|key| !known(key)) {
            None => Ok(()),
            Some(key) => {
                let names: Vec<_> =
                    self.unknowns.iter().map(|u| u.name.as_str()).collect();
                Err(Error::input(format!(
                    "priors.{key}: the model has no parameter {key:?}; it \
                     has {}",
                    names.join(", ")
                )))
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
            unknowns: self.unknowns.clone(),
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

    /// How many of the parameters are the friction law's; they come first.
    pub fn friction_dimension(&self) -> usize {
        self.laws
    }

    /// The motion at increasing times \[s\], parameters as named.
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
        let mut states = Vec::with_capacity(times.len());
        let (path, release) = (self.event.path(), self.event.release());
        sample(&path, &law, release, times, false, |s| states.push(s))?;
        Ok(states)
    }

    /// Where and when the mass comes to rest; `None` if it never does.
    ///
    /// # Errors
    /// [`Stop::Reject`] where the law has no flow with these values.
    pub fn rest(&self, natural: &[f64]) -> Result<Option<Rest<Plain>>, Stop> {
        let values = self.law_values(natural);
        let law = self.friction.with(&values);
        rest(&self.event.path(), &law, self.event.release())
    }

    fn law_values(&self, natural: &[f64]) -> List<Real<Plain>> {
        natural[..self.laws].iter().map(|&x| Real::new(x)).collect()
    }

    /// Name and prior of each parameter.
    pub fn priors(&self) -> impl Iterator<Item = (&str, &AnyPrior)> {
        self.unknowns.iter().map(|u| (u.name.as_str(), &u.prior))
    }
}

impl Program for Assembled {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mut values = List::<Real<K>>::new();
        for unknown in &self.unknowns {
            let label = Label::new(&unknown.name, &unknown.unit);
            values.push(run.scalar(label, unknown.prior)?);
        }
        let (laws, errors) = values.split_at(self.laws);
        let friction = run.declare(self.friction.with(laws));
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
fn unit_of(field: &Field, quantity: Quantity) -> String {
    match field.unit {
        "value" => quantity.unit().to_owned(),
        "value2" => quantity.squared_unit().to_owned(),
        unit => unit.to_owned(),
    }
}

fn is_uneven(event: &Event) -> bool {
    event.recordings().any(|s| *s.grid().spacing() == Spacing::Uneven)
}

/// The block's default; on uneven times an autocorrelation is positive.
fn default_prior(field: &Field, event: &Event) -> Result<AnyPrior> {
    let text = match field.name {
        "phi" if is_uneven(event) => "Uniform(0, 1)",
        _ => field.prior,
    };
    AnyPrior::parse(text)
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
