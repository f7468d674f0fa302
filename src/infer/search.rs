//! Searching a posterior for where it lies: the first of the five steps of the
//! Laplace mixture.
//!
//! Climbs start from given places and from likely draws of the prior. Along
//! coordinates that may have many modes, or none, places are held: one damped
//! step of all other coordinates says what each promises. The promising ones
//! are climbed further, and the best of those with all coordinates. Profiles along every coordinate tell where the
//! highest peaks are not as their curvature says.

use nalgebra::DVector;
use rayon::prelude::*;

use super::climb::{Held, Peak, climb_holding, climb_unless};
use super::profile::profiles;
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
const FEW: usize = 6;

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
    search.look(space)?;
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
struct Looked<'s> {
    grid: &'s HeldGrid,
    place: &'s HeldPlace,
    peak: Peak,
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
    /// place held, and from the best with all coordinates.
    fn look(&mut self, space: &'s SearchSpace) -> Result<()> {
        let places = space.grids.iter().flat_map(|grid| {
            grid.places.iter().map(move |place| (grid, place))
        });
        let places: Vec<_> = places.collect();
        let posterior = self.posterior;
        let found = places
            .into_par_iter()
            .map(|(grid, place)| glance(posterior, grid, place))
            .collect::<Result<Vec<_>>>()?;
        let mut found: Vec<Looked<'s>> = found.into_iter().flatten().collect();
        by_height(&mut found);
        let mut promising = spread(&mut found, self.schedule.promising);
        promising
            .par_iter_mut()
            .try_for_each(|one| one.climb_on(posterior))?;
        by_height(&mut promising);
        let most = (places_of(space) / 4).max(LEAST_CLIMBED);
        let best = promising.iter().take(most.min(self.schedule.climbed));
        let best: Vec<_> = best.map(|one| one.peak.line.clone()).collect();
        for start in best {
            self.climb(start.as_slice())?;
        }
        self.looked.extend(promising);
        self.looked.extend(found);
        Ok(())
    }

    /// Profiles from the highest peaks; where these lead higher, from there.
    ///
    /// A density that bends where recorded times pass the borders of pieces
    /// stops a climb short, and strides along a coordinate pass over that.
    fn profile(&mut self) -> Result<Vec<Component>> {
        let alone = Schedule { profiled: 1, ..*self.schedule };
        for _ in 0..HIGHER {
            let met = profiles(self.posterior, &self.peaks, &alone)?;
            match met.higher {
                Some(higher) => self.climb(higher.line.as_slice())?,
                None if self.schedule.profiled == 1 => {
                    return Ok(met.components);
                }
                None => break,
            }
        }
        let met = profiles(self.posterior, &self.peaks, self.schedule)?;
        Ok(met.components)
    }

    fn components(mut self) -> Result<Vec<Component>> {
        let profiles = self.profile()?;
        let of_peaks = self.peaks.iter().filter_map(Component::of_peak);
        let of_places = self.looked.iter().filter_map(|one| {
            Component::of_place(&one.peak, &one.grid.held, &one.place.spacing)
        });
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
const LEAST_CLIMBED: usize = 16;

/// How many places are held.
fn places_of(space: &SearchSpace) -> usize {
    space.grids.iter().map(|grid| grid.places.len()).sum()
}

/// How often profiles may lead higher.
const HIGHER: usize = 8;

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
    Ok(Some(Looked { grid, place, peak }))
}

/// The damping of that step, and how long it is at the most along any axis.
const DAMPING: f64 = 1e-2;
const LONGEST: f64 = 3.0;

impl Looked<'_> {
    /// Whether it is within a spacing of another place of its grid.
    fn is_next_to(&self, other: &Self) -> bool {
        let held = self.grid.held.iter().zip(&self.place.spacing);
        std::ptr::eq(self.grid, other.grid)
            && held.into_iter().all(|(&i, spacing)| {
                (self.place.line[i] - other.place.line[i]).abs() < *spacing
            })
    }

    fn climb_on(&mut self, posterior: &Posterior<'_>) -> Result<()> {
        let (line, held) = (self.peak.line.as_slice(), &self.grid.held[..]);
        if let Some(peak) = climb_holding(posterior, line, held, FEW)? {
            self.peak = peak;
        }
        Ok(())
    }
}
