//! Searching a posterior for where it lies: the first of the five steps of the
//! Laplace mixture.
//!
//! Climbs start from given places and from likely draws of the prior. Along
//! coordinates that may have many modes, or none, places are held: one damped
//! step of all other coordinates says what each promises. The promising ones
//! are climbed further, and the best of those with all coordinates. Steps lead
//! on from the places that hold most. Profiles along every coordinate tell
//! where the highest peaks are not as their curvature says.

use nalgebra::DVector;
use rayon::prelude::*;

use super::climb::{Held, Peak, climb_holding, climb_unless};
use super::profile::{Met, profiles};
use super::proposal::Component;
use super::schedule::Schedule;
use super::start::likely;
use crate::error::Result;
use crate::model::{Point, Posterior};
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

/// Places along some coordinates, which are held there.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldGrid {
    /// Which coordinates.
    pub held: Vec<usize>,
    /// The places.
    pub places: Vec<HeldPlace>,
}

/// A place of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldPlace {
    /// All coordinates on the real line; those not held begin there.
    pub line: Vec<f64>,
    /// How far the next places lie along each held coordinate.
    pub spacing: Vec<f64>,
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

/// About the log evidence, from the normal approximations of the peaks alone.
///
/// # Errors
/// What no other parameter values would mend.
pub(super) fn outlook(
    posterior: &Posterior<'_>,
    space: &SearchSpace,
    schedule: &Schedule,
    seed: Seed,
) -> Result<f64> {
    let mut search = Search::new(posterior, schedule);
    search.climb_from_starts(space, seed)?;
    search.look(space)?;
    let logs = search.peaks.iter().filter_map(Peak::log_evidence);
    Ok(super::log_sum_exp(logs.collect::<Vec<_>>().into_iter()))
}

/// A held place with where the other coordinates come to.
#[derive(Clone)]
struct Looked<'s> {
    grid: &'s HeldGrid,
    spacing: Vec<f64>,
    peak: Peak,
    /// About what all other coordinates hold there, in ln.
    log: f64,
    /// Whether those next to it were looked at.
    surrounded: bool,
}

/// A step from a place to one next to it.
struct Step<'s> {
    /// Which of the coordinates that are held.
    along: usize,
    /// Which of the places it begins at.
    from: usize,
    to: Looked<'s>,
}

/// A search under way.
struct Search<'a, 'm, 's> {
    posterior: &'a Posterior<'m>,
    schedule: &'a Schedule,
    /// The highest first, none twice.
    peaks: Vec<Peak>,
    looked: Vec<Looked<'s>>,
}

impl<'a, 'm, 's> Search<'a, 'm, 's> {
    fn new(posterior: &'a Posterior<'m>, schedule: &'a Schedule) -> Self {
        Self { posterior, schedule, peaks: Vec::new(), looked: Vec::new() }
    }

    fn climb_from_starts(
        &mut self,
        space: &SearchSpace,
        seed: Seed,
    ) -> Result<()> {
        let drawn = (0..space.prior_starts)
            .into_par_iter()
            .map(|i| likely(self.posterior, seed.child(i as u64)))
            .collect::<Result<Vec<_>>>()?;
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
        let Some(peak) = climb_unless(self.posterior, start, known)? else {
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
        let grids = space.grids.par_iter().map(|grid| {
            let glanced = glanced(posterior, grid)?;
            match grid.held.len() {
                1 => walked(posterior, glanced, negligible),
                _ => Ok(glanced),
            }
        });
        let found = grids.collect::<Result<Vec<_>>>()?;
        let mut found: Vec<Looked<'s>> = found.into_iter().flatten().collect();
        by_height(&mut found);
        let mut promising = spread(&mut found, self.schedule.promising);
        promising
            .par_iter_mut()
            .try_for_each(|one| one.climb_on(posterior, FEW))?;
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
            next.par_iter_mut().try_for_each(|step| {
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
    ///
    /// A density that bends where recorded times pass the borders of pieces
    /// stops a climb short, and strides along a coordinate pass over that.
    fn profile(&mut self) -> Result<Vec<Component>> {
        let held = self.surveyed();
        let mut met = self.profiled(0, 1, &held)?;
        for _ in 1..HIGHER {
            let Some(higher) = met.higher.take() else { break };
            self.climb(higher.line.as_slice())?;
            met = self.profiled(0, 1, &held)?;
        }
        let mut all = met.components;
        if held.is_empty() {
            let others = self.profiled(1, self.schedule.profiled, &held)?;
            all.extend(others.components);
        }
        Ok(all)
    }

    /// What profiles from the highest peaks meet, of those from one up to
    /// another.
    fn profiled(&self, from: usize, to: usize, held: &[usize]) -> Result<Met> {
        let best = self.peaks.first().map_or(0.0, |peak| peak.height);
        let least = best - self.schedule.profiled_below;
        let high = self.peaks.iter().filter(|peak| peak.height > least);
        let high = high.take(to).skip(from);
        profiles(self.posterior, high, best, held)
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
        match nearest {
            None => Component::of_peak(peak),
            Some(one) => {
                let Looked { grid, spacing, .. } = one;
                Component::within(peak, &grid.held, spacing)
            }
        }
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
const HIGHER: usize = 4;

/// Peaks nearer than this many widths, squared, are one.
const ALIKE: f64 = 1.0;

fn by_height(found: &mut [Looked<'_>]) {
    found.sort_by(|a, b| b.peak.height.total_cmp(&a.peak.height));
}

/// Takes the highest of some places, so many at the most, none next to another
/// of its grid.
fn spread<'s>(found: &mut Vec<Looked<'s>>, most: usize) -> Vec<Looked<'s>> {
    let (mut taken, mut left): (Vec<Looked<'s>>, Vec<Looked<'s>>) =
        (Vec::new(), Vec::new());
    for one in found.drain(..) {
        let full = taken.len() == most;
        if full || taken.iter().any(|other| one.is_next_to(other)) {
            left.push(one);
        } else {
            taken.push(one);
        }
    }
    *found = left;
    taken
}

/// Where one damped step leads from each place of a grid.
fn glanced<'s>(
    posterior: &Posterior<'_>,
    grid: &'s HeldGrid,
) -> Result<Vec<Looked<'s>>> {
    let places = grid.places.par_iter();
    let found = places.map(|place| glance(posterior, grid, place));
    let found = found.collect::<Result<Vec<_>>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// Where places along one coordinate lead when each is come to from the one
/// before, outwards from the highest, until they hold so much less than the
/// best. A force of 4 m/s2 stops a mass whose friction is that of a run without
/// it, and no climb begins there.
fn walked<'s>(
    posterior: &Posterior<'_>,
    mut places: Vec<Looked<'s>>,
    negligible: f64,
) -> Result<Vec<Looked<'s>>> {
    let at = |one: &Looked<'_>| one.peak.line[one.grid.held[0]];
    places.sort_by(|a, b| at(a).total_cmp(&at(b)));
    let height = |one: &Looked<'_>| one.peak.height;
    let highest = places.iter().map(height).enumerate();
    let highest = highest.max_by(|(_, a), (_, b)| a.total_cmp(b));
    let Some((first, mut best)) = highest else { return Ok(places) };
    let ways: [Vec<usize>; 2] =
        [(first + 1..places.len()).collect(), (0..first).rev().collect()];
    for way in ways {
        let mut from = places[first].clone();
        for to in way {
            let by = at(&places[to]) - at(&from);
            let mut next = places[to].clone();
            next.peak = from.peak;
            next.peak.stride(&next.grid.held, 0, by);
            // Where there is no density nothing is climbed.
            next.peak.height = f64::NEG_INFINITY;
            next.climb_on(posterior, STEPS_ASIDE)?;
            if height(&next) > height(&places[to]) {
                places[to] = next;
            }
            from = places[to].clone();
            best = best.max(height(&from));
            if best - height(&from) > negligible {
                break;
            }
        }
    }
    Ok(places)
}

/// Where one damped step leads from a held place; `None` where there is no
/// density.
fn glance<'s>(
    posterior: &Posterior<'_>,
    grid: &'s HeldGrid,
    place: &'s HeldPlace,
) -> Result<Option<Looked<'s>>> {
    let mut line = DVector::from_column_slice(&place.line);
    let landscape = Held { posterior, held: &grid.held };
    let Some(slope) = landscape.slope_at(line.as_slice())? else {
        return Ok(None);
    };
    let mut height = slope.height;
    if let Some(step) = slope.step(&grid.held, DAMPING, LONGEST) {
        let next = &line + step;
        let density = posterior.density(Point::Line(next.as_slice()))?;
        if density.on_line() > height {
            (line, height) = (next, density.on_line());
        }
    }
    let peak = Peak { line, height, precision: slope.precision };
    Ok(Some(Looked::new(grid, place.spacing.clone(), peak)))
}

/// The damping of that step, and how long it is at the most along any axis.
const DAMPING: f64 = 1e-2;
const LONGEST: f64 = 3.0;

impl<'s> Looked<'s> {
    fn new(grid: &'s HeldGrid, spacing: Vec<f64>, peak: Peak) -> Self {
        let log = f64::NEG_INFINITY;
        let mut one = Self { grid, spacing, peak, log, surrounded: false };
        one.weigh();
        one
    }

    /// Says what it holds.
    fn weigh(&mut self) {
        let widths: f64 = self.spacing.iter().map(|x| x.ln()).sum();
        self.log = self
            .component()
            .map_or(f64::NEG_INFINITY, |component| component.log - widths);
    }

    fn component(&self) -> Option<Component> {
        Component::of_place(&self.peak, &self.grid.held, &self.spacing)
    }

    /// How far a place is along what is held, in spacings, squared.
    fn distance(&self, line: &DVector<f64>) -> f64 {
        let held = self.grid.held.iter().zip(&self.spacing);
        let off = |(&i, apart): (&usize, &f64)| {
            (self.peak.line[i] - line[i]) / apart
        };
        held.map(off).map(|x| x * x).sum()
    }

    /// Whether another place with the same coordinates held is within a share
    /// of its spacing.
    fn is_within(&self, other: &Self, share: f64) -> bool {
        let held = self.grid.held.iter().zip(&self.spacing);
        self.grid.held == other.grid.held
            && held.into_iter().all(|(&i, spacing)| {
                (self.peak.line[i] - other.peak.line[i]).abs()
                    < share * spacing
            })
    }

    /// Whether it is within a spacing of another such place.
    fn is_next_to(&self, other: &Self) -> bool {
        self.is_within(other, 1.0)
    }

    /// Whether another place is no narrower and so near that it adds nothing.
    fn covers(&self, other: &Self) -> bool {
        let no_wider = |(own, its): (&f64, &f64)| *own <= 1.5 * its;
        self.spacing.iter().zip(&other.spacing).all(no_wider)
            && self.is_within(other, 0.6)
    }

    /// The steps to the places next to it.
    fn beside(&self, from: usize) -> Vec<Step<'s>> {
        let ways = (0..self.spacing.len()).flat_map(|k| [(k, 1.0), (k, -1.0)]);
        ways.map(|(along, sign)| {
            let mut peak = self.peak.clone();
            let held = &self.grid.held;
            peak.stride(held, along, sign * self.spacing[along]);
            let spacing = self.spacing.clone();
            let (grid, log) = (self.grid, f64::NEG_INFINITY);
            let to = Self { grid, spacing, peak, log, surrounded: false };
            Step { along, from, to }
        })
        .collect()
    }

    /// Climbs so many steps on, with the place held.
    fn climb_on(
        &mut self,
        posterior: &Posterior<'_>,
        steps: usize,
    ) -> Result<()> {
        let (line, held) = (self.peak.line.as_slice(), &self.grid.held[..]);
        if let Some(peak) = climb_holding(posterior, line, held, steps)? {
            self.peak = peak;
            self.weigh();
        }
        Ok(())
    }
}

/// How far below the best, in ln, places are whose neighbours are looked at.
const HOLDS: f64 = 5.0;
/// How many steps aside are taken at once, and the steps of the climb there.
const AT_ONCE: usize = 24;
const STEPS_ASIDE: usize = 3;
/// Changes of what is held, in ln, from one place to the next, below which the
/// next stride is twice as long, and above which half.
const EVEN: f64 = 0.4;
const STEEP: f64 = 1.5;
