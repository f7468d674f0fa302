//! The model's own parameters with the rest of the physics left open.
//!
//! A force that is missing need not be zero on average over the run, and no
//! recording tells a force that is the same everywhere from a friction. The
//! free-form force has no such level, so that it shows where a mismatch is:
//! what is level is the model's. What its parameters can be with the rest left
//! open takes the level in: a discrepancy that is presumed to be zero on
//! average makes parameters sure of a wrong value (Brynjarsdottir, O'Hagan
//! 2014).

use super::force::FreeForce;
use super::free_form::FreeForm;
use super::look::{Look, Sought, proposal};
use super::marginal::Marginal;
use super::process::CELLS;
use crate::draws::{Draws, log_sum_exp};
use crate::error::Result;
use crate::infer::nested::{Effort, integrated, learn};
use crate::mechanism::Extent;
use crate::model::{AnyProgram, Posterior, Program, With};
use crate::physics::forces::Axis;
use crate::seed::Seed;

/// How many draws are told of.
const TOLD: usize = 400;
/// How many are made along each axis.
const EFFORT: Effort =
    Effort { learning: 60, rounds: 3, last: (200, 600), error: 0.1 };

/// Draws of the model's own parameters with a force of free form and a level
/// in it, along each axis as often as the force there is probable.
///
/// # Errors
/// A model that fails.
pub(crate) fn own_draws(
    program: &dyn AnyProgram,
    extent: &Extent,
    forces: &[FreeForce],
    seed: Seed,
) -> Result<Draws> {
    let with = With::new(program, &[]);
    let posterior = Posterior::new(&with)?;
    let total = log_sum_exp(forces.iter().map(|f| f.log_bayes_factor));
    let mut rows = Vec::new();
    for (i, force) in forces.iter().enumerate() {
        let share = (force.log_bayes_factor - total).exp();
        let count = (share * TOLD as f64).round() as usize;
        if count == 0 {
            continue;
        }
        let seed = seed.child(i as u64);
        let along = (force.axis, &force.looks[..]);
        for own in with_level(program, extent, along, count, seed)? {
            rows.extend(posterior.natural(&own)?);
        }
    }
    let parameters = posterior.parameters().iter();
    let mut draws = Draws::new(
        parameters.clone().map(|p| p.name.clone()).collect(),
        parameters.map(|p| p.unit.clone()).collect(),
    )?;
    draws.push_chain(rows, None)?;
    Ok(draws)
}

/// So many draws of the model's own parameters, on the real line, with a force
/// along one axis, from where it is best without its level.
fn with_level(
    program: &dyn AnyProgram,
    extent: &Extent,
    (axis, looks): (Axis, &[Look]),
    count: usize,
    seed: Seed,
) -> Result<Vec<Vec<f64>>> {
    let form = FreeForm::cells(extent, axis, CELLS);
    let with = With::new(program, &[&form]);
    let posterior = Posterior::new(&with)?;
    let mut sought = Sought::of(&posterior, extent, CELLS);
    sought.has_level = true;
    let looks = sought.looks_from(looks)?;
    let mixture = proposal(&looks)?;
    let marginal = Marginal::new(sought, looks, program.events() > 1);
    let learned = learn(&marginal, mixture, EFFORT, seed.child(0))?;
    let found = integrated(&marginal, &learned, EFFORT, seed.child(1))?;
    let drawn = found.spread(count, seed.child(2)).into_iter();
    Ok(drawn.map(|z| z[2..].to_vec()).collect())
}
