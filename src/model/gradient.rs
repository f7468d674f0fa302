//! Gradients of the log density: forward, or backwards along a tape.

use super::density::{Density, Weights};
use super::number::Number;
use super::pass::run;
use super::program::Program;
use super::run::Source;
use crate::error::{Error, Result};
use crate::scalar::{Forward, Grad, Real, Recording, Reverse};

/// How many parameters a model has from which on the tape is faster. It costs
/// 3 to 8 densities, and a pass of 8 directions costs 2 to 3: one or two
/// passes are less or as much, three of them are seldom less and up to twice
/// as much (`cargo bench --bench growth -- parameters events`).
const REVERSE_FROM: usize = 17;

/// The density at a place on the real line, and the gradient of its weighted
/// logarithm there.
pub(super) fn gradient<P: Program>(
    program: &P,
    z: &[f64],
    weights: Weights,
    gradient: &mut [f64],
) -> Result<Density> {
    match z.len() {
        0..=2 => forward::<Grad<2>, P>(program, z, weights, gradient),
        3..=4 => forward::<Grad<4>, P>(program, z, weights, gradient),
        n if n < REVERSE_FROM => {
            forward::<Grad<8>, P>(program, z, weights, gradient)
        }
        _ => match reverse(program, z, weights, gradient)? {
            Some(density) => Ok(density),
            None => forward::<Grad<8>, P>(program, z, weights, gradient),
        },
    }
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
fn reverse<P: Program>(
    program: &P,
    z: &[f64],
    weights: Weights,
    gradient: &mut [f64],
) -> Result<Option<Density>> {
    let recording = Recording::begin();
    let source = Source::Line { z, first: 0 };
    let (density, prior, jacobian, likelihood) =
        run::<Reverse, P>(program, source, Some(z.len()), None)?;
    let total = weighted(weights, [prior, jacobian, likelihood]);
    Ok(recording.gradient(&total, gradient).then_some(density))
}

/// The gradient, as many directions at a time as the kind carries.
fn forward<K: Number + Forward, P: Program>(
    program: &P,
    z: &[f64],
    weights: Weights,
    gradient: &mut [f64],
) -> Result<Density> {
    let mut density = None;
    let mut first = 0;
    loop {
        let source = Source::Line { z, first };
        let (found, prior, jacobian, likelihood) =
            run::<K, P>(program, source, Some(z.len()), None)?;
        let total = weighted(weights, [prior, jacobian, likelihood]);
        for (i, slot) in gradient.iter_mut().skip(first).enumerate() {
            if i < K::DIRECTIONS {
                *slot = total.partial(i);
            }
        }
        let slides = density.map_or(0, |d: Density| d.slides) + found.slides;
        let zero = found.rejected.is_some();
        density = Some(Density { slides, ..found });
        first += K::DIRECTIONS;
        if first >= z.len() || zero {
            break;
        }
    }
    density.ok_or_else(|| Error::inference("the model has no parameters"))
}
