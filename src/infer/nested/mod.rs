//! Evidence of posteriors whose coordinates fall into groups, such as those of
//! several events: given a few that all have in common, the groups are
//! independent.
//!
//! With theta in common and eta_i of group i,
//!
//! ```text
//! Z = integral of p(theta) Z_1(theta) ... Z_n(theta),
//! Z_i(theta) = integral of p(eta_i) p(y_i | theta, eta_i).
//! ```
//!
//! With nothing in common Z is the product of what each group has alone. Else
//! a proposal for all coordinates at once may do, as with two events; with
//! five of four parameters each, the poor tails of every one multiply. Then
//! theta is drawn from a mixture, as [`LaplaceMixture`] does with all coordinates, and
//! every Z_i(theta) is estimated by importance sampling of its own: a product
//! of unbiased estimates leaves the estimate of Z unbiased (Tran, Scharth,
//! Gunawan, Kohn, Brown, Hawkins 2021).

mod assembly;
mod inner;
mod region;

use nalgebra::DVector;
use rand::seq::SliceRandom;
use rayon::prelude::*;

use super::backends::ImportanceSampling;
use super::backends::laplace_mixture::{
    AMPLE, ENOUGH, LaplaceMixture, ROUNDS, Ridge, is_good, mixture, taught,
};
use super::proposal::Part;
use super::proposal::{Base, Particle, population};
use super::{Backend, Evidence, Inference, Progress, draws_of};
use crate::draws::Draws;
use crate::error::{Error, Result};
use crate::model::Posterior;
use crate::seed::{Rng, Seed};

use assembly::Assembly;
use inner::Inner;
use region::Region;

/// Some coordinates of a posterior, as a posterior of their own.
#[derive(Debug)]
pub struct Group<'a> {
    /// Prior and data of these coordinates alone.
    pub posterior: &'a Posterior<'a>,
    /// Which coordinate of the whole each of them is.
    pub places: Vec<usize>,
}

/// A posterior with its groups.
#[derive(Debug)]
pub struct Grouped<'a> {
    /// All coordinates.
    pub whole: &'a Posterior<'a>,
    /// Those that all groups have in common, under their prior alone; `None`
    /// where there are none.
    pub common: Option<Group<'a>>,
    /// Each group, what is in common among its coordinates.
    pub groups: Vec<Group<'a>>,
}

/// One in so many draws of a round is made of what is in common: each costs a
/// climb and dozens of draws in every group.
const OUTER: usize = 2;

/// How the evidence of groups with something in common is found.
const NESTED: &str = "importance sampling of what is in common, and of each \
    group within it";

impl LaplaceMixture {
    /// Explores a posterior by its groups.
    ///
    /// # Errors
    /// As [`Backend::explore`].
    pub fn explore_groups(
        &self,
        grouped: &Grouped<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        grouped.whole.require_proper("the mixture of peaks")?;
        match &grouped.common {
            None => self.product(grouped, seed, progress),
            Some(common) => {
                self.within_common(grouped, common, seed, progress)
            }
        }
    }

    /// Groups with nothing in common: each on its own.
    fn product(
        &self,
        grouped: &Grouped<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        let found = grouped
            .groups
            .iter()
            .enumerate()
            .map(|(i, group)| {
                let seed = seed.child(i as u64);
                self.within(group).explore(group.posterior, seed, progress)
            })
            .collect::<Result<Vec<_>>>()?;
        let mut draws = draws_of(grouped.whole)?;
        let last = seed.child(found.len() as u64);
        draws.push_chain(joined(grouped, &found, last), None)?;
        let each: Option<Vec<Evidence>> =
            found.iter().map(|one| one.evidence.clone()).collect();
        let each =
            each.ok_or_else(|| Error::inference("a group without evidence"))?;
        let mut warnings: Vec<String> =
            found.iter().flat_map(|one| one.warnings.clone()).collect();
        warnings.dedup();
        Ok(Inference {
            draws: Some(draws),
            evidence: Some(Evidence {
                log: each.iter().map(|e| e.log).sum(),
                se: each.iter().map(|e| e.se * e.se).sum::<f64>().sqrt(),
                method: "each group by itself".to_owned(),
            }),
            warnings,
            ..Inference::default()
        })
    }

    /// The same search within a group: starts and ridges where they cross it.
    fn within(&self, group: &Group<'_>) -> Self {
        let crossing = |line: &Vec<f64>| -> Vec<f64> {
            group.places.iter().map(|&i| line[i]).collect()
        };
        let mut from: Vec<Vec<f64>> = self.from.iter().map(crossing).collect();
        from.dedup();
        let ridges = self.ridges.iter().filter_map(|ridge| {
            let place = |held| group.places.iter().position(|p| p == held);
            let held = ridge.held.iter().map(place).collect::<Option<_>>()?;
            let places = ridge.places.iter();
            let places =
                places.map(|(at, apart)| (crossing(at), apart.clone()));
            let (places, narrow) = (places.collect(), ridge.narrow);
            Some(Ridge { held, places, narrow })
        });
        Self { from, ridges: ridges.collect(), ..self.clone() }
    }

    /// Groups with something in common: a proposal for all coordinates at
    /// once, and where that does not do, one within the other.
    fn within_common(
        &self,
        grouped: &Grouped<'_>,
        common: &Group<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        progress.begin("importance sampling", None);
        let assembly = Assembly::new(grouped, common);
        let whole = Posterior::new(&assembly)?;
        let parts = self.parts(&whole, seed.child(0))?;
        let joint = self.settled_from(&whole, &parts, AMPLE, seed.child(2))?;
        if let Some((found, seed)) = joint.found {
            let whole = grouped.whole;
            let made = ImportanceSampling::conclude(whole, &found, seed)?;
            if made.warnings.is_empty() {
                return Ok(made);
            }
        }
        self.nested(grouped, common, &parts, seed.child(1), progress)
    }

    /// What is in common, and each group given that.
    fn nested(
        &self,
        grouped: &Grouped<'_>,
        common: &Group<'_>,
        parts: &[Part],
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        let marginals: Vec<Part> =
            parts.iter().map(|part| part.marginal(&common.places)).collect();
        let mut mixture = mixture(&marginals)?;
        let inner = Inner::all(grouped, common);
        let regions = self.regions(parts, common, &inner, seed.child(0))?;
        let mut round = 0;
        loop {
            round += 1;
            let seed = seed.child(round);
            let base = Base::Mixture(mixture.clone());
            let count = (self.draws / OUTER).max(10);
            let drawn =
                population(common.posterior, &base, count, seed.child(0))?;
            let (found, wholes): (Vec<_>, Vec<_>) = drawn
                .into_par_iter()
                .enumerate()
                .map(|(i, theta)| {
                    let mut rng = seed.child(1).child(i as u64).rng();
                    completed(theta, common, &inner, &regions, &mut rng)
                })
                .collect::<Result<Vec<(Particle, Particle)>>>()?
                .into_iter()
                .unzip();
            progress.advance(count as u64);
            if round == ROUNDS || is_good(&found, ENOUGH) {
                let (whole, seed) = (grouped.whole, seed.child(2));
                let mut made =
                    ImportanceSampling::conclude(whole, &wholes, seed)?;
                if let Some(evidence) = &mut made.evidence {
                    evidence.method = NESTED.to_owned();
                }
                return Ok(made);
            }
            mixture = taught(&mixture, &found, round - 1, seed.child(3));
        }
    }
}

/// Draws of all coordinates from those of groups that are independent, as many
/// as the best known group has.
fn joined(grouped: &Grouped<'_>, found: &[Inference], seed: Seed) -> Vec<f64> {
    let draws = || found.iter().filter_map(|one| one.draws.as_ref());
    let count = draws().map(Draws::total).max().unwrap_or(0);
    let mut all = vec![vec![0.0; grouped.whole.dimension()]; count];
    let mut rng = seed.rng();
    for (draws, group) in draws().zip(&grouped.groups) {
        let mut rows: Vec<&[f64]> = draws.rows().collect();
        rows.shuffle(&mut rng);
        for (whole, own) in all.iter_mut().zip(rows.iter().cycle()) {
            let places = group.places.iter();
            places.zip(*own).for_each(|(&i, x)| whole[i] = *x);
        }
    }
    all.concat()
}

/// A draw of the common coordinates with what all groups hold there, and the
/// same with a draw of all coordinates.
fn completed(
    theta: Particle,
    common: &Group<'_>,
    inner: &[Inner<'_>],
    regions: &[Region],
    rng: &mut Rng,
) -> Result<(Particle, Particle)> {
    let place = DVector::from_column_slice(&theta.z);
    let near = |a: &&Region, b: &&Region| {
        a.distance(&place).total_cmp(&b.distance(&place))
    };
    let Some(region) = regions.iter().min_by(near) else {
        return Err(Error::inference("no start leads to a peak"));
    };
    let mut line = region.reached(&place).as_slice().to_vec();
    for (&i, z) in common.places.iter().zip(&theta.z) {
        line[i] = *z;
    }
    let prior = theta.log_target();
    let mut held = 0.0;
    for (group, shape) in inner.iter().zip(&region.shapes) {
        if prior + held > f64::NEG_INFINITY {
            held += group.estimate(&mut line, shape.as_ref(), prior, rng)?;
        }
    }
    let z = theta.z.clone();
    Ok((theta.clone().completed(z, held), theta.completed(line, held)))
}

#[cfg(test)]
mod tests;
