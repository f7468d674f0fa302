//! Searching a posterior for where it lies: the first of the five steps of the
//! Laplace mixture.
//!
//! Climbs start from given places and from likely draws of the prior. Along
//! coordinates that may have many modes, or none, places are held (`places.rs`):
//! one damped step of all other coordinates says what each promises. The
//! promising ones are climbed further, and the best of those with all
//! coordinates. Steps lead on from the places that hold most. Profiles along
//! every coordinate tell where the highest peaks are not as their curvature
//! says.

use std::ops::Range;

use nalgebra::DVector;

use super::climb::{Climb, Held, Peak};
use super::places::{
    HeldGrid, Looked, STEPS_ASIDE, Step, by_height, glanced, spread, walked,
};
use super::profile::{Met, profiles};
use super::proposal::Component;
use super::schedule::Schedule;
use super::start::likely;
use crate::error::Result;
use crate::model::Posterior;
use crate::parallel;
use crate::seed::Seed;

/// Where to look for modes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SearchSpace {
    /// How many climbs start from likely draws of the prior.
    pub prior_starts: usize,
    /// Further starts, on the real line.
    pub starts: Vec<Vec<f64>>,
    /// Places along coordinates that may have many modes, or none.
    pub grids: Vec<HeldGrid>,
}

impl SearchSpace {
    /// Looks in another space too.
    pub(crate) fn extend(&mut self, other: Self) {
        self.prior_starts += other.prior_starts;
        self.starts.extend(other.starts);
        self.grids.extend(other.grids);
    }
}

/// The most steps of a climb with coordinates held.
const FEW: usize = 10;

/// The components of a proposal: peaks, held places and profiles that hold
/// anything, most first.
///
/// # Errors
/// What no other parameter values would mend.
pub(super) fn components(
    posterior: &Posterior<'_>,
    space: &SearchSpace,
    schedule: &Schedule,
    seed: Seed,
) -> Result<Vec<Component>> {
    let mut search = Search::new(posterior, schedule);
    search.climb_from_starts(space, seed)?;
    let glanced = search.look(space)?;
    search.spread_out()?;
    search.looked.extend(glanced);
    search.components()
}

/// What the peaks of a posterior say by their normal approximations.
#[derive(Debug)]
pub(crate) struct Peaks {
    /// About the log evidence.
    pub(crate) log: f64,
    pub(crate) highest: Option<Peak>,
}

/// What peaks are found, and what they say.
///
/// # Errors
/// What no other parameter values would mend.
pub(super) fn outlook(
    posterior: &Posterior<'_>,
    space: &SearchSpace,
    schedule: &Schedule,
    seed: Seed,
) -> Result<Peaks> {
    let mut search = Search::new(posterior, schedule);
    search.climbs.arrived = ALL_THE_WAY;
    search.climb_from_starts(space, seed)?;
    search.look(space)?;
    let logs = search.peaks.iter().filter_map(Peak::log_evidence);
    let log = super::log_sum_exp(logs.collect::<Vec<_>>().into_iter());
    Ok(Peaks { log, highest: search.peaks.into_iter().next() })
}

/// A gain by one step below which a climb ends whose peak is counted by its
/// normal approximation: two that end apart on a flat ridge, as that of two
/// memories where one would do, would count twice.
const ALL_THE_WAY: f64 = 1e-3;

/// A search under way.
struct Search<'a, 'm, 's> {
    posterior: &'a Posterior<'m>,
    schedule: &'a Schedule,
    /// How all coordinates are climbed.
    climbs: Climb,
    /// The highest first, none twice.
    peaks: Vec<Peak>,
    looked: Vec<Looked<'s>>,
}

impl<'a, 'm, 's> Search<'a, 'm, 's> {
    fn new(posterior: &'a Posterior<'m>, schedule: &'a Schedule) -> Self {
        let (climbs, peaks) = (Climb::default(), Vec::new());
        Self { posterior, schedule, climbs, peaks, looked: Vec::new() }
    }

    fn climb_from_starts(
        &mut self,
        space: &SearchSpace,
        seed: Seed,
    ) -> Result<()> {
        let posterior = self.posterior;
        let drawn = parallel::try_map(0..space.prior_starts, |i| {
            likely(posterior, seed.child(i as u64))
        })?;
        let starts = space.starts.iter().cloned();
        for start in starts.chain(drawn.into_iter().flatten()) {
            self.climb(&start)?;
        }
        Ok(())
    }

    /// Climbs with all coordinates, unless that leads to a peak that is known.
    fn climb(&mut self, start: &[f64]) -> Result<()> {
        let known = |line: &DVector<f64>, height: f64| {
            self.peaks.iter().any(|peak| {
                peak.height > height && peak.distance(line) < ALIKE
            })
        };
        let landscape = Held::new(self.posterior, &[]);
        let found = self.climbs.from(&landscape, start, known)?;
        let Some(peak) = found else {
            return Ok(());
        };
        let alike = |p: &Peak| p.distance(&peak.line) < ALIKE;
        if self.peaks.iter().any(|p| alike(p) && p.height >= peak.height) {
            return Ok(());
        }
        self.peaks.retain(|p| !alike(p));
        let higher = |other: &Peak| other.height > peak.height;
        let at = self.peaks.partition_point(higher);
        self.peaks.insert(at, peak);
        Ok(())
    }

    /// Looks at every held place, climbs on from the promising ones with the
    /// place held, and from the best with all coordinates. What is left had
    /// no more than a glance.
    fn look(&mut self, space: &'s SearchSpace) -> Result<Vec<Looked<'s>>> {
        let (posterior, negligible) =
            (self.posterior, self.schedule.negligible);
        let found = parallel::try_map(&space.grids, |grid| {
            let glanced = glanced(posterior, grid)?;
            match grid.held.len() {
                1 => walked(posterior, glanced, negligible),
                _ => Ok(glanced),
            }
        })?;
        let mut found: Vec<Looked<'s>> = found.into_iter().flatten().collect();
        by_height(&mut found);
        let mut promising = spread(&mut found, self.schedule.promising);
        parallel::try_map(&mut promising, |one| one.climb_on(posterior, FEW))?;
        by_height(&mut promising);
        let most = (places_of(space) / 4).max(LEAST_CLIMBED);
        let best = promising.iter().take(most.min(self.schedule.climbed));
        let best: Vec<_> = best.map(|one| one.peak.line.clone()).collect();
        for start in best {
            self.climb(start.as_slice())?;
        }
        self.looked.extend(promising);
        Ok(found)
    }

    /// Goes on from the places that hold most to those next to them, as long
    /// as these hold anything.
    fn spread_out(&mut self) -> Result<()> {
        let mut left = self.schedule.surveyed;
        while left > 0 {
            let mut next = self.beside(left.min(AT_ONCE));
            if next.is_empty() {
                break;
            }
            left = left.saturating_sub(next.len());
            let posterior = self.posterior;
            parallel::try_map(&mut next, |step| {
                step.to.climb_on(posterior, STEPS_ASIDE)
            })?;
            for step in next {
                self.arrive(step);
            }
        }
        Ok(())
    }

    /// Takes a step's end in. Strides are longer where what is held hardly
    /// changes, and shorter where it changes much: then those next to the
    /// beginning are looked at again, half as far.
    fn arrive(&mut self, step: Step<'s>) {
        let Step { along, from, mut to } = step;
        let before = self.looked[from].log;
        let change = (to.log - before).abs();
        if change < EVEN {
            to.spacing[along] *= 2.0;
        } else if change > STEEP {
            let beginning = &mut self.looked[from];
            to.spacing[along] *= 0.5;
            if to.log < before && beginning.spacing[along] > to.spacing[along]
            {
                beginning.spacing[along] = to.spacing[along];
                beginning.surrounded = false;
            }
        }
        self.looked.push(to);
    }

    /// Steps to places not yet looked at, from those that hold most.
    fn beside(&mut self, most: usize) -> Vec<Step<'s>> {
        let logs = self.looked.iter().map(|one| one.log);
        let best = logs.fold(f64::NEG_INFINITY, f64::max);
        self.looked.sort_by(|a, b| b.log.total_cmp(&a.log));
        let mut next: Vec<Step<'s>> = Vec::new();
        for i in 0..self.looked.len() {
            let one = &self.looked[i];
            if best - one.log > HOLDS || next.len() >= most {
                break;
            }
            if one.surrounded {
                continue;
            }
            for step in one.beside(i) {
                let covers = |other: &Looked<'s>| other.covers(&step.to);
                let known = self.looked.iter().any(covers);
                if !known && !next.iter().any(|s| s.to.covers(&step.to)) {
                    next.push(step);
                }
            }
            self.looked[i].surrounded = true;
        }
        next
    }

    /// Profiles from the highest peaks; where these lead higher, from there.
    /// Along what was surveyed they are asked for no more than that.
    ///
    /// A density that bends where recorded times pass the borders of pieces
    /// stops a climb short, and strides along a coordinate pass over that.
    fn profile(&mut self) -> Result<Vec<Component>> {
        let held = self.surveyed();
        self.rise(|along| held.contains(&along))?;
        let free = |along: usize| !held.contains(&along);
        let mut all = self.rise(free)?.components;
        if held.is_empty() {
            let others = 1..self.schedule.profiled;
            all.extend(self.profiled(others, free)?.components);
        }
        Ok(all)
    }

    /// What profiles along some coordinates meet, from the highest peak that
    /// they lead to.
    fn rise(&mut self, along: impl Fn(usize) -> bool) -> Result<Met> {
        let mut met = self.profiled(0..1, &along)?;
        for _ in 0..HIGHER {
            let Some(higher) = met.higher.take() else { break };
            self.climb(higher.line.as_slice())?;
            met = self.profiled(0..1, &along)?;
        }
        Ok(met)
    }

    /// What profiles along some coordinates meet, from some of the highest
    /// peaks.
    fn profiled(
        &self,
        which: Range<usize>,
        along: impl Fn(usize) -> bool,
    ) -> Result<Met> {
        let best = self.peaks.first().map_or(0.0, |peak| peak.height);
        let least = best - self.schedule.profiled_below;
        let high = self.peaks.iter().filter(|peak| peak.height > least);
        let high = high.take(which.end).skip(which.start);
        profiles(self.posterior, high, best, along)
    }

    /// The coordinates along which places were looked at.
    fn surveyed(&self) -> Vec<usize> {
        let mut all: Vec<usize> = Vec::new();
        for one in &self.looked {
            for &i in &one.grid.held {
                if !all.contains(&i) {
                    all.push(i);
                }
            }
        }
        all
    }

    /// About a peak, no wider than the nearest place along what is held: where
    /// a density bends, its derivatives tell nothing of how wide it is.
    fn of_peak(&self, peak: &Peak) -> Option<Component> {
        let nearest = self.looked.iter().min_by(|a, b| {
            a.distance(&peak.line).total_cmp(&b.distance(&peak.line))
        });
        let held = nearest.map_or(&[][..], |one| &one.grid.held);
        let widths = nearest.map_or(&[][..], |one| &one.spacing);
        Component::within(peak, held, widths)
    }

    fn components(mut self) -> Result<Vec<Component>> {
        let profiles = self.profile()?;
        let of_peaks = self.peaks.iter().filter_map(|peak| self.of_peak(peak));
        let of_places = self.looked.iter().filter_map(Looked::component);
        let mut all: Vec<Component> =
            of_peaks.chain(of_places).chain(profiles).collect();
        all.sort_by(|a, b| b.log.total_cmp(&a.log));
        let best = all.first().map_or(0.0, |component| component.log);
        all.retain(|one| best - one.log < self.schedule.negligible);
        all.truncate(self.schedule.components);
        Ok(all)
    }
}

/// From how many held places a climb starts at the least.
const LEAST_CLIMBED: usize = 8;

/// How many places are held.
fn places_of(space: &SearchSpace) -> usize {
    space.grids.iter().map(|grid| grid.places.len()).sum()
}

/// How often profiles may lead higher.
const HIGHER: usize = 8;

/// Peaks nearer than this many widths, squared, are one.
const ALIKE: f64 = 1.0;

/// How far below the best, in ln, places are whose neighbours are looked at.
const HOLDS: f64 = 5.0;
/// How many steps aside are taken at once.
const AT_ONCE: usize = 24;
/// Changes of what is held, in ln, from one place to the next, below which the
/// next stride is twice as long, and above which half.
const EVEN: f64 = 0.4;
const STEEP: f64 = 1.5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::fixture::Hills;
    use crate::infer::places::HeldPlace;

    #[test]
    fn a_survey_that_ends_short_is_led_on_by_a_profile() {
        let posterior = Posterior::new(&Hills).unwrap();
        let line = vec![-0.9, 0.0];
        let place = HeldPlace { line: line.clone(), spacing: vec![0.05] };
        let space = SearchSpace {
            starts: vec![line],
            grids: vec![HeldGrid { held: vec![0], places: vec![place] }],
            ..SearchSpace::default()
        };
        let schedule = Schedule { surveyed: 1, ..Schedule::default() };
        let mut search = Search::new(&posterior, &schedule);
        search.climb_from_starts(&space, Seed::new(1)).unwrap();
        search.look(&space).unwrap();
        search.spread_out().unwrap();
        assert!(search.peaks[0].line[0] < 0.0, "it begins on the lower hill");
        let found = search.components().unwrap();
        // Within a width of the higher hill, 0.45/2.
        let best = found[0].mean[0];
        assert!((best - 1.0).abs() < 0.225, "{best}");
    }
}
