//! What a change from outside makes of a model: its motion, its start, its
//! measurement.
//!
//! A [`Change`] is a plain struct of amounts that add up, and 0 everywhere
//! changes nothing. It rides on every declared block, so that no law, no
//! reading and no noise of a model escapes it.

use super::Extent;
use crate::physics::Forces;
use crate::physics::forces::{STEPS, Term};
use crate::scalar::{Kind, Real};

/// A change of a model.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Change<K: Kind> {
    /// Forces added to the friction law, and the tilt of the ground.
    pub forces: Forces<K>,
    /// Added to the speed at t = 0 \[m/s\].
    pub start_speed: Real<K>,
    /// Added to the place of the release \[m\].
    pub start_place: Real<K>,
    /// By how much the recording's clock is ahead of the motion's \[s\].
    pub clock: Real<K>,
    /// Over how many last seconds a value is really the mean \[s\].
    pub window: Real<K>,
    /// Whether a window that reaches before the release begins there, instead
    /// of counting the mass at rest before it.
    pub window_begins: bool,
    /// The sensor's scale, minus 1.
    pub scale: Real<K>,
    /// What the sensor adds per second \[recorded unit/s\].
    pub drift: Real<K>,
    /// The share of a series' values that is known; those after them are
    /// not scored.
    pub known: Option<f64>,
    /// What is changed of each of several events besides; empty where all
    /// are changed alike.
    pub own: Vec<Self>,
}

impl<K: Kind> Default for Change<K> {
    fn default() -> Self {
        let zero = Real::new(0.0);
        Self {
            forces: Forces::default(),
            start_speed: zero,
            start_place: zero,
            clock: zero,
            window: zero,
            window_begins: true,
            scale: zero,
            drift: zero,
            known: None,
            own: Vec::new(),
        }
    }
}

impl<K: Kind> Change<K> {
    /// One force more on the mass, over a run of this extent.
    pub fn force(extent: &Extent, term: Term<K>) -> Self {
        let mut change = Self::default();
        change.forces.terms.push(term);
        change.forces.step = extent.duration / STEPS;
        change
    }

    /// Whether the motion, or when it is looked at, is changed.
    pub fn moves(&self) -> bool {
        let amounts =
            [self.start_speed, self.start_place, self.clock, self.window];
        !self.forces.is_none()
            || amounts.iter().any(|x| !x.is_constantly_zero())
    }

    /// Whether the reading of the motion is changed.
    pub fn reads(&self) -> bool {
        !(self.scale.is_constantly_zero() && self.drift.is_constantly_zero())
    }

    /// What the sensor shows of a predicted value.
    pub fn read(&self, time: f64, predicted: Real<K>) -> Real<K> {
        predicted * (self.scale + 1.0) + self.drift * time
    }

    /// Both changes at once.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let mut both = self.clone();
        both.forces.terms.extend(other.forces.terms.iter().cloned());
        both.forces.tilt += other.forces.tilt;
        both.forces.step = both.forces.step.min(other.forces.step);
        both.start_speed += other.start_speed;
        both.start_place += other.start_place;
        both.known = both.known.or(other.known);
        both.clock += other.clock;
        both.window += other.window;
        both.window_begins &= other.window_begins;
        both.scale += other.scale;
        both.drift += other.drift;
        let also = both.own.iter_mut().zip(&other.own);
        also.for_each(|(mine, theirs)| *mine = mine.and(theirs));
        let further = other.own.iter().skip(both.own.len()).cloned();
        both.own.extend(further);
        both
    }

    /// What is changed of one of several events: what is of all, and its own.
    #[must_use]
    pub fn of_event(&self, index: usize) -> Self {
        let all = Self { own: Vec::new(), ..self.clone() };
        match self.own.get(index) {
            Some(own) => all.and(own),
            None => all,
        }
    }
}
