//! What the challenge hides, one effect a file.
//!
//! An effect changes the force, the start, what the event's file says, or
//! what is read off the motion. Size zero gives the baseline back. The ranges
//! are what the question is asked with, not what the answer is good at.

mod ar1;
mod averaging_window;
mod clock_offset;
mod cohesion;
mod cubic_drag;
mod curvature;
mod entrainment;
mod friction_hardening;
mod friction_patch;
mod friction_step;
mod heavy_tails;
mod initial_velocity;
mod late_friction;
mod none;
mod periodic_force;
mod release_position;
mod sensor_drift;
mod slope_bias;
mod surge;
mod turbulent_drag;
mod unequal_variance;
mod velocity_scale;
mod velocity_weakening;
mod viscous_drag;
mod wall_drag;

use std::f64::consts::TAU;
use std::fmt::Debug;

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::ground::Ground;
use super::moments::{Moment, Run, Start};
use crate::seed::Rng;

pub(super) use none::Nothing;

/// The effects that a diagnosis has in its catalogue.
pub(super) const CATALOGUE: [&Kind; 20] = [
    &turbulent_drag::KIND,
    &viscous_drag::KIND,
    &cohesion::KIND,
    &velocity_weakening::KIND,
    &curvature::KIND,
    &friction_patch::KIND,
    &friction_step::KIND,
    &friction_hardening::KIND,
    &entrainment::KIND,
    &surge::KIND,
    &initial_velocity::KIND,
    &release_position::KIND,
    &clock_offset::KIND,
    &velocity_scale::KIND,
    &sensor_drift::KIND,
    &averaging_window::KIND,
    &slope_bias::KIND,
    &ar1::KIND,
    &heavy_tails::KIND,
    &unequal_variance::KIND,
];

/// Effects that no catalogue has.
pub(super) const OUTSIDE: [&Kind; 4] = [
    &cubic_drag::KIND,
    &periodic_force::KIND,
    &late_friction::KIND,
    &wall_drag::KIND,
];

/// Nothing hidden.
pub(super) const NONE: &Kind = &none::KIND;

/// What an effect belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// Nothing is hidden.
    None,
    /// A force that the baseline lacks.
    Physics,
    /// The mass started otherwise than the event's file says.
    Start,
    /// The values, their times or the track are off.
    Measurement,
    /// The values scatter otherwise than by independent normal errors.
    Errors,
    /// A force that is not in the catalogue.
    Outside,
}

/// Which tracks hide an effect entirely.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Void {
    /// None.
    Never,
    /// A constant slope, on which it changes nothing at all.
    OnIncline,
    /// All but those with bends: on a smooth track the load that a bend adds
    /// is less than a hundredth of the weight.
    WithoutBends,
    /// A constant slope under Coulomb friction, where it is the same as
    /// another mu in every value: nobody could find it.
    OnInclineUnderCoulomb,
}

/// A kind of effect and the sizes that it is drawn with.
#[derive(Debug)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) class: Class,
    /// Least and greatest absolute size.
    pub(super) range: (f64, f64),
    /// Whether sizes have either sign.
    pub(super) signed: bool,
    /// The unit of the size; `1` for a number without one.
    pub(super) unit: &'static str,
    /// Whether it needs a baseline without a drag of its own.
    pub(super) coulomb_only: bool,
    pub(super) void: Void,
    /// The effect in a scene; nothing where there is no room for it.
    pub(super) make: fn(&Scene<'_>, &mut Rng) -> Option<Box<dyn Effect>>,
}

impl Kind {
    /// A size from its range, and a sign where it has one.
    pub(super) fn size(&self, rng: &mut Rng) -> f64 {
        let (low, high) = self.range;
        let size = low + (high - low) * rng.random_range(0.0..=1.0);
        let back = rng.random_bool(0.5);
        if self.signed && back { -size } else { size }
    }
}

/// What an effect is fitted into: the run as it is without it or, once that
/// is known, with it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scene<'a> {
    /// The effect's size, in its kind's unit.
    pub(super) size: f64,
    /// Another size, for what each recording has of its own.
    pub(super) other: f64,
    pub(super) ground: &'a Ground,
    /// The upper quartile of the speeds \[m/s\].
    pub(super) upper: f64,
    /// Where the first mass starts \[m\].
    pub(super) top: f64,
    /// Where the last mass starts \[m\].
    pub(super) from: f64,
    /// What all reach while recorded \[m\].
    pub(super) to: f64,
    /// How long all are recorded \[s\].
    pub(super) duration: f64,
}

impl Scene<'_> {
    /// A stretch of so many metres somewhere in the run, no more than 60 % of
    /// it; nothing where the least is more.
    fn stretch(
        &self,
        least: f64,
        most: f64,
        rng: &mut Rng,
    ) -> Option<(f64, f64)> {
        span((self.from, self.to), (least, most), rng)
    }

    /// The same in time, with seconds.
    fn window(
        &self,
        least: f64,
        most: f64,
        rng: &mut Rng,
    ) -> Option<(f64, f64)> {
        span((0.0, self.duration), (least, most), rng)
    }
}

fn span(
    (from, to): (f64, f64),
    (least, most): (f64, f64),
    rng: &mut Rng,
) -> Option<(f64, f64)> {
    let most = most.min(0.6 * (to - from));
    // Drawn before the room is looked at: the same numbers in every scene.
    let (a, b): (f64, f64) = (rng.random(), rng.random());
    if most < least {
        return None;
    }
    let length = least + a * (most - least);
    let start = from + b * (to - from - length);
    Some((start, start + length))
}

/// Where or when an effect acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stretch {
    /// Everywhere or nowhere.
    Whole,
    /// Between two places \[m\], the second perhaps infinite.
    Place(f64, f64),
    /// Between two times \[s\], the second perhaps infinite.
    Time(f64, f64),
}

/// One hidden effect. What a method leaves as it is, the effect leaves.
pub(super) trait Effect: Debug {
    /// The friction coefficient that acts.
    fn mu(&self, mu: f64, _at: &Moment) -> f64 {
        mu
    }

    /// What the normal load of a unit mass gains \[m/s2\].
    fn load(&self, _at: &Moment) -> f64 {
        0.0
    }

    /// What the resistance of a unit mass gains \[m/s2\].
    fn brake(&self, _at: &Moment) -> f64 {
        0.0
    }

    /// Places \[m\] and times \[s\] at which the force jumps.
    fn borders(&self) -> (Vec<f64>, Vec<f64>) {
        (Vec::new(), Vec::new())
    }

    /// How the mass really starts, in the recording of that number.
    fn start(&self, stated: Start, _which: usize) -> Start {
        stated
    }

    /// The track that the event's file has, where it is not the true one.
    fn survey(&self, _true_ground: &Ground) -> Option<Ground> {
        None
    }

    /// How much later than its stamp a value is taken \[s\].
    fn late(&self, _which: usize) -> f64 {
        0.0
    }

    /// The value \[m/s\] for a time \[s\], before noise.
    fn read(&self, run: &Run, t: f64, which: usize) -> f64 {
        run.speed(t + self.late(which))
    }

    /// The errors \[m/s\] of values, `sd` the instrument's.
    fn noise(&self, sd: f64, values: &[f64], rng: &mut Rng) -> Vec<f64> {
        normal(values.len(), rng).into_iter().map(|z| sd * z).collect()
    }

    /// The logarithm of the density of such errors.
    fn log_density(&self, sd: f64, errors: &[f64], _values: &[f64]) -> f64 {
        errors.iter().map(|e| log_normal_density(*e, sd)).sum()
    }

    /// Where or when it acts.
    fn stretch(&self) -> Stretch {
        Stretch::Whole
    }
}

/// Independent standard normal numbers.
fn normal(count: usize, rng: &mut Rng) -> Vec<f64> {
    (0..count).map(|_| StandardNormal.sample(rng)).collect()
}

/// The logarithm of the normal density.
fn log_normal_density(error: f64, sd: f64) -> f64 {
    -0.5 * (error / sd).powi(2) - (sd * TAU.sqrt()).ln()
}

/// Whether a place or a time lies between two.
fn inside(x: f64, from: f64, to: f64) -> bool {
    x >= from && x < to
}

#[cfg(test)]
mod tests;
