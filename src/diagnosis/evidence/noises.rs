//! Which noises a model is weighed under: those that may have made its
//! errors.
//!
//! Each is weighed with physics absent and with a force of free form in the
//! model. With the force a noise cannot win by swallowing a mismatch, and
//! without it a force cannot by imitating noise; what does nearly as well as
//! the best in either way is kept.

use std::f64::consts::LN_10;
use std::ops::Deref;

use super::carried::carried;
use super::fit::{Fit, Prospect, fit, prospect};
use crate::diagnosis::locate::{Outlook, outlook};
use crate::draws::log_sum_exp;
use crate::error::Result;
use crate::infer::{LaplaceMixture, Precision, SearchSpace};
use crate::mechanism::Extent;
use crate::model::{AnyProgram, Point, Posterior};
use crate::noise::{self, Form};
use crate::parallel;
use crate::seed::Seed;

/// What errors may remember, besides what the named noise says: nothing, or
/// what a steady process does.
const SIMPLE: [&str; 2] = ["white", "ou"];
/// The same with white errors; what the filter of a receiver leaves, with white
/// errors or with a slow drift.
const SUMS: [&str; 3] = ["ou + white", "matern32 + white", "matern32 + ou"];
/// In log10: how far below the best a noise may be that is kept.
pub(crate) const NEAR: f64 = 2.5;
/// In ln: by how much a noise must have more evidence than simpler ones.
const MORE: f64 = 1.0;
/// From how many draws of the prior climbs start before it is known whether a
/// noise is kept.
const STARTS: usize = 8;
/// The most noises that mechanisms are weighed under; the named one may come
/// on top.
const MOST: usize = 3;

/// A program as it was given, or the same with another noise.
#[derive(Debug)]
enum Held<'a> {
    Named(&'a dyn AnyProgram),
    Other(Box<dyn AnyProgram + 'a>),
}

impl Held<'_> {
    fn is_named(&self) -> bool {
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

/// A program under one noise, with what its evidence is without physics and
/// with a force of free form.
#[derive(Debug)]
pub(crate) struct Noisy<'a> {
    /// The noise, as an event file names it.
    pub(crate) name: String,
    program: Held<'a>,
    /// The model without physics.
    pub(crate) none: Fit,
    /// With a force of free form.
    pub(crate) open: Outlook,
}

/// The same before it is known whether it is kept.
#[derive(Debug)]
struct Weighed<'a> {
    name: String,
    program: Held<'a>,
    none: Prospect,
    open: Outlook,
}

impl Noisy<'_> {
    pub(crate) fn program(&self) -> &dyn AnyProgram {
        &*self.program
    }

    /// Where the model's own parameters are likely, on the real line.
    pub(crate) fn own(&self) -> [&[f64]; 2] {
        [self.none.own(), &self.open.own]
    }

    /// Whether it is the one that the model names.
    pub(crate) fn is_named(&self) -> bool {
        self.program.is_named()
    }

    /// ln of its evidence with physics absent or of free form, both alike.
    pub(crate) fn either_way(&self) -> f64 {
        either_way([self.none.log_evidence, self.open.log])
    }
}

impl<'a> Weighed<'a> {
    fn form(&self) -> Form {
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
    fn logs(&self) -> [f64; 2] {
        [self.none.log(), self.open.log]
    }

    /// The same of either way; that of the named one counts tenfold, so that
    /// others take its place only where they are better by far.
    fn worth(&self) -> f64 {
        let named = if self.program.is_named() { LN_10 } else { 0.0 };
        either_way(self.logs()) + named
    }

    fn fitted(self, seed: Seed) -> Result<Noisy<'a>> {
        let Self { name, program, open, .. } = self;
        let none = fit(&*program, &[], &LaplaceMixture::default(), seed)?;
        Ok(Noisy { name, program, none, open })
    }
}

/// ln of an evidence in either of two ways.
fn either_way(logs: [f64; 2]) -> f64 {
    log_sum_exp(logs.into_iter())
}

/// The noises that a model is weighed under.
#[derive(Debug)]
pub(crate) struct Noises<'a> {
    /// Those that are kept, most evidence first, that of the named one counted
    /// tenfold.
    pub(crate) kept: Vec<Noisy<'a>>,
    /// The named one, where it is not among them.
    pub(crate) dropped: Option<Noisy<'a>>,
}

/// Weighs noises beside the named one, and keeps those that do nearly as well
/// as the best.
///
/// # Errors
/// A model that fails under the noise that it names.
pub(crate) fn noises<'a>(
    program: &'a dyn AnyProgram,
    named: &str,
    extent: &Extent,
    seed: Seed,
) -> Result<Noises<'a>> {
    let own_priors = has_own_priors(program, named, seed.child(1))?;
    let survey = Survey { program, extent, own_priors, seed };
    let mut all = vec![survey.named(named)?];
    all.extend(survey.others(SIMPLE.map(Form::of).into(), &all)?);
    all.extend(survey.others(SUMS.map(Form::of).into(), &all)?);
    for forms in [decorated, doubly_decorated] {
        let mut further = survey.others(forms(&all), &all)?;
        further.retain(|one| pays(one, &all));
        all.extend(further);
    }
    kept(all, seed)
}

/// The named noise alone, as if nothing else could have made the errors.
///
/// # Errors
/// A model that fails under it.
pub(crate) fn named_alone<'a>(
    program: &'a dyn AnyProgram,
    named: &str,
    extent: &Extent,
    seed: Seed,
) -> Result<Noises<'a>> {
    let survey = Survey { program, extent, own_priors: false, seed };
    kept(vec![survey.named(named)?], seed)
}

/// Weighs a program under many noises.
struct Survey<'a, 'e> {
    program: &'a dyn AnyProgram,
    extent: &'e Extent,
    /// Whether the named noise has other priors than follow from the event: it
    /// stands for itself alone then. Priors that fit errors of one recording
    /// may rule out those of another, and the same kind of noise with them.
    own_priors: bool,
    seed: Seed,
}

impl<'a> Survey<'a, '_> {
    /// Those of some noises that none of the known ones is like, as far as
    /// the program and its recording allow them.
    fn others(
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
            self.weighed(name, &**program, simpler(name, known))
        });
        // A noise under which nothing has a density is out of the question.
        let found = new.into_iter().zip(weighed);
        let found = found.filter_map(|((name, program), weighed)| {
            let (none, open) = weighed.ok()?;
            let program = Held::Other(program);
            Some(Weighed { name, program, none, open })
        });
        Ok(found.collect())
    }

    /// The named one.
    fn named(&self, name: &str) -> Result<Weighed<'a>> {
        let (none, open) = self.weighed(name, self.program, None)?;
        let program = Held::Named(self.program);
        Ok(Weighed { name: name.to_owned(), program, none, open })
    }

    /// Without physics and with a force. That is sought from where the noise
    /// is likely without it, and from where the force made a simpler noise
    /// likely: the one may have swallowed the mismatch, and a climb from there
    /// may end where it still does.
    fn weighed(
        &self,
        name: &str,
        program: &dyn AnyProgram,
        simpler: Option<&Weighed<'_>>,
    ) -> Result<(Prospect, Outlook)> {
        let seed = self.seed.called(name);
        let none = prospect(program, &[], rough_search(), seed.child(0))?;
        let rough = Precision::Rough;
        let mut owns =
            vec![none.fit(program, &[], rough, seed.child(2))?.best];
        if let Some(simpler) = simpler {
            let old = Posterior::new(&*simpler.program)?;
            let new = Posterior::new(program)?;
            let (lines, own) = ([simpler.open.own.clone()], owns[0].clone());
            owns.extend(carried(&old, &lines, &new, &[(0, &own)]));
        }
        let open = outlook(program, self.extent, &owns, seed.child(3))?;
        Ok((none, open))
    }
}

/// Whether a program's noise has other priors than the same noise gets where
/// nobody states any.
fn has_own_priors(
    program: &dyn AnyProgram,
    named: &str,
    seed: Seed,
) -> Result<bool> {
    if noise::parse(named).is_err() {
        return Ok(false);
    }
    // By way of another memory, which leaves the priors of this one behind.
    let [white, ou] = SIMPLE;
    let is_white = Form::of(named).plain().is_like(&Form::of(white));
    let other = program.under_noise(if is_white { ou } else { white })?;
    let default = other.as_ref().map(|o| o.under_noise(named)).transpose()?;
    let Some(default) = default.flatten() else { return Ok(false) };
    let (own, default) =
        (Posterior::new(program)?, Posterior::new(&*default)?);
    let Some(place) = own.draw_place(&mut seed.rng())? else {
        return Ok(false);
    };
    let log = |of: &Posterior<'_>| -> Result<f64> {
        Ok(of.density(Point::Line(&place))?.log_prior)
    };
    let (own, default) = (log(&own)?, log(&default)?);
    Ok((own - default).abs() > 1e-9 * own.abs())
}

/// Of some noises the one that is simpler than another and has the most
/// evidence with a force.
fn simpler<'w, 'a>(
    name: &str,
    known: &'w [Weighed<'a>],
) -> Option<&'w Weighed<'a>> {
    let form = Form::of(name);
    let simpler = known.iter().filter(|one| one.form().is_simpler_than(&form));
    simpler.max_by(|a, b| a.open.log.total_cmp(&b.open.log))
}

/// A search that says which noises are worth a thorough one.
fn rough_search() -> LaplaceMixture {
    let space = SearchSpace { prior_starts: STARTS, ..SearchSpace::default() };
    LaplaceMixture::within(space).quick()
}

/// How far each is below the best of all, in ln, in the way that suits it
/// better.
fn short(one: &Weighed<'_>, all: &[Weighed<'_>]) -> f64 {
    let ([without, with], logs) = (most(all.iter()), one.logs());
    (without - logs[0]).min(with - logs[1])
}

/// The noises that are near the best, each with tails and with growth.
fn decorated(all: &[Weighed<'_>]) -> Vec<Form> {
    let near = all.iter().filter(|one| short(one, all) < NEAR * LN_10);
    let with = |one: &Weighed<'_>| {
        let form = one.form();
        [
            Form { has_tails: true, ..form.clone() },
            Form { grows: true, ..form },
        ]
    };
    near.flat_map(with).collect()
}

/// The noises with tails and growth, where both of them pay.
fn doubly_decorated(all: &[Weighed<'_>]) -> Vec<Form> {
    let forms: Vec<Form> = all.iter().map(Weighed::form).collect();
    let tailed = |form: &&Form| {
        let alike = |other: &Form| other.plain().is_like(&form.plain());
        form.grows && forms.iter().any(|f| f.has_tails && alike(f))
    };
    let grow = forms.iter().filter(tailed).cloned();
    grow.map(|form| Form { has_tails: true, ..form }).collect()
}

/// Whether it has more evidence than each simpler noise, in either way, and on
/// the whole than its like with the priors of the named one: a noise that does
/// not says the same in more parameters, or in other priors.
fn pays(one: &Weighed<'_>, all: &[Weighed<'_>]) -> bool {
    let form = one.form();
    let named = all.iter().find(|other| other.program.is_named());
    let memory = named.map(|named| named.form().memory);
    let is_stated = |form: &Form| Some(&form.memory) == memory.as_ref();
    let says_the_same = |other: &Weighed<'_>| {
        let its = other.form();
        (is_stated(&its) && !is_stated(&form) && its.is_like(&form))
            && either_way(one.logs()) <= either_way(other.logs()) + MORE
    };
    if all.iter().any(says_the_same) {
        return false;
    }
    let simpler =
        all.iter().filter(|other| other.form().is_simpler_than(&form));
    let ([without, with], logs) = (most(simpler), one.logs());
    logs[0] > without + MORE || logs[1] > with + MORE
}

/// The most evidence of some noises, in ln, in either way.
fn most<'w, 'a: 'w>(
    noises: impl Iterator<Item = &'w Weighed<'a>>,
) -> [f64; 2] {
    noises.map(Weighed::logs).fold([f64::NEG_INFINITY; 2], |most, logs| {
        [most[0].max(logs[0]), most[1].max(logs[1])]
    })
}

/// The best of those that are near the best, the named one and the best in
/// either way among them; each is fitted.
fn kept(mut all: Vec<Weighed<'_>>, seed: Seed) -> Result<Noises<'_>> {
    let idle: Vec<String> = all
        .iter()
        .filter(|one| !one.program.is_named() && !pays(one, &all))
        .map(|one| one.name.clone())
        .collect();
    all.retain(|one| !idle.contains(&one.name));
    let near: Vec<String> = all
        .iter()
        .filter(|one| short(one, &all) < NEAR * LN_10)
        .map(|one| one.name.clone())
        .collect();
    let mut first: Vec<String> =
        [0, 1].iter().filter_map(|way| best(*way, &all)).collect();
    all.sort_by(|a, b| b.worth().total_cmp(&a.worth()));
    let others = all.iter().map(|one| &one.name);
    first.extend(others.filter(|name| near.contains(name)).cloned());
    let mut most = Vec::new();
    for name in first {
        if most.len() < MOST && !most.contains(&name) {
            most.push(name);
        }
    }
    let (mut kept, mut dropped) = (Vec::new(), None);
    for one in all {
        let seed = seed.called(&one.name).child(4);
        let is_near = near.contains(&one.name);
        let is_named = one.program.is_named();
        if most.contains(&one.name) || (is_near && is_named) {
            kept.push(one.fitted(seed)?);
        } else if is_named {
            dropped = Some(one.fitted(seed)?);
        }
    }
    Ok(Noises { kept, dropped })
}

/// The name of the noise with the most evidence in one way.
fn best(way: usize, all: &[Weighed<'_>]) -> Option<String> {
    let more = |a: &&Weighed<'_>, b: &&Weighed<'_>| {
        a.logs()[way].total_cmp(&b.logs()[way])
    };
    all.iter().max_by(more).map(|one| one.name.clone())
}
