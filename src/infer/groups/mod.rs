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
//! theta is drawn from a mixture, as [`LaplaceMixture`] does with all
//! coordinates, and every Z_i(theta) is estimated by importance sampling of
//! its own: a product of unbiased estimates leaves the estimate of Z unbiased
//! (Tran, Scharth, Gunawan, Kohn, Brown, Hawkins 2021).

mod group;
mod inner;
mod region;

use nalgebra::DVector;
use rand::seq::SliceRandom;

use super::adapt::Frozen;
use super::backends::laplace_mixture::{LaplaceMixture, mixture};
use super::estimate::{Precision, estimated};
use super::nested::{Effort, Held, Outer, integrated, learn};
use super::places::{HeldGrid, HeldPlace};
use super::proposal::Component;
use super::schedule::Schedule;
use super::search::{SearchSpace, components};
use super::weights::Sum;
use super::{Evidence, Inference, Progress, draws_of};
use crate::draws::Draws;
use crate::error::{Error, Result};
use crate::model::{Point, Posterior};
use crate::seed::Seed;

pub use group::{Group, Grouped};
use inner::Inner;
use region::Region;

/// Draws of what is in common in a round of learning, the fewest that make an
/// estimate, and the most of a fair and of a sharp one: each costs a climb and
/// dozens of draws in every group.
const LEARNING: usize = 200;
const FEWEST: usize = 300;
const FAIR: usize = 1000;
const SHARP: usize = 3000;

/// The most rounds of learning, and those of what is estimated roughly.
const ROUNDS: u64 = 6;
const FEW_ROUNDS: u64 = 2;

/// The effective share at which a proposal for all coordinates at once does:
/// nested, a draw costs dozens of times as much.
const JOINT: f64 = 0.25;

/// After how many rounds it is given up, and after how many where less than
/// such a part of that share is in sight.
const JOINT_ROUNDS: u64 = 6;
const HOPELESS_ROUNDS: u64 = 2;
const HOPELESS: f64 = 0.25;

/// How the evidence of groups with something in common is found.
const NESTED: &str = "importance sampling of what is in common, and of each \
    group within it";

impl LaplaceMixture {
    /// Explores a posterior by its groups.
    ///
    /// # Errors
    /// As [`Backend::explore`](super::Backend::explore).
    pub fn explore_groups(
        &self,
        grouped: &Grouped<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        self.estimate_groups(grouped, Precision::Sharp, seed, progress)
    }

    /// The same, as sharp as asked.
    ///
    /// # Errors
    /// As [`Backend::explore`](super::Backend::explore).
    pub(crate) fn estimate_groups(
        &self,
        grouped: &Grouped<'_>,
        precision: Precision,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        grouped.whole.require_proper("the mixture of peaks")?;
        let Some(common) = &grouped.common else {
            return self.product(grouped, precision, seed, progress);
        };
        self.within_common(grouped, common, precision, seed, progress)
    }

    /// How many draws of what is in common are made.
    fn effort(&self, precision: Precision) -> Effort {
        let (rounds, most) = match precision {
            Precision::Rough => (FEW_ROUNDS, FEWEST),
            Precision::Fair => (ROUNDS, FAIR),
            Precision::Sharp => (ROUNDS, SHARP),
        };
        let (last, error) = ((FEWEST, most), self.schedule.error);
        Effort { learning: LEARNING, rounds, last, error }
    }

    /// Groups with nothing in common: each on its own.
    fn product(
        &self,
        grouped: &Grouped<'_>,
        precision: Precision,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        let found = grouped
            .groups
            .iter()
            .enumerate()
            .map(|(i, group)| {
                let seed = seed.child(i as u64);
                self.within_group(group).explored(
                    group.posterior,
                    precision,
                    seed,
                    progress,
                )
            })
            .collect::<Result<Vec<_>>>()?;
        let mut draws = draws_of(grouped.whole)?;
        let last = seed.child(found.len() as u64);
        draws.push_chain(joined(grouped, &found, last), None)?;
        let each: Option<Vec<Evidence>> =
            found.iter().map(|one| one.evidence.clone()).collect();
        let each =
            each.ok_or_else(|| Error::inference("a group without evidence"))?;
        let mut warnings: Vec<String> = Vec::new();
        for warning in found.into_iter().flat_map(|one| one.warnings) {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
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

    /// The same search within a group: starts and grids where they cross it.
    fn within_group(&self, group: &Group<'_>) -> Self {
        let crossing = |line: &Vec<f64>| -> Vec<f64> {
            group.places.iter().map(|&i| line[i]).collect()
        };
        let space = &self.space;
        let mut starts: Vec<Vec<f64>> =
            space.starts.iter().map(crossing).collect();
        starts.dedup();
        let grids = space.grids.iter().filter_map(|grid| {
            let place = |held| group.places.iter().position(|p| p == held);
            let held = grid.held.iter().map(place).collect::<Option<_>>()?;
            let places = grid.places.iter().map(|place| HeldPlace {
                line: crossing(&place.line),
                spacing: place.spacing.clone(),
            });
            Some(HeldGrid { held, places: places.collect() })
        });
        let grids = grids.collect();
        let space = SearchSpace { starts, grids, ..*space };
        Self { space, schedule: self.schedule }
    }

    /// Groups with something in common: a proposal for all coordinates at
    /// once, and where that does not do, one within the other.
    fn within_common(
        &self,
        grouped: &Grouped<'_>,
        common: &Group<'_>,
        precision: Precision,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        progress.begin("importance sampling", None);
        let whole = grouped.whole;
        let schedule = Schedule { good_share: JOINT, ..self.schedule };
        let parts = components(whole, &self.space, &schedule, seed.child(0))?;
        let mut joint = Frozen::new(mixture(&parts)?);
        for rounds in [HOPELESS_ROUNDS, JOINT_ROUNDS] {
            let seed_of = seed.child(2).child(rounds);
            joint = joint.learned(whole, &schedule, rounds, seed_of)?;
            let share = 1.0 / (1.0 + joint.excess);
            if share < HOPELESS * JOINT {
                break;
            }
        }
        if joint.good {
            let seed = seed.child(3);
            let found = estimated(whole, &joint, &schedule, precision, seed)?;
            if found.suits(precision) {
                return Ok(found.made);
            }
        }
        let effort = self.effort(precision);
        self.nested(grouped, common, &parts, effort, seed.child(1))
    }

    /// What is in common, and each group given that.
    fn nested(
        &self,
        grouped: &Grouped<'_>,
        common: &Group<'_>,
        parts: &[Component],
        effort: Effort,
        seed: Seed,
    ) -> Result<Inference> {
        let marginals: Vec<Component> =
            parts.iter().map(|part| part.marginal(&common.places)).collect();
        let inner = Inner::all(grouped, common);
        let regions = self.regions(parts, common, &inner, seed.child(0))?;
        let outer = Given { common, inner, regions };
        let proposal = mixture(&marginals)?;
        let learned = learn(&outer, proposal, effort, seed.child(1))?;
        let found = integrated(&outer, &learned, effort, seed.child(2))?;
        let rows = found
            .draws(seed.child(3))
            .into_iter()
            .map(|(_, line)| grouped.whole.natural(line))
            .collect::<Result<Vec<_>>>()?;
        let mut draws = draws_of(grouped.whole)?;
        draws.push_chain(rows.concat(), None)?;
        let Sum { log, se, warnings, .. } = found.sum;
        let method = NESTED.to_owned();
        Ok(Inference {
            draws: Some(draws),
            evidence: Some(Evidence { log, se, method }),
            warnings,
            ..Inference::default()
        })
    }
}

/// Groups that are independent given what is in common.
struct Given<'a> {
    common: &'a Group<'a>,
    inner: Vec<Inner<'a>>,
    regions: Vec<Region>,
}

impl Outer for Given<'_> {
    /// All coordinates.
    type Rest = Vec<f64>;

    fn prior(&self) -> Option<&Posterior<'_>> {
        Some(self.common.posterior)
    }

    /// What all groups hold, with a draw of all coordinates.
    fn held(&self, z: &[f64], seed: Seed) -> Result<Held<Vec<f64>>> {
        let place = DVector::from_column_slice(z);
        let near = |a: &&Region, b: &&Region| {
            a.distance(&place).total_cmp(&b.distance(&place))
        };
        let Some(region) = self.regions.iter().min_by(near) else {
            return Err(Error::inference("no start leads to a peak"));
        };
        let mut line = region.reached(&place).as_slice().to_vec();
        for (&i, z) in self.common.places.iter().zip(z) {
            line[i] = *z;
        }
        let density = self.common.posterior.density(Point::Line(z))?;
        let prior = density.on_line();
        let mut rng = seed.rng();
        let mut held = 0.0;
        for (group, shape) in self.inner.iter().zip(&region.shapes) {
            if prior + held == f64::NEG_INFINITY {
                return Ok(Held::nothing());
            }
            let shape = shape.as_ref();
            held += group.estimate(&mut line, shape, prior, &mut rng)?;
        }
        Ok(Held { log: prior + held, rest: Some(line) })
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

#[cfg(test)]
mod tests;
