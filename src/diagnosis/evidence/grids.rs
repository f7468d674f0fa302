//! Places along a mechanism's coordinates, at which a search holds them.

use std::ops::Range;

use super::fit::spread;
use super::others::Others;
use crate::infer::{HeldGrid, HeldPlace};
use crate::mechanism::{Mechanism, Unknown};
use crate::seed::Seed;

/// How many places along so many coordinates are kept to.
fn places(held: usize) -> usize {
    match held {
        0 => 0,
        1 => 32,
        2 => 120,
        _ => 300,
    }
}

/// The coordinates of a mechanism along which the data may tell little, with
/// even places along them, for each of its amplitudes; all other coordinates
/// begin at `before` and `after`.
pub(crate) fn even_grids(
    mechanism: &dyn Mechanism,
    before: &[f64],
    after: &[f64],
    seed: Seed,
) -> Vec<HeldGrid> {
    let unknowns = mechanism.unknowns();
    let one = |along: Range<usize>| {
        let others = Others::of(&unknowns, &along, before, after);
        even(&unknowns[along], &others, seed)
    };
    mechanism.amplitudes().into_iter().map(one).collect()
}

/// Even places along an amplitude and where it is.
///
/// An amplitude that may have either sign follows from where its stretch is,
/// nearly as in linear regression: there it is not among them.
fn even(along: &[Unknown], others: &Others, seed: Seed) -> HeldGrid {
    let free = usize::from(along.len() > 1 && along[0].is_signed());
    let first = others.before.len();
    let held = (first + free..first + along.len()).collect();
    let searched = &along[free..];
    let amplitude = vec![0.0; free];
    let places = spread(searched, places(searched.len()), seed)
        .into_iter()
        .map(|(place, apart)| {
            let line = others.with(&[&amplitude[..], &place].concat());
            HeldPlace { line, spacing: apart }
        })
        .collect();
    HeldGrid { held, places }
}
