//! Forces that a change adds to a friction law: what, and over which stretch.
//!
//! A term is a [`Rate`] times a shape. Its stretch and its shape may have
//! unknown edges, so pieces of the motion are cut at places and times that
//! carry derivatives. A shape that changes steadily is taken at three stages
//! of each leg (`changed`), which is no longer than a part of the run.

use smallvec::SmallVec;

use super::GRAVITY;
use super::friction::Rate;
use crate::block::List;
use crate::scalar::{Kind, Real};

/// Into how many steps of time a run is cut at least for forces that vary with
/// the speed.
pub const STEPS: f64 = 40.0;

/// How many stairs a shape that changes steadily along an axis has: a leg is no
/// longer than that on which it begins. The error falls with their third power:
/// speeds are right to 0.4 mm/s where friction doubles within a fifth of a run
/// (measured in `tests/physics/changed_motion.rs`). A log likelihood of five
/// hundred values of an avalanche changes by 0.06 at the most where they are far
/// shorter (docs/record/speed-tried.md).
const STAIRS: f64 = 40.0;

/// Places \[m\] and times \[s\] nearer than this are the same.
pub(crate) const NEAR: f64 = 1e-9;

/// Along what a force is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Distance along the slope, on the axis that events share \[m\].
    Place,
    /// Time since the release \[s\].
    Time,
    /// Speed \[m/s\].
    Speed,
}

impl Axis {
    /// All of them.
    pub(crate) const ALL: [Self; 3] = [Self::Place, Self::Time, Self::Speed];

    /// Its name in the labels of mechanisms.
    pub fn name(self) -> &'static str {
        match self {
            Self::Place => "distance",
            Self::Time => "time",
            Self::Speed => "speed",
        }
    }

    /// The unit of what is measured along it.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Place => "m",
            Self::Time => "s",
            Self::Speed => "m/s",
        }
    }
}

/// Where a term acts.
#[derive(Debug, Clone, Copy)]
pub enum Stretch<K: Kind> {
    /// Along the whole run.
    Everywhere,
    /// Between two places or two times.
    Between(Axis, [Real<K>; 2]),
}

/// How a term's strength varies where it acts.
#[derive(Debug, Clone)]
pub enum Shape<K: Kind> {
    /// Not at all.
    Even,
    /// As (x - begin)/span: 0 where the run begins, 1 where it ends.
    Linear(Axis, Range),
    /// As 1 - exp(-(x - begin)/scale).
    Saturating(Axis, Range, Real<K>),
    /// As 1 - exp(-u/scale), u the speed.
    WithSpeed(Real<K>),
    /// A value in each of even cells of the range: constant in each along
    /// place and time, and linear between their middles along the speed.
    Cells(Axis, Range, List<Real<K>>),
}

/// A range of places \[m\], times \[s\] or speeds \[m/s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Where it begins.
    pub begin: f64,
    /// How long it is.
    pub span: f64,
}

impl Range {
    /// In which of so many even cells `x` lies, the outer ones beyond.
    fn cell(&self, x: f64, cells: f64) -> f64 {
        let step = self.span / cells;
        ((x + NEAR - self.begin) / step).floor().clamp(0.0, cells - 1.0)
    }

    /// How far along the range `x` is; before it 0, beyond it the whole.
    fn along<K: Kind>(&self, x: Real<K>) -> Real<K> {
        (x - self.begin).max(0.0).min(self.span)
    }

    /// The first border between cells beyond `x`.
    fn border(&self, x: f64, cells: f64) -> Option<f64> {
        let step = self.span / cells;
        let next = if x + NEAR < self.begin {
            0.0
        } else {
            ((x + NEAR - self.begin) / step).floor() + 1.0
        };
        beyond(x, next, cells, |next| self.begin + next * step)
    }

    /// Where the stair is on which `x` lies, counted from 0 and not whole.
    fn stair(&self, x: f64) -> f64 {
        STAIRS * ((x - self.begin) / self.span).max(0.0).sqrt()
    }

    /// The first border between stairs beyond `x`: at squares, so that the
    /// first are the shortest.
    fn next_stair(&self, x: f64) -> Option<f64> {
        let next = self.stair(x + NEAR).floor() + 1.0;
        let at = |next: f64| self.begin + self.span * (next / STAIRS).powi(2);
        beyond(x, next, STAIRS, at)
    }

    /// How long a leg from `x` on may be.
    fn tread(&self, x: f64) -> f64 {
        self.span * (2.0 * self.stair(x) + 1.0) / STAIRS.powi(2)
    }
}

/// Where a border is, or the one behind it where it is not beyond `x`: far from
/// zero round-off is more than `NEAR`.
fn beyond(
    x: f64,
    next: f64,
    last: f64,
    at: impl Fn(f64) -> f64,
) -> Option<f64> {
    let next = if at(next) > x { next } else { next + 1.0 };
    (next <= last).then(|| at(next))
}

/// One force that a change adds.
#[derive(Debug, Clone)]
pub struct Term<K: Kind> {
    /// What resists at full strength.
    pub rate: Rate<K>,
    /// Where.
    pub over: Stretch<K>,
    /// How it varies there.
    pub shape: Shape<K>,
}

/// The state at which forces are asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment<K: Kind> {
    /// Distance on the shared axis [m].
    pub(crate) place: Real<K>,
    /// Time [s].
    pub(crate) time: Real<K>,
    /// Speed [m/s]; looked at by forces that bend.
    pub(crate) speed: Real<K>,
}

impl<K: Kind> Moment<K> {
    fn along(&self, axis: Axis) -> Real<K> {
        match axis {
            Axis::Place => self.place,
            Axis::Time => self.time,
            Axis::Speed => self.speed,
        }
    }
}

impl<K: Kind> Term<K> {
    /// A term that acts everywhere alike.
    pub fn everywhere(rate: Rate<K>) -> Self {
        Self { rate, over: Stretch::Everywhere, shape: Shape::Even }
    }

    /// A rate between two places \[m\] or two times \[s\].
    pub fn between(axis: Axis, edges: [Real<K>; 2], rate: Rate<K>) -> Self {
        let over = Stretch::Between(axis, edges);
        Self { over, ..Self::everywhere(rate) }
    }

    pub(crate) fn acts(&self, at: &Moment<K>) -> bool {
        match self.over {
            Stretch::Everywhere => true,
            Stretch::Between(axis, [from, to]) => {
                let x = at.along(axis).value() + NEAR;
                from.value() <= x && x < to.value()
            }
        }
    }

    pub(crate) fn strength(&self, at: &Moment<K>) -> Real<K> {
        match &self.shape {
            Shape::Even => Real::new(1.0),
            Shape::Linear(axis, range) => {
                range.along(at.along(*axis)) / range.span
            }
            Shape::Saturating(axis, range, scale) => {
                let x = range.along(at.along(*axis));
                1.0 - (-x / *scale).exp()
            }
            Shape::WithSpeed(scale) => 1.0 - (-at.speed / *scale).exp(),
            Shape::Cells(Axis::Speed, range, values) => {
                between_middles(at.speed, range, values)
            }
            Shape::Cells(axis, range, values) => {
                let x = at.along(*axis).value();
                let cell = range.cell(x, values.len() as f64);
                values[cell as usize]
            }
        }
    }

    /// What resists in a state.
    pub(crate) fn rate_at(&self, at: &Moment<K>) -> Rate<K> {
        self.rate.scaled(self.strength(at))
    }

    /// Lets what belongs to moments happen so much sooner [s].
    fn sooner(&mut self, by: f64) {
        if let Stretch::Between(Axis::Time, edges) = &mut self.over {
            edges.iter_mut().for_each(|edge| *edge -= by);
        }
        match &mut self.shape {
            Shape::Linear(Axis::Time, range)
            | Shape::Saturating(Axis::Time, range, _)
            | Shape::Cells(Axis::Time, range, _) => range.begin -= by,
            _ => {}
        }
    }

    /// The first place or time beyond `x` at which the term changes.
    fn next(&self, axis: Axis, x: f64) -> Option<Real<K>> {
        let edge = match self.over {
            Stretch::Between(of, edges) if of == axis => {
                let beyond = |edge: &Real<K>| edge.value() > x + NEAR;
                edges.into_iter().find(beyond).filter(|edge| {
                    // What never ends has no other edge.
                    edge.value().is_finite()
                })
            }
            _ => None,
        };
        let border = match &self.shape {
            Shape::Linear(of, range) | Shape::Saturating(of, range, _)
                if *of == axis =>
            {
                let ends = [range.begin, range.begin + range.span];
                ends.into_iter().find(|end| *end > x + NEAR)
            }
            Shape::Cells(of, range, values) if *of == axis => {
                range.border(x, values.len() as f64)
            }
            _ => None,
        };
        nearer(edge, border.map(Real::new))
    }

    /// Along what it changes steadily, and over which range.
    fn steadily(&self) -> Option<(Axis, &Range)> {
        match &self.shape {
            Shape::Linear(axis, range) | Shape::Saturating(axis, range, _) => {
                Some((*axis, range))
            }
            _ => None,
        }
    }

    /// Whether it varies where nothing cuts the motion.
    pub(crate) fn varies(&self) -> bool {
        let of_speed = matches!(
            self.shape,
            Shape::WithSpeed(_) | Shape::Cells(Axis::Speed, ..)
        );
        of_speed || self.steadily().is_some()
    }

    fn stiffness(&self) -> f64 {
        let Rate { mu, constant, linear, .. } = self.rate;
        let by_shape = match self.shape {
            Shape::WithSpeed(scale) => {
                (mu.value().abs() * GRAVITY + constant.value().abs())
                    / scale.value()
            }
            _ => 0.0,
        };
        linear.value().abs() + by_shape
    }

    /// Whether it varies with the speed in another way than its square.
    fn bends(&self) -> bool {
        let of_speed = matches!(
            self.shape,
            Shape::WithSpeed(_) | Shape::Cells(Axis::Speed, ..)
        );
        let along_speed =
            self.steadily().is_some_and(|(axis, _)| axis == Axis::Speed);
        of_speed || along_speed || !self.rate.linear.is_constantly_zero()
    }
}

/// Linear between the middles of the cells, even beyond the outer ones.
fn between_middles<K: Kind>(
    x: Real<K>,
    range: &Range,
    values: &[Real<K>],
) -> Real<K> {
    let last = values.len() - 1;
    let position =
        (x - range.begin) * (values.len() as f64 / range.span) - 0.5;
    if position <= 0.0 {
        return values[0];
    }
    let cell = position.value() as usize;
    if cell >= last {
        return values[last];
    }
    values[cell] + (values[cell + 1] - values[cell]) * (position - cell as f64)
}

pub(super) fn nearer<K: Kind>(
    a: Option<Real<K>>,
    b: Option<Real<K>>,
) -> Option<Real<K>> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b < a { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// All the forces that a change adds, and how it tilts the ground.
#[derive(Debug, Clone)]
pub struct Forces<K: Kind> {
    /// The terms, which add up.
    pub terms: SmallVec<[Term<K>; 2]>,
    /// By how much the ground is steeper than the track says \[radians\].
    pub tilt: Real<K>,
    /// After what time \[s\] at most a force that varies with the speed is
    /// asked for again.
    pub step: f64,
}

impl<K: Kind> Default for Forces<K> {
    fn default() -> Self {
        Self {
            terms: SmallVec::new(),
            tilt: Real::new(0.0),
            step: f64::INFINITY,
        }
    }
}

impl<K: Kind> Forces<K> {
    /// Whether they change nothing.
    pub fn is_none(&self) -> bool {
        self.terms.is_empty() && self.tilt.is_constantly_zero()
    }

    /// The same so much sooner \[s\].
    pub(crate) fn sooner(mut self, by: f64) -> Self {
        self.terms.iter_mut().for_each(|term| term.sooner(by));
        self
    }

    pub(crate) fn bends(&self) -> bool {
        self.terms.iter().any(Term::bends)
    }

    /// About how much more they brake a mass the faster it is, at the most
    /// \[1/s\], beside what grows with the square of the speed.
    pub(crate) fn stiffness(&self) -> f64 {
        self.terms.iter().map(Term::stiffness).sum()
    }

    /// What the terms that do not vary add at a moment.
    pub(crate) fn even(&self, at: &Moment<K>) -> Rate<K> {
        let terms = self.terms.iter().filter(|term| !term.varies());
        let acting = terms.filter(|term| term.acts(at));
        acting.fold(Rate::default(), |sum, term| sum + term.rate_at(at))
    }

    /// The terms that vary where nothing cuts the motion.
    #[inline]
    pub(crate) fn varying(&self) -> impl Iterator<Item = &Term<K>> {
        self.terms.iter().filter(|term| term.varies())
    }

    /// Those of them that act from a moment on.
    #[inline]
    pub(crate) fn varying_from(
        &self,
        from: &Moment<K>,
    ) -> impl Iterator<Item = &Term<K>> {
        self.varying().filter(|term| term.acts(from))
    }

    /// How long a leg from `x` may be at most, for the shapes that change
    /// steadily there \[m or s\].
    pub(crate) fn longest(&self, axis: Axis, x: f64) -> f64 {
        self.steady(axis)
            .filter(|range| x + NEAR < range.begin + range.span)
            .map(|range| range.tread(x))
            .fold(f64::INFINITY, f64::min)
    }

    /// Where one that is longer ends: at a place or a time that does not
    /// depend on any parameter, so that derivatives are exact.
    pub(crate) fn stair(&self, axis: Axis, x: f64) -> f64 {
        self.steady(axis)
            .filter_map(|range| range.next_stair(x))
            .fold(f64::INFINITY, f64::min)
    }

    /// The ranges over which shapes change steadily.
    fn steady(&self, axis: Axis) -> impl Iterator<Item = &Range> {
        let all = self.terms.iter().filter_map(Term::steadily);
        all.filter(move |(of, _)| *of == axis).map(|(_, range)| range)
    }

    /// The first place or time beyond `x` at which a term changes.
    pub(crate) fn next(&self, axis: Axis, x: f64) -> Option<Real<K>> {
        self.terms
            .iter()
            .fold(None, |next, term| nearer(next, term.next(axis, x)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_border_is_beyond_however_far_from_zero() {
        for begin in [0.0, 1e3, 2e7, 5e7] {
            let range = Range { begin, span: 700.0 };
            let walks = |next: &dyn Fn(f64) -> Option<f64>| {
                let (mut at, mut count) = (begin, 0);
                while let Some(next) = next(at) {
                    assert!(next > at, "{begin}: {next}");
                    (at, count) = (next, count + 1);
                }
                count
            };
            assert_eq!(walks(&|x| range.next_stair(x)), STAIRS as usize);
            assert_eq!(walks(&|x| range.border(x, 24.0)), 24);
        }
    }
}
