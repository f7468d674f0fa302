//! Climbing to a peak with the Fisher information.
//!
//! Levenberg and Marquardt's method: each step solves
//! (P + lambda diag P) step = gradient, with P about minus the Hessian from
//! first derivatives. It needs a dozen steps where a quasi-Newton method
//! needs a hundred, because a recording is nearly a least-squares problem.

use nalgebra::{DMatrix, DVector};

use crate::error::Result;
use crate::model::{Information, Point, Posterior};

/// A log density about a place, to second order.
#[derive(Debug, Clone)]
pub(crate) struct Slope {
    pub(crate) height: f64,
    pub(crate) gradient: DVector<f64>,
    /// About minus the Hessian.
    pub(crate) precision: DMatrix<f64>,
}

impl Slope {
    fn is_usable(&self) -> bool {
        self.height.is_finite()
            && self.gradient.iter().all(|g| g.is_finite())
            && self.precision.iter().all(|p| p.is_finite())
    }

    /// The step that solves (P + lambda diag P) step = gradient without the
    /// coordinates that are held, no longer than `longest` along any axis;
    /// `None` where the matrix is not positive definite.
    pub(crate) fn step(
        &self,
        held: &[usize],
        lambda: f64,
        longest: f64,
    ) -> Option<DVector<f64>> {
        let mut damped = self.precision.clone();
        let mut pull = self.gradient.clone();
        for i in 0..pull.len() {
            damped[(i, i)] += lambda * damped[(i, i)] + 1e-6;
        }
        for &i in held {
            damped.row_mut(i).fill(0.0);
            damped.column_mut(i).fill(0.0);
            (damped[(i, i)], pull[i]) = (1.0, 0.0);
        }
        let mut step = damped.cholesky()?.solve(&pull);
        step *= (longest / step.amax()).min(1.0);
        Some(step)
    }

    /// The height that a step leads to, to second order.
    pub(crate) fn after(&self, step: &DVector<f64>) -> f64 {
        let bend = step.dot(&(&self.precision * step));
        self.height + self.gradient.dot(step) - 0.5 * bend
    }
}

/// What can be climbed.
pub(crate) trait Landscape {
    /// What a place is known by besides its coordinates, to begin the next
    /// look from.
    type Trace;

    /// The coordinates along which it is not climbed.
    fn held(&self) -> &[usize];

    /// The slope at a place that was come to from another; `None` where there
    /// is no density.
    fn slope(
        &self,
        at: &DVector<f64>,
        from: &Self::Trace,
    ) -> Result<Option<(Slope, Self::Trace)>>;

    /// Whether a place can be higher than so much, where that is told at less
    /// cost than its slope.
    fn can_exceed(&self, _at: &DVector<f64>, _height: f64) -> Result<bool> {
        Ok(true)
    }
}

/// A posterior on the real line, some coordinates held.
pub(crate) struct Held<'a, 'm> {
    pub(crate) posterior: &'a Posterior<'m>,
    pub(crate) held: &'a [usize],
    /// The others as directions, where the slope along what is held is not
    /// asked for: few of them cost less.
    pub(crate) free: Option<&'a DMatrix<f64>>,
}

impl<'a, 'm> Held<'a, 'm> {
    /// With the slope along all coordinates.
    pub(crate) fn new(
        posterior: &'a Posterior<'m>,
        held: &'a [usize],
    ) -> Self {
        Self { posterior, held, free: None }
    }

    /// The slope at a place; `None` where there is no density.
    pub(crate) fn slope_at(&self, at: &[f64]) -> Result<Option<Slope>> {
        let about = match self.free {
            None => self.posterior.information(at)?,
            Some(free) => self.along(at, free)?,
        };
        let slope = Slope {
            height: about.density.on_line(),
            gradient: about.gradient,
            precision: about.precision,
        };
        Ok(slope.is_usable().then_some(slope))
    }

    /// The information along the free coordinates, zero along the others.
    fn along(&self, at: &[f64], free: &DMatrix<f64>) -> Result<Information> {
        let is_free = |i: &usize| !self.held.contains(i);
        let places: Vec<usize> = (0..at.len()).filter(is_free).collect();
        let found = self.posterior.information_along(at, free)?;
        let mut all = Information::zero(at.len());
        all.add(&found, &places, 1.0);
        Ok(all)
    }
}

impl Landscape for Held<'_, '_> {
    type Trace = ();

    fn held(&self) -> &[usize] {
        self.held
    }

    fn slope(
        &self,
        at: &DVector<f64>,
        (): &(),
    ) -> Result<Option<(Slope, ())>> {
        Ok(self.slope_at(at.as_slice())?.map(|slope| (slope, ())))
    }

    fn can_exceed(&self, at: &DVector<f64>, height: f64) -> Result<bool> {
        let density = self.posterior.density(Point::Line(at.as_slice()))?;
        Ok(density.on_line() > height)
    }
}

/// When a climb ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Climb {
    /// The most steps.
    pub(crate) steps: usize,
    /// The longest step along one axis.
    pub(crate) longest: f64,
    /// A gain of the log density by one step, below which a climb ends: what is
    /// a fiftieth higher is drawn from, and weighed, alike.
    pub(crate) arrived: f64,
    /// How often it may leap where a step had to be short.
    pub(crate) leaps: usize,
}

impl Default for Climb {
    fn default() -> Self {
        Self { steps: 60, longest: 2.0, arrived: 0.02, leaps: 4 }
    }
}

/// How far a coordinate follows another at the most.
const FAR: f64 = 2.0;

/// A place with its slope and trace.
type Place<L> = (DVector<f64>, Slope, <L as Landscape>::Trace);

/// The damping of a free step.
const FREE: f64 = 1e-2;

/// How many steps that climb follow a leap.
const LANDING: usize = 3;

/// Damping up to which a step is nearly a free one.
const UNDAMPED: f64 = 0.1;

/// By what damping is multiplied after a step that climbs.
const EASED: f64 = 0.2;

/// Damping after a step that does not climb: more than a free one's.
fn braked(lambda: f64) -> f64 {
    (5.0 * lambda).max(5.0 * FREE)
}

/// How often a step is shortened before a climb gives up.
const TRIES: usize = 6;

impl Climb {
    /// The place that a start leads to, with its slope and trace; `None` where
    /// `ends_at` says on the way that it leads nowhere new.
    pub(crate) fn ascend<L: Landscape>(
        &self,
        landscape: &L,
        start: Place<L>,
        ends_at: impl Fn(&DVector<f64>, f64) -> bool,
    ) -> Result<Option<Place<L>>> {
        let (mut line, mut slope, mut trace) = start;
        let (mut lambda, mut leaps) = (FREE, 0);
        for _ in 0..self.steps {
            let here = (&line, &slope, &trace);
            let next = self.step(landscape, here, &mut lambda)?;
            let gain = next.as_ref().map(|next| next.1.height - slope.height);
            let ends = gain.is_none_or(|gain| gain <= self.arrived);
            // A step that gains little, hardly damped, is near a peak; one
            // that had to be short may be before a kink.
            let was_short = lambda > EASED * UNDAMPED;
            let mut leapt = None;
            if ends && was_short && leaps < self.leaps {
                (leaps, lambda) = (leaps + 1, FREE);
                leapt = self.leap(landscape, here)?;
            }
            let ends = ends && leapt.is_none();
            let Some(next) = leapt.or(next) else { break };
            (line, slope, trace) = next;
            if ends_at(&line, slope.height) {
                return Ok(None);
            }
            if ends {
                break;
            }
        }
        Ok(Some((line, slope, trace)))
    }

    /// Where a free step and a few that climb lead, if that is higher: over a
    /// kink of the density, before which every step that climbs is short. Not
    /// climbed where the slope there promises nothing higher.
    fn leap<L: Landscape>(
        &self,
        landscape: &L,
        (line, slope, trace): (&DVector<f64>, &Slope, &L::Trace),
    ) -> Result<Option<Place<L>>> {
        let free = slope.step(landscape.held(), FREE, self.longest);
        let Some(off) =
            free.filter(|off| slope.after(off) - slope.height > self.arrived)
        else {
            return Ok(None);
        };
        let next = line + &off;
        let promises = |there: &Slope| {
            let free = there.step(landscape.held(), FREE, self.longest);
            let most = free.map_or(there.height, |off| there.after(&off));
            most - slope.height > self.arrived
        };
        let landed = landscape.slope(&next, trace)?;
        let Some((found, other)) = landed.filter(|(s, _)| promises(s)) else {
            return Ok(None);
        };
        let (mut at, mut lambda) = ((next, found, other), FREE);
        for _ in 0..LANDING {
            let here = (&at.0, &at.1, &at.2);
            match self.step(landscape, here, &mut lambda)? {
                Some(next) => at = next,
                None => break,
            }
        }
        let higher = at.1.height - slope.height > self.arrived;
        Ok(higher.then_some(at))
    }

    /// A step that climbs, with ever more damping until one does; `None` where
    /// there is nothing to gain.
    fn step<L: Landscape>(
        &self,
        landscape: &L,
        (line, slope, trace): (&DVector<f64>, &Slope, &L::Trace),
        lambda: &mut f64,
    ) -> Result<Option<Place<L>>> {
        for tried in 0..TRIES {
            let Some(off) =
                slope.step(landscape.held(), *lambda, self.longest)
            else {
                *lambda = braked(*lambda);
                continue;
            };
            let promised = slope.after(&off) - slope.height;
            if promised < self.arrived {
                return Ok(None);
            }
            let next = line + &off;
            // Of first tries seven in ten climb, of later ones three: a slope
            // costs three to five densities.
            if (tried == 0 || landscape.can_exceed(&next, slope.height)?)
                && let Some((found, trace)) = landscape.slope(&next, trace)?
                && found.height > slope.height
            {
                *lambda = (*lambda * EASED).max(1e-9);
                return Ok(Some((next, found, trace)));
            }
            *lambda = braked(*lambda);
        }
        Ok(None)
    }
}

/// A peak of the density on the real line, with its normal approximation.
#[derive(Debug, Clone)]
pub struct Peak {
    /// Where it is, on the real line.
    pub line: DVector<f64>,
    /// The log density there, as one on the real line.
    pub height: f64,
    /// About minus the Hessian there.
    pub precision: DMatrix<f64>,
}

impl Peak {
    /// Where a climb ended.
    pub(crate) fn of<T>((line, slope, _): (DVector<f64>, Slope, T)) -> Self {
        let Slope { height, precision, .. } = slope;
        Self { line, height, precision }
    }

    /// The log of what the normal approximation integrates to (Laplace);
    /// `None` where the precision is not positive definite.
    pub fn log_evidence(&self) -> Option<f64> {
        let factor = self.precision.clone().cholesky()?;
        let log_det = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
        let n = self.line.len() as f64;
        Some(
            self.height + 0.5 * n * std::f64::consts::TAU.ln() - 0.5 * log_det,
        )
    }

    /// Goes along one of the coordinates that are held; those not held follow
    /// as in the normal approximation. There is no height until it is climbed
    /// from.
    pub(super) fn stride(&mut self, held: &[usize], along: usize, by: f64) {
        let (n, along) = (self.line.len(), held[along]);
        self.line[along] += by;
        self.height = f64::NEG_INFINITY;
        let free: Vec<usize> = (0..n).filter(|i| !held.contains(i)).collect();
        let rows = self.precision.select_rows(&free);
        let across = rows.column(along) * by;
        let inner = rows.select_columns(&free).cholesky();
        let Some(follows) = inner.map(|inner| inner.solve(&across)) else {
            return;
        };
        for (&i, by) in free.iter().zip(follows.iter()) {
            self.line[i] -= by.clamp(-FAR, FAR);
        }
    }

    /// The squared distance of a place, in units of the peak's width.
    pub fn distance(&self, line: &DVector<f64>) -> f64 {
        let off = line - &self.line;
        off.dot(&(&self.precision * &off))
    }
}

/// The peak that a start leads to; `None` where the start has no density.
///
/// # Errors
/// What no other parameter values would mend.
pub fn climb(
    posterior: &Posterior<'_>,
    start: &[f64],
) -> Result<Option<Peak>> {
    let landscape = Held::new(posterior, &[]);
    Climb::default().from(&landscape, start, |_, _| false)
}

impl Climb {
    /// The peak that a start leads to, some coordinates held; `None` where the
    /// start has no density, or where the climb comes to a place and height of
    /// which `ends_at` says that it leads nowhere new.
    pub(super) fn from(
        &self,
        landscape: &Held<'_, '_>,
        start: &[f64],
        ends_at: impl Fn(&DVector<f64>, f64) -> bool,
    ) -> Result<Option<Peak>> {
        let Some(slope) = landscape.slope_at(start)? else { return Ok(None) };
        let start = (DVector::from_column_slice(start), slope, ());
        let found = self.ascend(landscape, start, ends_at)?;
        Ok(found.map(Peak::of))
    }
}

/// The best place near a start among those that share some coordinates with
/// it.
pub(super) fn climb_holding(
    landscape: &Held<'_, '_>,
    start: &[f64],
    steps: usize,
) -> Result<Option<Peak>> {
    let climb = Climb { steps, leaps: 0, ..Climb::default() };
    climb.from(landscape, start, |_, _| false)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::infer::fixture::Hills;
    use crate::model::unit_directions;

    /// A ridge that is highest at its bend, 0, where its slope promises more.
    #[derive(Default)]
    struct Bend {
        slopes: Cell<usize>,
        heights: Cell<usize>,
    }

    impl Landscape for Bend {
        type Trace = ();

        fn held(&self) -> &[usize] {
            &[]
        }

        fn slope(
            &self,
            at: &DVector<f64>,
            (): &(),
        ) -> Result<Option<(Slope, ())>> {
            self.slopes.set(self.slopes.get() + 1);
            let slope = Slope {
                height: -at[0].abs(),
                gradient: DVector::from_element(1, 1.0),
                precision: DMatrix::identity(1, 1),
            };
            Ok(Some((slope, ())))
        }

        fn can_exceed(&self, at: &DVector<f64>, height: f64) -> Result<bool> {
            self.heights.set(self.heights.get() + 1);
            Ok(-at[0].abs() > height)
        }
    }

    #[test]
    fn a_step_tried_again_costs_a_height_where_it_falls() {
        let (bend, start) = (Bend::default(), DVector::zeros(1));
        let (slope, ()) = bend.slope(&start, &()).unwrap().unwrap();
        let climb = Climb { leaps: 0, ..Climb::default() };
        let top =
            climb.ascend(&bend, (start, slope, ()), |_, _| false).unwrap();
        assert_eq!(top.unwrap().0[0], 0.0);
        // At the start, and of the first try; a height of each other.
        assert_eq!((bend.slopes.get(), bend.heights.get()), (2, TRIES - 1));
    }

    #[test]
    fn what_is_held_need_not_be_derived_along() {
        let posterior = Posterior::new(&Hills).unwrap();
        let (held, start) = ([1], [0.6, 1.5]);
        let free = unit_directions(&[0], 2);
        let top = |free| {
            let landscape = Held { free, ..Held::new(&posterior, &held) };
            climb_holding(&landscape, &start, 60).unwrap().unwrap()
        };
        let (all, few) = (top(None), top(Some(&free)));
        assert_eq!((&few.line, few.height), (&all.line, all.height));
        assert_eq!(few.line[1], 1.5);
        assert_eq!(few.precision[(0, 0)], all.precision[(0, 0)]);
        // Where x^2 is nearly 1; the prior has its peak there too.
        assert!((few.line[0] - 1.0).abs() < 0.01, "{}", few.line[0]);
    }

    #[test]
    fn what_is_not_held_follows_as_in_the_normal_approximation() {
        let rows = [4.0, 1.0, 0.5, 1.0, 3.0, -0.7, 0.5, -0.7, 2.0];
        let precision = DMatrix::from_row_slice(3, 3, &rows);
        let covariance = precision.clone().try_inverse().unwrap();
        let line = DVector::from_vec(vec![0.2, -0.4, 1.0]);
        let peak = Peak { line, height: 0.0, precision };

        // One held: means given its value, by the covariance.
        let mut moved = peak.clone();
        moved.stride(&[1], 0, 0.3);
        for i in 0..3 {
            let slope = covariance[(i, 1)] / covariance[(1, 1)];
            let expected = peak.line[i] + 0.3 * slope;
            assert!((moved.line[i] - expected).abs() < 1e-12, "{i}");
        }

        // Two held: one goes along, the other stays.
        let mut moved = peak.clone();
        moved.stride(&[0, 2], 1, 0.3);
        assert_eq!(moved.line[0], peak.line[0]);
        assert_eq!(moved.line[2], peak.line[2] + 0.3);
        let expected = peak.line[1] + 0.3 * 0.7 / 3.0;
        assert!((moved.line[1] - expected).abs() < 1e-12);
    }
}
