//! What noises promise for a model, each weighed with physics absent and with a
//! force of free form.
//!
//! A search from a few draws of the prior may miss where a noise is likely, and
//! what is likely under one noise tells where to look under another. So each is
//! sought from where those before it have it too, and with a force once more
//! when all are known.

use std::f64::consts::LN_10;
use std::ops::Deref;

use super::carried::carried;
use super::fit::prospect;
use crate::diagnosis::locate::{Outlook, no_density, outlook};
use crate::draws::log_sum_exp;
use crate::error::Result;
use crate::infer::{LaplaceMixture, SearchSpace};
use crate::mechanism::Extent;
use crate::model::{AnyProgram, Posterior};
use crate::noise::{self, Form};
use crate::parallel;
use crate::seed::Seed;

/// By how much more, in ln, a place has to promise for a noise to be weighed
/// from there again.
const HIGHER: f64 = 1.0;
/// From how many draws of the prior climbs start before it is known whether a
/// noise is kept (docs/record/thresholds.md).
const STARTS: usize = 16;
/// In ln: by how much less likely a noise is beforehand for each parameter that
/// it has.
const PER_PARAMETER: f64 = 1.0;
/// At how many draws of its prior what a noise has on top of a simpler one
/// begins.
const ON_TOP: usize = 3;

/// A program as it was given, or the same with another noise.
#[derive(Debug)]
pub(super) enum Held<'a> {
    Named(&'a dyn AnyProgram),
    Other(Box<dyn AnyProgram + 'a>),
}

impl Held<'_> {
    pub(super) fn is_named(&self) -> bool {
        matches!(self, Self::Named(_))
    }
}

impl<'a> Deref for Held<'a> {
    type Target = dyn AnyProgram + 'a;

    fn deref(&self) -> &(dyn AnyProgram + 'a) {
        match self {
            Self::Named(program) => *program,
            Self::Other(program) => program.as_ref(),
        }
    }
}

/// The same before it is known whether it is kept.
#[derive(Debug)]
pub(super) struct Weighed<'a> {
    pub(super) name: String,
    pub(super) program: Held<'a>,
    pub(super) found: Found,
}

/// What a noise promises.
#[derive(Debug)]
pub(super) struct Found {
    /// About ln of its evidence without physics, and where it is best then,
    /// on the real line.
    none: f64,
    own: Vec<f64>,
    /// With a force of free form.
    pub(super) open: Outlook,
}

impl<'a> Weighed<'a> {
    /// Where the model's own parameters are likely under it, on the real line:
    /// without physics, and with a force.
    pub(super) fn own(&self) -> [&[f64]; 2] {
        [&self.found.own, &self.found.open.own]
    }

    pub(super) fn form(&self) -> Form {
        Form::of(&self.name)
    }

    /// Whether a noise of that form need not be weighed beside it.
    fn stands_for(&self, form: &Form, own_priors: bool) -> bool {
        let own_form = self.form();
        let alone = own_priors && self.program.is_named();
        own_form.is_like(form) && (!alone || own_form == *form)
    }

    /// About ln of its evidence in either way: without physics, and with a
    /// force.
    pub(super) fn logs(&self) -> [f64; 2] {
        [self.found.none, self.found.open.log]
    }

    /// A place under it as places under another noise, what that has besides
    /// being elsewhere.
    fn carried(
        &self,
        place: &[f64],
        new: &Posterior<'_>,
        besides: &[&[f64]],
    ) -> Result<Vec<Vec<f64>>> {
        let old = Posterior::new(&*self.program)?;
        let owns: Vec<_> = besides.iter().map(|own| (0, *own)).collect();
        Ok(carried(&old, &[place.to_vec()], new, &owns))
    }

    /// About ln of its evidence in either way, with its probability
    /// beforehand; that of the named one counts tenfold, so that others take
    /// its place only where they are better by far.
    pub(super) fn worth(&self) -> f64 {
        let named = if self.program.is_named() { LN_10 } else { 0.0 };
        either_way(self.logs()) + named + beforehand(&self.name)
    }
}

/// ln of an evidence in either of two ways.
pub(super) fn either_way(logs: [f64; 2]) -> f64 {
    log_sum_exp(logs.into_iter())
}

/// ln of the probability of a noise before a recording is seen, up to a
/// constant: a noise that has a part more makes all the errors that it makes
/// without, and a recording that tells the two hardly apart speaks for the
/// simpler one.
pub(super) fn beforehand(name: &str) -> f64 {
    // Several events may name a noise each.
    let each = name.split(" | ").filter_map(|name| noise::parse(name).ok());
    let parameters = each.map(|noise| noise.parameters().len()).max();
    -PER_PARAMETER * parameters.unwrap_or(0) as f64
}

/// Weighs a program under many noises.
pub(super) struct Survey<'a, 'e> {
    pub(super) program: &'a dyn AnyProgram,
    pub(super) extent: &'e Extent,
    /// Whether the named noise has other priors than follow from the event: it
    /// stands for itself alone then. Priors that fit errors of one recording
    /// may rule out those of another, and the same kind of noise with them.
    pub(super) own_priors: bool,
    pub(super) seed: Seed,
}

impl<'a> Survey<'a, '_> {
    /// Those of some noises that none of the known ones is like, as far as
    /// the program and its recording allow them.
    pub(super) fn others(
        &self,
        forms: Vec<Form>,
        known: &[Weighed<'a>],
    ) -> Result<Vec<Weighed<'a>>> {
        let is_new = |form: &Form| {
            !known.iter().any(|one| one.stands_for(form, self.own_priors))
        };
        let mut new = Vec::new();
        for form in forms.into_iter().filter(is_new) {
            let name = form.to_string();
            // Of events with several noises the names together are none.
            if noise::parse(&name).is_err() {
                continue;
            }
            let other = self.program.under_noise(&name)?;
            // The recording's times may not allow it.
            let allowed =
                other.filter(|other| Posterior::new(&**other).is_ok());
            new.extend(allowed.map(|program| (name, program)));
        }
        let weighed = parallel::map(&new, |(name, program)| {
            self.weighed(name, &**program, known)
        });
        let mut found = Vec::new();
        for ((name, program), weighed) in new.into_iter().zip(weighed) {
            let program = Held::Other(program);
            match weighed {
                Ok(weighed) => {
                    found.push(Weighed { name, program, found: weighed });
                }
                // Nothing has a density under it: it is out of the question.
                Err(error) if error.is_inference() => {}
                Err(error) => return Err(error),
            }
        }
        Ok(found)
    }

    /// The named one.
    pub(super) fn named(&self, name: &str) -> Result<Weighed<'a>> {
        let found = self.weighed(name, self.program, &[])?;
        let (name, program) = (name.to_owned(), Held::Named(self.program));
        Ok(Weighed { name, program, found })
    }

    /// A noise beside those that are known.
    fn weighed(
        &self,
        name: &str,
        program: &dyn AnyProgram,
        known: &[Weighed<'a>],
    ) -> Result<Found> {
        let seed = self.seed.called(name);
        let new = Posterior::new(program)?;
        let beside = Beside { form: Form::of(name), new, known };
        let space = SearchSpace {
            prior_starts: STARTS,
            starts: beside.starts(seed.child(4))?,
            ..SearchSpace::default()
        };
        let search = LaplaceMixture::within(space).quick();
        let none = prospect(program, &[], search, seed.child(0))?;
        let own = none.best(seed.child(2))?;
        let owns = beside.owns(&own, seed.child(5))?;
        let least = f64::NEG_INFINITY;
        let open = outlook(program, self.extent, &owns, least, seed.child(3))?;
        let open = open.ok_or_else(no_density)?;
        Ok(Found { none: none.log(), own, open })
    }

    /// Looks at each of some noises again, from where a force made another of
    /// all likeliest.
    pub(super) fn meet(
        &self,
        known: &[Weighed<'a>],
        new: &mut [Weighed<'a>],
    ) -> Result<()> {
        let found = parallel::try_map(0..new.len(), |i| {
            let others = new.iter().enumerate().filter(|(j, _)| *j != i);
            let others = known.iter().chain(others.map(|(_, one)| one));
            let Some(other) = best(1, others) else { return Ok(None) };
            let Weighed { name, program, found: Found { open, .. } } = &new[i];
            let posterior = Posterior::new(&**program)?;
            let its = &other.found.open.own;
            let owns = other.carried(its, &posterior, &[&open.own])?;
            let (seed, least) =
                (self.seed.called(name), open.promised + HIGHER);
            outlook(&**program, self.extent, &owns, least, seed.child(6))
        })?;
        for (one, open) in new.iter_mut().zip(found) {
            if let Some(open) = open
                && open.log > one.found.open.log
            {
                one.found.open = open;
            }
        }
        Ok(())
    }
}

/// A program under a noise that is not weighed yet, and those that are.
struct Beside<'s, 'a> {
    form: Form,
    new: Posterior<'s>,
    known: &'s [Weighed<'a>],
}

impl<'a> Beside<'_, 'a> {
    /// Where it may be likely without physics: a simpler noise is, and what
    /// this one has on top at some draws of its prior.
    fn starts(&self, seed: Seed) -> Result<Vec<Vec<f64>>> {
        let Some(simpler) = self.simpler(0) else { return Ok(Vec::new()) };
        let (new, mut rng) = (&self.new, seed.rng());
        let draws = (0..ON_TOP).map(|_| new.draw_place(&mut rng));
        let draws = draws.collect::<Result<Vec<_>>>()?;
        let draws: Vec<_> = draws.iter().flatten().map(|z| &z[..]).collect();
        simpler.carried(&simpler.found.own, new, &draws)
    }

    /// Where it may be likely with a force: where it is without one, and where
    /// the force made other noises likely. The one may have swallowed the
    /// mismatch, and a climb from there may end where it still does.
    fn owns(&self, own: &[f64], seed: Seed) -> Result<Vec<Vec<f64>>> {
        let (simpler, any) = (self.simpler(1), best(1, self.known.iter()));
        let drawn = self.new.draw_place(&mut seed.rng())?;
        let besides = [(simpler, Some(own)), (any, drawn.as_deref())];
        let mut owns = vec![own.to_vec()];
        for (other, besides) in besides {
            if let (Some(other), Some(besides)) = (other, besides) {
                let its = &other.found.open.own;
                owns.extend(other.carried(its, &self.new, &[besides])?);
            }
        }
        Ok(owns)
    }

    /// Of the simpler noises the one with the most evidence in one way.
    fn simpler(&self, way: usize) -> Option<&Weighed<'a>> {
        let simpler =
            |one: &&Weighed<'_>| one.form().is_simpler_than(&self.form);
        best(way, self.known.iter().filter(simpler))
    }
}

/// The noise with the most evidence in one way.
pub(super) fn best<'w, 'a: 'w>(
    way: usize,
    noises: impl Iterator<Item = &'w Weighed<'a>>,
) -> Option<&'w Weighed<'a>> {
    noises.max_by(|a, b| a.logs()[way].total_cmp(&b.logs()[way]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noise_costs_beforehand_what_it_has_besides() {
        let further = |name| beforehand("iid") - beforehand(name);
        for (name, parameters) in [
            ("white", 0.0),
            ("ar(2)", 2.0),
            ("matern32 + white", 2.0),
            ("matern32 + ou + tails + growth", 5.0),
            ("iid | ou", 1.0),
        ] {
            assert_eq!(further(name), parameters * PER_PARAMETER, "{name}");
        }
    }
}
