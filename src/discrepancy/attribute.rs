//! Which mechanism explains the mismatch: evidence of each, and of pairs.

use rayon::prelude::*;

use super::fit::{Fit, fit, spread};
use crate::change::{Mechanism, Unknown};
use crate::error::Result;
use crate::infer::{Peaks, Progress, Ridge};
use crate::model::Program;
use crate::prior::AnyPrior;
use crate::seed::Seed;

/// What the evidence says of a model and of each mechanism added to it.
#[derive(Debug)]
pub struct Attribution {
    /// The model as it is.
    pub none: Fit,
    /// With each mechanism, as the catalogue has them.
    pub candidates: Vec<Fit>,
}

/// How many climbs start from the model's own best place, with a mechanism
/// of so many parameters somewhere in its prior.
fn climbs(unknowns: usize) -> usize {
    match unknowns {
        1 => 4,
        2 => 10,
        _ => 24,
    }
}

/// How many places along so many coordinates are kept to.
fn places(held: usize) -> usize {
    match held {
        0 => 0,
        1 => 32,
        2 => 144,
        _ => 300,
    }
}

/// Fits the model as it is, and with each mechanism.
///
/// # Errors
/// An improper prior, or a model that fails.
pub fn attribute<P: Program>(
    program: &P,
    catalogue: &[Box<dyn Mechanism>],
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Attribution> {
    let none = fit(program, &[], &Peaks::default(), seed.child(0))?;
    progress.begin("weighing mechanisms", Some(catalogue.len() as u64));
    let candidates = catalogue
        .par_iter()
        .enumerate()
        .map(|(i, mechanism)| {
            let seed = seed.child(1 + i as u64);
            let fit = single(program, mechanism.as_ref(), &none, seed);
            progress.advance(1);
            fit
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(Attribution { none, candidates })
}

fn single<P: Program>(
    program: &P,
    mechanism: &dyn Mechanism,
    none: &Fit,
    seed: Seed,
) -> Result<Fit> {
    let unknowns = mechanism.unknowns();
    let n = unknowns.len();
    let from = spread(&unknowns, climbs(n), seed.child(0))
        .into_iter()
        .map(|(place, _)| [place, none.own().to_vec()].concat())
        .collect();
    let ridges = vec![ridge(&unknowns, &[], none.own(), seed.child(1))];
    let backend = Peaks { starts: 4, from, ridges, ..Peaks::default() };
    fit(program, &[mechanism], &backend, seed.child(2))
}

/// The coordinates of a mechanism along which the data may tell little, with
/// even places along them; `before` and `after` are where all others begin.
///
/// An amplitude that may have either sign follows from the rest, nearly as in
/// linear regression: it is not among them.
fn ridge(
    unknowns: &[Unknown],
    before: &[f64],
    after: &[f64],
    seed: Seed,
) -> Ridge {
    let signed = unknowns
        .first()
        .is_some_and(|u| matches!(u.prior, AnyPrior::Normal(..)));
    let free = usize::from(signed);
    let held = before.len() + free..before.len() + unknowns.len();
    let kept = &unknowns[free..];
    let amplitude = vec![0.0; free];
    let places = spread(kept, places(kept.len()), seed)
        .into_iter()
        .map(|(place, apart)| {
            ([before, &amplitude, &place, after].concat(), apart)
        })
        .collect();
    Ridge { held, places }
}

/// Fits a pair: from the best of either, with the other anywhere.
///
/// # Errors
/// As [`attribute`].
pub fn pair<P: Program>(
    program: &P,
    mechanisms: [&dyn Mechanism; 2],
    fits: [&Fit; 2],
    seed: Seed,
) -> Result<Fit> {
    let unknowns: [Vec<Unknown>; 2] = mechanisms.map(|m| m.unknowns());
    let mut from = Vec::new();
    let mut ridges = Vec::new();
    for (k, known) in fits.iter().enumerate() {
        let seed = seed.child(k as u64);
        let other = &unknowns[1 - k];
        let (best, own) = (known.mechanism(), known.own());
        // The mechanisms' parameters come in their order.
        let joined = |place: &[f64]| match k {
            0 => [best, place, own].concat(),
            _ => [place, best, own].concat(),
        };
        from.push(joined(fits[1 - k].mechanism()));
        let anywhere = spread(other, climbs(other.len()) / 2, seed.child(0));
        from.extend(anywhere.iter().map(|(place, _)| joined(place)));
        ridges.push(match k {
            0 => ridge(other, best, own, seed.child(1)),
            _ => ridge(other, &[], &[best, own].concat(), seed.child(1)),
        });
    }
    let backend = Peaks { starts: 0, from, ridges, ..Peaks::default() };
    fit(program, &mechanisms, &backend, seed.child(9))
}
