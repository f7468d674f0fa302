//! Which mechanism explains the mismatch: evidence of each, and of pairs.

use rayon::prelude::*;

use crate::diagnosis::evidence::fit::{Fit, fit, spread};
use crate::diagnosis::evidence::ridges::{narrow_ridges, ridges};
use crate::error::Result;
use crate::infer::{LaplaceMixture, Progress, Ridge};
use crate::mechanism::Mechanism;
use crate::model::{Posterior, Program, With};
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
        1 => 10,
        2 => 16,
        _ => 32,
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
    let none = fit(program, &[], &LaplaceMixture::default(), seed.child(0))?;
    progress.begin("weighing mechanisms", Some(catalogue.len() as u64));
    let candidates = catalogue
        .par_iter()
        .enumerate()
        .map(|(i, mechanism)| {
            let seed = seed.child(1 + i as u64);
            let fit = single(program, mechanism.as_ref(), &none, seed)
                .map_err(|error| error.within(mechanism.name()));
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
    let own = none.own();
    let from = spread(&unknowns, climbs(unknowns.len()), seed.child(0))
        .into_iter()
        .map(|(place, _)| [&place, own].concat())
        .collect();
    let mut ridges = ridges(mechanism, &[], own, seed.child(1));
    ridges.extend(narrow_ridges(mechanism, own));
    let backend = LaplaceMixture {
        starts: 4,
        from,
        ridges,
        ..LaplaceMixture::default()
    };
    fit(program, &[mechanism], &backend, seed.child(2))
}

/// A model whose mechanisms are known, with where it is best on the line.
pub(crate) struct Known<'a> {
    pub(crate) mechanisms: &'a [&'a dyn Mechanism],
    /// Their parameters.
    pub(crate) added: &'a [f64],
    /// The model's own parameters.
    pub(crate) own: &'a [f64],
}

/// Starts and ridges for one more mechanism, all else where it is best.
fn ways(
    added: (&dyn Mechanism, &Fit),
    before: &[f64],
    after: &[f64],
    seed: Seed,
) -> (Vec<Vec<f64>>, Vec<Ridge>) {
    let unknowns = added.0.unknowns();
    let joined = |place: &[f64]| [before, place, after].concat();
    let mut from = vec![joined(added.1.mechanism())];
    let anywhere =
        spread(&unknowns, climbs(unknowns.len()) / 2, seed.child(0));
    from.extend(anywhere.iter().map(|(place, _)| joined(place)));
    (from, ridges(added.0, before, after, seed.child(1)))
}

/// Fits a pair: from the best of either, with the other anywhere; `None`
/// where it does not promise an evidence of about the hurdle.
///
/// # Errors
/// As [`attribute`].
pub fn pair<P: Program>(
    program: &P,
    mechanisms: [&dyn Mechanism; 2],
    fits: [&Fit; 2],
    hurdle: f64,
    seed: Seed,
) -> Result<Option<Fit>> {
    let [a, b] = [(mechanisms[0], fits[0]), (mechanisms[1], fits[1])];
    let second = ways(b, a.1.mechanism(), a.1.own(), seed.child(0));
    let after = [b.1.mechanism(), b.1.own()].concat();
    let first = ways(a, &[], &after, seed.child(1));
    let backend = LaplaceMixture {
        starts: 0,
        from: [second.0, first.0].concat(),
        ridges: [second.1, first.1].concat(),
        ..LaplaceMixture::default()
    };
    fit_if_worth(program, &mechanisms, &backend, hurdle, seed.child(9))
}

/// How far, in ln, a normal approximation may fall short of an evidence.
const SHORT: f64 = 3.0;

/// Fits mechanisms only where the peaks promise an evidence of about the
/// hurdle: most combinations are far below it.
fn fit_if_worth<P: Program>(
    program: &P,
    mechanisms: &[&dyn Mechanism],
    backend: &LaplaceMixture,
    hurdle: f64,
    seed: Seed,
) -> Result<Option<Fit>> {
    let with = With::new(program, mechanisms);
    let posterior = Posterior::new(&with)?;
    let outlook = backend.outlook(&posterior, seed.child(0))?;
    if outlook < hurdle - SHORT {
        return Ok(None);
    }
    fit(program, mechanisms, backend, seed.child(1)).map(Some)
}

/// Fits one mechanism more, from the best of those that are known.
pub(crate) fn extend<P: Program>(
    program: &P,
    known: &Known<'_>,
    added: (&dyn Mechanism, &Fit),
    hurdle: f64,
    seed: Seed,
) -> Result<Option<Fit>> {
    let (from, ridges) = ways(added, known.added, known.own, seed.child(0));
    let mut mechanisms = known.mechanisms.to_vec();
    mechanisms.push(added.0);
    let backend = LaplaceMixture {
        starts: 0,
        from,
        ridges,
        ..LaplaceMixture::default()
    };
    fit_if_worth(program, &mechanisms, &backend, hurdle, seed.child(9))
}
