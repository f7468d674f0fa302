//! Which mechanism explains the mismatch: evidence of each, and of several
//! together.

use super::fit::{Fit, Prospect, fit, prospect, spread};
use super::grids::even_grids;
use super::owns::{MOST_MET, Met, Owns};
use super::screen::{COARSE, FINE, MET, Mesh, edge_grids};
use crate::diagnosis::locate::{FreeForce, locate_all};
use crate::draws::log_sum_exp;
use crate::error::Result;
use crate::infer::{LaplaceMixture, Precision, Progress, SearchSpace};
use crate::mechanism::{Extent, Mechanism};
use crate::model::{AnyProgram, Posterior, With};
use crate::parallel;
use crate::physics::forces::Axis;
use crate::seed::Seed;

/// What the evidence says of a model and of each mechanism added to it.
#[derive(Debug)]
pub struct Attribution {
    /// The model as it is.
    pub none: Fit,
    /// With a free-form force over distance, over time, and over speed.
    pub forces: Vec<FreeForce>,
    /// With each mechanism, as the catalogue has them.
    pub candidates: Vec<Fit>,
}

impl Attribution {
    /// ln of the evidence with a force of free form, its axes averaged.
    pub(crate) fn open_log(&self) -> f64 {
        let gains = self.forces.iter().map(|force| force.log_bayes_factor);
        let mean = log_sum_exp(gains) - (self.forces.len() as f64).ln();
        self.none.log_evidence + mean
    }
}

/// How many climbs start from the model's own best place, with a mechanism
/// of so many parameters somewhere in its prior.
fn climbs(unknowns: usize) -> usize {
    match unknowns {
        1 => 4,
        2 => 6,
        _ => 8,
    }
}

/// How many climbs, for each mechanism, start from draws of the whole prior.
/// All other starts have the model's own parameters at places that are likely
/// without the mechanism, and with it they may be far off.
pub(super) const PRIOR_STARTS: usize = 12;

/// How far below the best, in ln, evidences still matter.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Care {
    /// What is farther below is estimated roughly.
    relevant: f64,
    /// What is nearer is estimated sharply.
    decisive: f64,
    /// Whether a quick look at each has to do.
    is_quick: bool,
}

impl Care {
    /// Where evidences are asked for themselves: below, each has less than a
    /// hundred-thousandth of the probability.
    const THOROUGH: Self =
        Self { relevant: 10.5, decisive: 10.5, is_quick: false };
    /// Where a decision hangs on them: nothing below a thousandth of the
    /// probability is told, and what has less than a fiftieth neither leads
    /// nor joins the group, which ends at a tenth.
    pub(crate) const DECIDING: Self =
        Self { relevant: 7.0, decisive: 4.0, is_quick: false };
    /// Where an answer is wanted at once: nothing is estimated sharply, and
    /// what is within a twentieth of the probability fairly.
    pub(crate) const QUICK: Self =
        Self { relevant: 3.0, decisive: f64::NEG_INFINITY, is_quick: true };

    /// Over what a force of free form is sought.
    fn axes(self) -> &'static [Axis] {
        match self.is_quick {
            true => &[Axis::Place],
            false => &Axis::ALL,
        }
    }
}

/// Fits the model as it is, with a free-form force, and with each mechanism;
/// sharply where it matters. Without an extent no free-form force is weighed.
///
/// # Errors
/// An improper prior, or a model that fails.
pub fn attribute(
    program: &dyn AnyProgram,
    extent: Option<&Extent>,
    catalogue: &[Box<dyn Mechanism>],
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Attribution> {
    let none = fit(program, &[], &LaplaceMixture::default(), seed.child(0))?;
    let known = Known { places: &[], care: Care::THOROUGH };
    attribute_beside(program, none, extent, catalogue, known, seed, progress)
}

/// The same beside the fit of the model as it is.
///
/// # Errors
/// As [`attribute`].
pub(crate) fn attribute_beside(
    program: &dyn AnyProgram,
    none: Fit,
    extent: Option<&Extent>,
    catalogue: &[Box<dyn Mechanism>],
    Known { places, care }: Known<'_>,
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Attribution> {
    progress.begin("locating the mismatch", None);
    let seed_of = seed.child(0).child(9);
    let forces = match extent {
        Some(extent) => {
            locate_all(program, extent, care.axes(), &none, seed_of)?
        }
        None => Vec::new(),
    };
    let owns = Owns::of(program, &none, &forces)?;
    progress.begin("weighing mechanisms", Some(catalogue.len() as u64));
    let weighing = Weighing { program, catalogue, places, care, seed };
    let candidates = weighing.weighed(none.log_evidence, owns, progress)?;
    Ok(Attribution { none, forces, candidates })
}

/// What is known of a catalogue before it is weighed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known<'k> {
    /// Likely places with each mechanism, on the real line, from where a quick
    /// search does; none where there is no list.
    pub(crate) places: &'k [Vec<Vec<f64>>],
    pub(crate) care: Care,
}

/// Mechanisms that are weighed one by one, in parallel.
struct Weighing<'a> {
    program: &'a dyn AnyProgram,
    catalogue: &'a [Box<dyn Mechanism>],
    /// Likely places with each, where there is a list.
    places: &'a [Vec<Vec<f64>>],
    care: Care,
    seed: Seed,
}

impl<'a> Weighing<'a> {
    fn seed_of(&self, i: usize) -> Seed {
        self.seed.child(1 + i as u64)
    }

    /// The fit of each, beside an evidence that is known.
    fn weighed(
        &self,
        known: f64,
        owns: Owns,
        progress: &dyn Progress,
    ) -> Result<Vec<Fit>> {
        let looked = self.looked(known, owns, progress)?;
        let pursued = match self.care.is_quick {
            true => looked,
            false => self.pursued(looked, known)?,
        };
        self.fitted(pursued, known)
    }

    /// What a look finds of each, and a second one from where others have the
    /// model's own parameters. A brake from the start on may stand for much of
    /// the friction, and no climb from where the model has friction alone
    /// leads there.
    fn looked(
        &self,
        known: f64,
        mut owns: Owns,
        progress: &dyn Progress,
    ) -> Result<Vec<Prospect<'a>>> {
        let unknown = vec![(); self.catalogue.len()];
        let looked = self.each(unknown, |i, mechanism, ()| {
            let known = self.places.get(i).map_or(&[][..], Vec::as_slice);
            let (care, seed) = (self.care, self.seed_of(i));
            let found =
                single(self.program, mechanism, (&owns, known), care, seed);
            progress.advance(1);
            found
        })?;
        let least = highest(&looked, known) - self.care.relevant;
        let met = self
            .each(looked.iter().collect(), |_, mechanism, one| {
                met(mechanism, one, least)
            })?;
        owns.meet(met.into_iter().flatten());
        if owns.met.is_empty() {
            return Ok(looked);
        }
        self.each(looked, |i, mechanism, first| {
            let seed = self.seed_of(i).child(4);
            again(self.program, mechanism, first, &owns, seed)
        })
    }

    /// What is found of each mechanism from what is known of it, in parallel.
    fn each<K: Send, F: Send>(
        &self,
        known: Vec<K>,
        find: impl Fn(usize, &'a dyn Mechanism, K) -> Result<F> + Sync,
    ) -> Result<Vec<F>> {
        let all = self.catalogue.iter().enumerate().zip(known);
        parallel::try_map(all, |((i, mechanism), known)| {
            find(i, mechanism.as_ref(), known)
                .map_err(|error| error.within(mechanism.name()))
        })
    }

    /// The same after learning more, of those that may matter beside an
    /// evidence that is known.
    fn pursued(
        &self,
        prospects: Vec<Prospect<'a>>,
        known: f64,
    ) -> Result<Vec<Prospect<'a>>> {
        let threshold = highest(&prospects, known) - self.care.relevant;
        self.each(prospects, |i, _, prospect| {
            prospect.pursued(threshold, self.seed_of(i).child(3))
        })
    }

    /// How sharply what has such a prospect is worth estimating beside the
    /// best.
    fn precision(&self, prospect: &Prospect<'_>, best: f64) -> Precision {
        let Care { decisive, relevant, .. } = self.care;
        if prospect.may_reach(best - decisive) {
            Precision::Sharp
        } else if prospect.may_reach(best - relevant) {
            Precision::Fair
        } else {
            Precision::Rough
        }
    }

    /// Their fits, sharp where they may matter.
    fn fitted(
        &self,
        prospects: Vec<Prospect<'a>>,
        known: f64,
    ) -> Result<Vec<Fit>> {
        let best = highest(&prospects, known);
        self.each(prospects, |i, _, prospect| {
            let precision = self.precision(&prospect, best);
            prospect.fit(precision, self.seed_of(i).child(2))
        })
    }
}

/// Where a mechanism has the model's own parameters, with ln of what it
/// holds, if that is more than the least.
fn met(
    mechanism: &dyn Mechanism,
    found: &Prospect<'_>,
    least: f64,
) -> Result<Option<(f64, Met)>> {
    if found.log() <= least {
        return Ok(None);
    }
    let peak = found.peak()?;
    Ok(peak
        .map(|(added, own)| (found.log(), Met::of(mechanism, &added, &own))))
}

/// The most evidence, in ln, that any promises or that is known.
fn highest(prospects: &[Prospect<'_>], known: f64) -> f64 {
    prospects.iter().map(Prospect::log).fold(known, f64::max)
}

/// Looks at a single mechanism, from places that are known to be likely, and
/// with the model's own parameters beginning at each of some places.
fn single<'a>(
    program: &'a dyn AnyProgram,
    mechanism: &'a dyn Mechanism,
    (owns, known): (&Owns, &[Vec<f64>]),
    care: Care,
    seed: Seed,
) -> Result<Prospect<'a>> {
    let with = With::new(program, &[mechanism]);
    let posterior = Posterior::new(&with)?;
    let mut space = SearchSpace {
        prior_starts: PRIOR_STARTS,
        starts: known.to_vec(),
        ..SearchSpace::default()
    };
    // Another noise has shown where it is likely: a quick search does.
    let is_known = !known.is_empty();
    let mesh = if is_known { COARSE } else { FINE };
    for (i, own) in owns.best.iter().enumerate() {
        let seed = seed.child(0).child(i as u64);
        let beside = (&[][..], &own[..]);
        space.extend(around(&posterior, mechanism, None, beside, mesh, seed)?);
    }
    for (i, own) in owns.between.iter().enumerate() {
        let seed = seed.child(2).child(i as u64);
        space.starts.extend(anywhere(mechanism, &[], own, seed));
    }
    let is_quick = care.is_quick || is_known;
    for own in owns.tails.iter().filter(|_| !is_quick) {
        let coarse = edge_grids(&posterior, mechanism, &[], own, COARSE)?;
        space.grids.extend(coarse);
    }
    let thorough = LaplaceMixture::within(space);
    let backend = if is_quick { thorough.quick() } else { thorough };
    prospect(program, &[mechanism], backend, seed.child(1))
}

/// From how many places a mechanism begins with what it shares with one that is
/// near another.
const ALIKE: usize = 2;

/// Looks at a single mechanism once more, with the model's own parameters
/// beginning where others have them: what both looks find together.
fn again<'a>(
    program: &'a dyn AnyProgram,
    mechanism: &'a dyn Mechanism,
    first: Prospect<'a>,
    owns: &Owns,
    seed: Seed,
) -> Result<Prospect<'a>> {
    let with = With::new(program, &[mechanism]);
    let posterior = Posterior::new(&with)?;
    let mut space = SearchSpace::default();
    for (i, one) in owns.met.iter().enumerate() {
        let (own, seed) = (&one.own, seed.child(i as u64));
        let anywhere = anywhere(mechanism, &[], own, seed);
        space.starts.extend(one.shared_with(mechanism, &anywhere));
        space.starts.extend(anywhere);
        let grids = edge_grids(&posterior, mechanism, &[], own, MET)?;
        space.grids.extend(grids);
    }
    for (i, one) in owns.alike.iter().enumerate() {
        let seed = seed.child((owns.met.len() + i) as u64);
        let anywhere = anywhere(mechanism, &[], &one.own, seed);
        let few = &anywhere[..ALIKE.min(anywhere.len())];
        space.starts.extend(one.shared_with(mechanism, few));
    }
    let backend = LaplaceMixture::within(space).quick();
    let after = 2 * MOST_MET as u64;
    let looking = seed.child(after);
    let second = prospect(program, &[mechanism], backend, looking)?;
    first.joined(second, seed.child(after + 1))
}

/// Where a mechanism is looked for, all other coordinates beginning at those
/// before and after it: anywhere in its prior, along its grids, with edges as
/// closely as a mesh is, and at the best place that is known of it.
pub(super) fn around(
    posterior: &Posterior<'_>,
    mechanism: &dyn Mechanism,
    known: Option<&[f64]>,
    (before, after): (&[f64], &[f64]),
    mesh: Mesh,
    seed: Seed,
) -> Result<SearchSpace> {
    let known = known.map(|place| [before, place, after].concat());
    let anywhere = anywhere(mechanism, before, after, seed.child(0));
    let starts = known.into_iter().chain(anywhere).collect();
    let mut grids = edge_grids(posterior, mechanism, before, after, mesh)?;
    grids.extend(even_grids(mechanism, before, after, seed.child(1)));
    Ok(SearchSpace { prior_starts: 0, starts, grids })
}

/// Places all over a mechanism's prior, all other coordinates at those before
/// and after it.
pub(super) fn anywhere(
    mechanism: &dyn Mechanism,
    before: &[f64],
    after: &[f64],
    seed: Seed,
) -> Vec<Vec<f64>> {
    let unknowns = mechanism.unknowns();
    let places = spread(&unknowns, climbs(unknowns.len()), seed).into_iter();
    places.map(|(place, _)| [before, &place, after].concat()).collect()
}
