//! From one noise to another: what evidences gain there.

use crate::diagnosis::evidence::fit::{Fit, prospect};
use crate::error::{Error, Result};
use crate::infer::{LaplaceMixture, Precision, SearchSpace};
use crate::mechanism::Mechanism;
use crate::model::{AnyProgram, Posterior, With};
use crate::seed::Seed;

/// A model with mechanisms, fitted under one noise, that is moved to another.
pub(crate) struct Move<'a> {
    pub(crate) from: (&'a dyn AnyProgram, &'a Fit),
    /// The model under the second noise, with what only that has at some places.
    pub(crate) to: (&'a dyn AnyProgram, [&'a [f64]; 2]),
    pub(crate) mechanisms: &'a [&'a dyn Mechanism],
}

impl Move<'_> {
    /// By how much more, in ln, normal approximations of the peaks promise under
    /// the second noise, from draws where it is likely under the first.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn gain(&self, seed: Seed) -> Result<f64> {
        self.between(|old, new| {
            let drawn = self.drawn(old)?;
            let starts = self.carried(old, &drawn, new);
            let log = |posterior: &Posterior<'_>, starts| {
                let peaks = beginning_at(starts).outlook(posterior, seed)?;
                Ok::<_, Error>(peaks.log)
            };
            let gain = log(new, starts)? - log(old, drawn)?;
            // Where no climb arrives nothing is promised.
            Ok(if gain.is_finite() { gain } else { f64::NEG_INFINITY })
        })
    }

    /// ln of the evidence under the second noise, sought from there.
    ///
    /// # Errors
    /// A model that fails.
    pub(super) fn estimated(&self, seed: Seed) -> Result<f64> {
        let starts = self.between(|old, new| {
            Ok(self.carried(old, &self.drawn(old)?, new))
        })?;
        let (to, with) = (self.to.0, self.mechanisms);
        let backend = beginning_at(starts).quick();
        let found = prospect(to, with, backend, seed.child(0))?;
        let fit = found.fit(Precision::Fair, seed.child(1))?;
        Ok(fit.log_evidence)
    }

    /// Where it is likeliest under the first noise, as places under the second.
    ///
    /// # Errors
    /// A model that fails.
    pub(super) fn likeliest(&self) -> Result<Vec<Vec<f64>>> {
        let best = std::slice::from_ref(&self.from.1.best);
        self.between(|old, new| Ok(self.carried(old, best, new)))
    }

    /// What follows from its posteriors under both noises.
    fn between<T>(
        &self,
        of: impl FnOnce(&Posterior<'_>, &Posterior<'_>) -> Result<T>,
    ) -> Result<T> {
        let old = With::new(self.from.0, self.mechanisms);
        let new = With::new(self.to.0, self.mechanisms);
        of(&Posterior::new(&old)?, &Posterior::new(&new)?)
    }

    /// Draws under the first noise, on the real line.
    fn drawn(&self, old: &Posterior<'_>) -> Result<Vec<Vec<f64>>> {
        let rows = self.from.1.draws.thinned(CARRIED).into_iter();
        rows.map(|row| old.line(row)).collect()
    }

    fn carried(
        &self,
        old: &Posterior<'_>,
        lines: &[Vec<f64>],
        new: &Posterior<'_>,
    ) -> Vec<Vec<f64>> {
        let owns = self.to.1.map(|own| (self.from.1.added, own));
        carried(old, lines, new, &owns)
    }
}

fn beginning_at(starts: Vec<Vec<f64>>) -> LaplaceMixture {
    LaplaceMixture::within(SearchSpace { starts, ..SearchSpace::default() })
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
