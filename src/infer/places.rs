//! Places along some coordinates of a posterior, which are held there: what
//! all other coordinates come to, and what each place holds.
//!
//! Along coordinates that may have many modes, or none, a search does not
//! climb. It looks at places, and goes on from those that hold most.

use nalgebra::DVector;

use super::climb::{Held, Peak, climb_holding};
use super::proposal::Component;
use crate::error::Result;
use crate::model::{Point, Posterior};
use crate::parallel;

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

/// A held place with where the other coordinates come to.
#[derive(Clone)]
pub(super) struct Looked<'s> {
    pub(super) grid: &'s HeldGrid,
    pub(super) spacing: Vec<f64>,
    pub(super) peak: Peak,
    /// About what all other coordinates hold there, in ln.
    pub(super) log: f64,
    /// Whether those next to it were looked at.
    pub(super) surrounded: bool,
}

/// A step from a place to one next to it.
pub(super) struct Step<'s> {
    /// Which of the coordinates that are held.
    pub(super) along: usize,
    /// Which of the places it begins at.
    pub(super) from: usize,
    pub(super) to: Looked<'s>,
}

pub(super) fn by_height(found: &mut [Looked<'_>]) {
    found.sort_by(|a, b| b.peak.height.total_cmp(&a.peak.height));
}

/// Takes the highest of some places, so many at the most, none next to another
/// of its grid.
pub(super) fn spread<'s>(
    found: &mut Vec<Looked<'s>>,
    most: usize,
) -> Vec<Looked<'s>> {
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
pub(super) fn glanced<'s>(
    posterior: &Posterior<'_>,
    grid: &'s HeldGrid,
) -> Result<Vec<Looked<'s>>> {
    let glance = |place| glance(posterior, grid, place);
    let found = parallel::try_map(&grid.places, glance)?;
    Ok(found.into_iter().flatten().collect())
}

/// Where places along one coordinate lead when each is come to from the one
/// before, outwards from the highest, until they hold so much less than the
/// best. A force of 4 m/s2 stops a mass whose friction is that of a run without
/// it, and no climb begins there.
pub(super) fn walked<'s>(
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
    let landscape = Held::new(posterior, &grid.held);
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

    pub(super) fn component(&self) -> Option<Component> {
        Component::of_place(&self.peak, &self.grid.held, &self.spacing)
    }

    /// How far a place is along what is held, in spacings, squared.
    pub(super) fn distance(&self, line: &DVector<f64>) -> f64 {
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
    pub(super) fn covers(&self, other: &Self) -> bool {
        let no_wider = |(own, its): (&f64, &f64)| *own <= 1.5 * its;
        self.spacing.iter().zip(&other.spacing).all(no_wider)
            && self.is_within(other, 0.6)
    }

    /// The steps to the places next to it.
    pub(super) fn beside(&self, from: usize) -> Vec<Step<'s>> {
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
    pub(super) fn climb_on(
        &mut self,
        posterior: &Posterior<'_>,
        steps: usize,
    ) -> Result<()> {
        let landscape = Held::new(posterior, &self.grid.held);
        let line = self.peak.line.as_slice();
        if let Some(peak) = climb_holding(&landscape, line, steps)? {
            self.peak = peak;
            self.weigh();
        }
        Ok(())
    }
}

/// The steps of a climb after a step aside.
pub(super) const STEPS_ASIDE: usize = 3;
