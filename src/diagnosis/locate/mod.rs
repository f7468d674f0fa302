//! Where the mismatch is: a free-form force, inferred with the model.
//!
//! A force of unknown shape is added to the equation of motion, with a
//! Gaussian process for its prior: over distance, over time, or over speed.
//! It is a step function of [`CELLS`] cells, so the motion keeps its exact
//! solution. The process's length and size and the model's own parameters are
//! drawn by importance sampling, the force is integrated at each draw of
//! these. A speed error shows downstream of its cause; the force shows where
//! the cause is.

mod confounded;
mod force;
mod free_form;
mod look;
mod marginal;
mod open;
mod peak;
mod process;
mod tangent;

use crate::diagnosis::evidence::fit::{Fit, likeliest};
use crate::error::{Error, Result};
use crate::infer::draws_of;
use crate::infer::nested::{Effort, integrated};
use crate::mechanism::{Extent, Mechanism};
use crate::model::{AnyProgram, ByEvent, Posterior, With};
use crate::parallel;
use crate::physics::forces::Axis;
use crate::seed::Seed;

pub(super) use force::Stretch;
pub use force::{Band, FreeForce};
use free_form::FreeForm;
pub(super) use free_form::{FORMULA, NOUN, SAYS};
use look::{COARSE, FINE, Look, Sought, highest};
use marginal::Marginal;
pub(crate) use open::{Open, left_open};
pub use process::CELLS;
#[cfg(test)]
pub(super) use process::Process;

/// How many draws of the process and the model's own parameters are made.
const EFFORT: Effort =
    Effort { learning: 60, rounds: 3, last: (150, 600), error: 0.1 };
/// The same along an axis whose force is far less likely than along another,
/// by so much in ln.
const FEW: Effort = Effort { last: (60, 60), ..EFFORT };
const FAR: f64 = 3.0;
/// The same where only about how much it brings is asked for.
const GLANCE: Effort =
    Effort { learning: 40, rounds: 2, last: (150, 150), ..EFFORT };
/// Of how many cells the force is then: derivatives along these and the model's
/// own parameters, where looks begin, take two passes instead of three.
const FEW_CELLS: usize = 24;

/// The free-form force as a mechanism of its own, with the fit that it has.
///
/// # Errors
/// A model that fails.
pub(crate) fn free_fit(
    program: &dyn AnyProgram,
    extent: &Extent,
    force: &FreeForce,
    none: &Fit,
) -> Result<(Box<dyn Mechanism>, Fit)> {
    // Any process makes any force; of this one none is far-fetched.
    let free = FreeForm::new(extent, force.axis, force.process)?;
    let with = With::new(program, &[&free]);
    let posterior = Posterior::new(&with)?;
    let lines = force.draws.iter().zip(&force.own);
    let lines: Vec<Vec<f64>> = lines
        .map(|(force, own)| Ok([free.waves(force)?, own.clone()].concat()))
        .collect::<Result<_>>()?;
    let rows = parallel::try_map(&lines, |line| posterior.natural(line))?;
    let mut draws = draws_of(&posterior)?;
    draws.push_chain(rows.concat(), None)?;
    let fit = Fit {
        log_evidence: none.log_evidence + force.log_bayes_factor,
        se: force.se.hypot(none.se),
        best: likeliest(&posterior, &draws)?,
        draws,
        added: CELLS,
        warnings: none.warnings.clone(),
    };
    Ok((Box::new(free), fit))
}

/// Infers a free-form force along an axis, jointly with the model's own
/// parameters, next to the fit `none` of the model without it.
///
/// # Errors
/// A model that fails, or one with no density where `none` has it.
pub fn locate(
    program: &dyn AnyProgram,
    extent: &Extent,
    axis: Axis,
    none: &Fit,
    seed: Seed,
) -> Result<FreeForce> {
    locate_all(program, extent, &[axis], none, seed)
        .map(|mut all| all.remove(0))
}

/// About what a free-form force brings.
#[derive(Debug, Clone)]
pub(crate) struct Outlook {
    /// About ln of the evidence with it.
    pub(crate) log: f64,
    /// The model's own parameters where it is likeliest, on the real line.
    pub(crate) own: Vec<f64>,
    /// ln of about what is held about that place.
    pub(crate) promised: f64,
}

/// About what a free-form force over distance brings to a model whose own
/// parameters may be likely at some places, on the real line: from few draws,
/// about the best of these; `None` where none promises more than so much, in
/// ln.
///
/// # Errors
/// As [`locate`].
pub(crate) fn outlook(
    program: &dyn AnyProgram,
    extent: &Extent,
    owns: &[Vec<f64>],
    least: f64,
    seed: Seed,
) -> Result<Option<Outlook>> {
    let form = FreeForm::cells(extent, Axis::Place, FEW_CELLS);
    let with = ByEvent::new(program, &[&form])?;
    let posterior = Posterior::new(&with)?;
    let sought = Sought::of(&posterior, extent, FEW_CELLS);
    let looks = parallel::try_map(owns, |own| sought.looks(own, COARSE))?;
    let promised = |looks: &[Look]| {
        highest(looks).map_or(f64::NEG_INFINITY, |l| l.peak.log_evidence)
    };
    let less =
        |a: &Vec<Look>, b: &Vec<Look>| promised(a).total_cmp(&promised(b));
    let Some(looks) = looks.into_iter().max_by(less) else { return Ok(None) };
    let best = highest(&looks).map(|look| &look.peak);
    let Some(best) = best.filter(|peak| peak.log_evidence > least) else {
        return Ok(None);
    };
    let (promised, own) =
        (best.log_evidence, best.top.line.as_slice().to_vec());
    let (shared, begun) = (program.count_of_events() > 1, seed.child(0));
    let learned = Marginal::learned(sought, looks, shared, GLANCE, begun)?;
    let Some((marginal, learned)) = learned else { return Ok(None) };
    let found = integrated(&marginal, &learned, GLANCE, seed.child(1))?;
    Ok(Some(Outlook { log: found.sum.log, own, promised }))
}

/// A force of free form over distance on top of a model with mechanisms that
/// are fitted: what is left beside them.
///
/// # Errors
/// As [`locate`].
pub(crate) fn left(
    program: &dyn AnyProgram,
    mechanisms: &[&dyn Mechanism],
    fit: &Fit,
    extent: &Extent,
    seed: Seed,
) -> Result<Option<FreeForce>> {
    let axes = [Axis::Place];
    let whole = Fit { added: 0, ..fit.clone() };
    along((program, mechanisms), extent, &axes, &whole, seed)
        .map(|mut all| all.pop())
}

/// The same along several axes; most sharply where the force is likely. An axis
/// along which no force has a density is left out.
///
/// # Errors
/// As [`locate`], of all axes.
pub(crate) fn locate_all(
    program: &dyn AnyProgram,
    extent: &Extent,
    axes: &[Axis],
    none: &Fit,
    seed: Seed,
) -> Result<Vec<FreeForce>> {
    let forces = along((program, &[]), extent, axes, none, seed)?;
    if forces.is_empty() { Err(no_density()) } else { Ok(forces) }
}

/// The forces along those axes along which one has a density.
fn along(
    (program, mechanisms): (&dyn AnyProgram, &[&dyn Mechanism]),
    extent: &Extent,
    axes: &[Axis],
    none: &Fit,
    seed: Seed,
) -> Result<Vec<FreeForce>> {
    let form = |axis: &Axis| FreeForm::cells(extent, *axis, CELLS);
    let forms: Vec<FreeForm> = axes.iter().map(form).collect();
    let with = forms.iter().map(|form| {
        ByEvent::new(
            program,
            &[&[form as &dyn Mechanism], mechanisms].concat(),
        )
    });
    let with = with.collect::<Result<Vec<_>>>()?;
    let posteriors = with.iter().map(|with| Posterior::new(with));
    let posteriors = posteriors.collect::<Result<Vec<_>>>()?;
    let shared = program.count_of_events() > 1;
    let each = axes.iter().zip(0..).map(|(axis, i)| (axis, seed.child(i)));
    let begun = each.zip(&posteriors);
    let learned = parallel::try_map(begun, |((axis, seed), posterior)| {
        let sought = Sought::of(posterior, extent, CELLS);
        let looks = sought.looks(none.own(), FINE)?;
        let begun = seed.child(0);
        let found = Marginal::learned(sought, looks, shared, EFFORT, begun)?;
        Ok(found.map(|(marginal, learned)| (axis, seed, marginal, learned)))
    })?;
    let learned: Vec<_> = learned.into_iter().flatten().collect();
    let logs = learned.iter().map(|(.., learned)| learned.log);
    let best = logs.fold(f64::NEG_INFINITY, f64::max);
    parallel::try_map(&learned, |(axis, seed, marginal, learned)| {
        let far = learned.log < best - FAR;
        let effort = if far { FEW } else { EFFORT };
        let found = integrated(marginal, learned, effort, seed.child(1))?;
        let (looks, drawn) = (marginal.looks.clone(), seed.child(2));
        Ok(FreeForce::new(extent, **axis, none, &found, looks, drawn))
    })
}

pub(crate) fn no_density() -> Error {
    Error::inference(
        "no free-form force has a density near where the model has it without",
    )
}

#[cfg(test)]
mod tests;
