//! Which noises a model is weighed under: those that may have made its
//! errors.
//!
//! Each is weighed with physics absent and with a force of free form in the
//! model. With the force a noise cannot win by swallowing a mismatch, and
//! without it a force cannot by imitating noise; what does nearly as well as
//! the best in either way is kept.

use std::f64::consts::LN_10;

use super::fit::{Fit, fit};
use super::survey::{Held, Survey, Weighed, beforehand, best, either_way};
use crate::diagnosis::locate::Outlook;
use crate::error::Result;
use crate::infer::LaplaceMixture;
use crate::mechanism::Extent;
use crate::model::{AnyProgram, Point, Posterior};
use crate::noise::{self, Form};
use crate::seed::Seed;

/// What errors may remember, besides what the named noise says: nothing, or
/// what a steady process does.
const SIMPLE: [&str; 2] = ["white", "ou"];
/// The same with white errors on top; what the filter of a
/// receiver leaves, with white errors.
const WITH_WHITE: [&str; 2] = ["ou + white", "matern32 + white"];
/// What it leaves, with a slow drift.
const WITH_DRIFT: [&str; 1] = ["matern32 + ou"];
/// In log10: how far below the best a noise may be that is kept.
pub(crate) const NEAR: f64 = 2.5;
/// In ln: by how much a noise must have more evidence than simpler ones.
const MORE: f64 = 1.0;
/// The most noises that mechanisms are weighed under; the named one may come
/// on top.
const MOST: usize = 3;

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

    /// ln of its probability before the recording is seen, up to a constant.
    pub(crate) fn beforehand(&self) -> f64 {
        beforehand(&self.name)
    }

    /// ln of its evidence with physics absent or of free form, both alike.
    pub(crate) fn either_way(&self) -> f64 {
        either_way([self.none.log_evidence, self.open.log])
    }
}

/// The noises that a model is weighed under.
#[derive(Debug, Default)]
pub(crate) struct Noises<'a> {
    /// Those that are kept, in the order of what they are worth.
    pub(crate) kept: Vec<Noisy<'a>>,
    /// The named one, where it is not among them.
    pub(crate) dropped: Option<Noisy<'a>>,
    /// Others that are simpler than the first of them. What a mechanism
    /// explains, and no force of free form does, need not be remembered.
    pub(super) simpler: Vec<Weighed<'a>>,
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
    for names in [&SIMPLE[..], &WITH_WHITE, &WITH_DRIFT] {
        let forms = names.iter().map(|name| Form::of(name)).collect();
        all.extend(survey.others(forms, &all)?);
    }
    survey.meet(&[], &mut all)?;
    for forms in [decorated, doubly_decorated] {
        let mut further = survey.others(forms(&all), &all)?;
        survey.meet(&all, &mut further)?;
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
    let mut first: Vec<String> = [0, 1]
        .iter()
        .filter_map(|way| best(*way, all.iter()))
        .map(|one| one.name.clone())
        .collect();
    all.sort_by(|a, b| b.worth().total_cmp(&a.worth()));
    let others = all.iter().map(|one| &one.name);
    first.extend(others.filter(|name| near.contains(name)).cloned());
    let mut most = Vec::new();
    for name in first {
        if most.len() < MOST && !most.contains(&name) {
            most.push(name);
        }
    }
    let mut noises = Noises::default();
    for one in all {
        let is_near = near.contains(&one.name);
        let is_named = one.program.is_named();
        let is_simpler = |first: &Noisy<'_>| {
            one.form().is_simpler_than(&Form::of(&first.name))
        };
        if most.contains(&one.name) || (is_near && is_named) {
            noises.kept.push(one.fitted(seed)?);
        } else if is_named {
            noises.dropped = Some(one.fitted(seed)?);
        } else if noises.kept.first().is_some_and(is_simpler) {
            noises.simpler.push(one);
        }
    }
    Ok(noises)
}

impl<'a> Weighed<'a> {
    /// With the model without physics fitted under it.
    pub(super) fn fitted(self, seed: Seed) -> Result<Noisy<'a>> {
        let Self { name, program, found } = self;
        let seed = seed.called(&name).child(4);
        let none = fit(&*program, &[], &LaplaceMixture::default(), seed)?;
        Ok(Noisy { name, program, none, open: found.open })
    }
}
