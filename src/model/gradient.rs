//! Gradients of the log density: forward, or backwards along a tape.

use super::along::Along;
use super::any_program::AnyProgram;
use super::density::{Density, Weights};
use super::number::Number;
use super::pass::{passes, run};
use super::run::Source;
use crate::error::{Error, Result};
use crate::scalar::{Forward, Grad, Real, Recording, Reverse};

/// How many parameters a model has from which on the tape is faster. It costs
/// 5 to 15 densities, and a pass of 8 directions 1.5 to 3: three passes are as
/// much or less, four are a third more where the tape is fast and half as much
/// where it is slow (`cargo bench --bench growth -- parameters events`).
const REVERSE_FROM: usize = 25;

/// The density at a place on the real line, and the gradient of its weighted
/// logarithm there.
pub(super) fn gradient(
    program: &dyn AnyProgram,
    z: &[f64],
    weights: Weights,
    gradient: &mut [f64],
) -> Result<Density> {
    if z.len() >= REVERSE_FROM
        && let Some(density) = reverse(program, z, weights, gradient)?
    {
        return Ok(density);
    }
    forward(program, z, weights, gradient)
}

fn weighted<K: Number>(
    weights: Weights,
    [prior, jacobian, likelihood]: [Real<K>; 3],
) -> Real<K> {
    prior * weights.prior
        + jacobian * weights.jacobian
        + likelihood * weights.likelihood
}

/// From the end backwards, for all directions at once; `None` where the tape
/// does not know how the density was formed.
fn reverse(
    program: &dyn AnyProgram,
    z: &[f64],
    weights: Weights,
    gradient: &mut [f64],
) -> Result<Option<Density>> {
    let recording = Recording::begin();
    let source = Source::Line { z, along: Along::COORDINATES };
    let (density, prior, jacobian, likelihood) =
        run::<Reverse>(program, source, Some(z.len()), None)?;
    let total = weighted(weights, [prior, jacobian, likelihood]);
    Ok(recording.gradient(&total, gradient).then_some(density))
}

/// How many directions a pass takes at the most.
const MOST: usize = 8;

/// The gradient, some directions at a time.
fn forward(
    program: &dyn AnyProgram,
    z: &[f64],
    weights: Weights,
    gradient: &mut [f64],
) -> Result<Density> {
    let mut density = None;
    // Without parameters there is a density too.
    for (first, wide) in passes(z.len().max(1), MOST) {
        let slots = &mut gradient[first..];
        let found = match wide {
            4 => pass::<Grad<4>>(program, z, weights, first, slots),
            _ => pass::<Grad<8>>(program, z, weights, first, slots),
        }?;
        let slides = density.map_or(0, |d: Density| d.slides) + found.slides;
        let zero = found.rejected.is_some();
        density = Some(Density { slides, ..found });
        if zero {
            break;
        }
    }
    density.ok_or_else(|| Error::inference("the model has no parameters"))
}

/// The derivatives along as many directions as the kind carries.
fn pass<K: Number + Forward>(
    program: &dyn AnyProgram,
    z: &[f64],
    weights: Weights,
    first: usize,
    gradient: &mut [f64],
) -> Result<Density> {
    let along = Along::COORDINATES.from(first);
    let source = Source::Line { z, along };
    let (density, prior, jacobian, likelihood) =
        run::<K>(program, source, Some(z.len()), None)?;
    let total = weighted(weights, [prior, jacobian, likelihood]);
    for (i, slot) in gradient.iter_mut().take(K::DIRECTIONS).enumerate() {
        *slot = total.partial(i);
    }
    Ok(density)
}
