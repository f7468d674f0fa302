//! The model's own parameters, and the whole force, with the rest of the
//! physics left open.
//!
//! What a force does that the friction law could do too no recording tells
//! from the law. The free-form force leaves that to the law, so that it shows
//! where a mismatch is. But what is missing need not be zero on average, nor
//! free of what grows with the speed: a discrepancy that is presumed to be so
//! makes parameters sure of a wrong value (Brynjarsdottir, O'Hagan 2014). So
//! the parameters and the whole force are drawn with forces of their own for
//! what is confounded with the law.

use super::confounded::confounded;
use super::force::{Band, FreeForce};
use super::free_form::FreeForm;
use super::look::{Sought, highest};
use super::marginal::Marginal;
use super::process::CELLS;
use crate::draws::{Draws, log_sum_exp};
use crate::error::Result;
use crate::infer::draws_of;
use crate::infer::nested::{Effort, Integral, integrated};
use crate::mechanism::Extent;
use crate::model::{AnyProgram, ByEvent, Posterior, Program, With};
use crate::seed::Seed;

/// How many draws are told of.
const TOLD: usize = 400;
/// How many are made along each axis.
const EFFORT: Effort =
    Effort { learning: 60, rounds: 3, last: (200, 600), error: 0.1 };

/// What is known with a force of free form that may do what the law does.
#[derive(Debug)]
pub(crate) struct Open {
    /// The model's own parameters, along each axis as often as the force there
    /// is probable.
    pub(crate) own: Draws,
    /// The whole force along each axis; `None` where it is improbable, or has
    /// no density.
    pub(crate) bands: Vec<Option<Band>>,
}

/// Leaves the rest of the physics open, from forces that leave what the law
/// does to the law; `None` where no force that does more has a density.
///
/// # Errors
/// A model that fails.
pub(crate) fn left_open(
    program: &dyn AnyProgram,
    extent: &Extent,
    forces: &[FreeForce],
    seed: Seed,
) -> Result<Option<Open>> {
    let with = With::new(program, &[]);
    let posterior = Posterior::new(&with)?;
    let total = log_sum_exp(forces.iter().map(|f| f.log_bayes_factor));
    let (mut rows, mut bands) = (Vec::new(), Vec::new());
    for (i, force) in forces.iter().enumerate() {
        let share = (force.log_bayes_factor - total).exp();
        let count = (share * TOLD as f64).round() as usize;
        let seed = seed.child(i as u64);
        let found = match count {
            0 => None,
            _ => whole(program, extent, force, seed)?,
        };
        let Some(found) = found else {
            bands.push(None);
            continue;
        };
        for (z, _) in found.spread(count, seed.child(2)) {
            rows.extend(posterior.natural(&z[2..])?);
        }
        let drawn = found.spread(TOLD, seed.child(2)).into_iter();
        let drawn: Vec<Vec<f64>> =
            drawn.flat_map(|(_, forces)| forces.clone()).collect();
        bands.push(Some(Band::of(&drawn)));
    }
    if rows.is_empty() {
        return Ok(None);
    }
    let mut own = draws_of(&posterior)?;
    own.push_chain(rows, None)?;
    Ok(Some(Open { own, bands }))
}

/// Draws of the process, the model's own parameters and the whole force, from
/// where the force beside the law is best; `None` where it has no density
/// there.
fn whole(
    program: &dyn AnyProgram,
    extent: &Extent,
    force: &FreeForce,
    seed: Seed,
) -> Result<Option<Integral<Vec<Vec<f64>>>>> {
    let form = FreeForm::cells(extent, force.axis, CELLS);
    let with = ByEvent::new(program, &[&form])?;
    let posterior = Posterior::new(&with)?;
    let besides = highest(&force.looks)
        .and_then(|look| confounded(&look.tangent, extent));
    let sought = Sought::of(&posterior, extent, CELLS);
    let sought = Sought { besides: besides.as_ref(), ..sought };
    let looks = sought.looks_from(&force.looks)?;
    let (shared, begun) = (program.events() > 1, seed.child(0));
    let learned = Marginal::learned(sought, looks, shared, EFFORT, begun)?;
    learned
        .map(|(marginal, learned)| {
            integrated(&marginal, &learned, EFFORT, seed.child(1))
        })
        .transpose()
}
