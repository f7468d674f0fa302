//! From one noise to another: what evidences gain there.

use crate::diagnosis::evidence::fit::Fit;
use crate::error::Result;
use crate::infer::{LaplaceMixture, SearchSpace};
use crate::mechanism::Mechanism;
use crate::model::{AnyProgram, Posterior, With};
use crate::seed::Seed;

/// By how much more, in ln, normal approximations of the peaks promise of a
/// model with mechanisms under another noise: from draws where it is likely
/// under the first one, with what only the second has at some places.
///
/// # Errors
/// A model that fails.
pub(crate) fn gain(
    (from, fit): (&dyn AnyProgram, &Fit),
    (to, owns): (&dyn AnyProgram, [&[f64]; 2]),
    mechanisms: &[&dyn Mechanism],
    seed: Seed,
) -> Result<f64> {
    let (old, new) = (With::new(from, mechanisms), With::new(to, mechanisms));
    let (old, new) = (Posterior::new(&old)?, Posterior::new(&new)?);
    let drawn = fit.draws.thinned(CARRIED).into_iter();
    let drawn = drawn.map(|row| old.line(row));
    let drawn = drawn.collect::<Result<Vec<_>>>()?;
    let owns = owns.map(|own| (fit.added, own));
    let starts = carried(&old, &drawn, &new, &owns);
    let log = |posterior: &Posterior<'_>, starts: Vec<Vec<f64>>| {
        let space = SearchSpace { starts, ..SearchSpace::default() };
        LaplaceMixture::within(space).outlook(posterior, seed)
    };
    let gain = log(&new, starts)? - log(&old, drawn)?;
    // Where no climb arrives nothing is promised.
    Ok(if gain.is_finite() { gain } else { f64::NEG_INFINITY })
}

/// Where a model with mechanisms is likeliest under one noise, as places under
/// another, with what only the second has at some places.
///
/// # Errors
/// A model that fails.
pub(crate) fn likeliest(
    (from, fit): (&dyn AnyProgram, &Fit),
    (to, owns): (&dyn AnyProgram, [&[f64]; 2]),
    mechanisms: &[&dyn Mechanism],
) -> Result<Vec<Vec<f64>>> {
    let (old, new) = (With::new(from, mechanisms), With::new(to, mechanisms));
    let (old, new) = (Posterior::new(&old)?, Posterior::new(&new)?);
    let owns = owns.map(|own| (fit.added, own));
    Ok(carried(&old, std::slice::from_ref(&fit.best), &new, &owns))
}

/// From how many draws under one noise climbs start under the next.
const CARRIED: usize = 8;

/// Places of one posterior as places of another: what both have is carried
/// over by its name, the rest begins at each of some places of those after
/// the first so many.
pub(super) fn carried(
    old: &Posterior<'_>,
    lines: &[Vec<f64>],
    new: &Posterior<'_>,
    owns: &[(usize, &[f64])],
) -> Vec<Vec<f64>> {
    let place = |name: &str| {
        let mut all = old.parameters().iter();
        all.position(|p| p.name == name)
    };
    let names = new.parameters().iter().map(|p| place(&p.name));
    let places: Vec<Option<usize>> = names.collect();
    let beside = |line| owns.iter().map(move |own| (line, own));
    let each = lines.iter().flat_map(beside);
    each.map(|(line, &(added, own))| {
        let of = |(i, place): (usize, &Option<usize>)| match place {
            Some(place) => line[*place],
            None => own[i - added],
        };
        places.iter().enumerate().map(of).collect()
    })
    .collect()
}
