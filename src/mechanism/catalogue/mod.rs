//! The catalogue: what may be missing from a model, one mechanism a file.

mod averaging_window;
mod clock_offset;
mod cohesion;
mod curvature;
mod depth_change;
mod entrainment;
mod friction_hardening;
mod friction_patch;
mod friction_step;
mod initial_velocity;
mod list;
mod release_position;
mod sensor_drift;
mod slope_bias;
mod spreading;
mod surge;
mod turbulent_drag;
mod velocity_scale;
mod velocity_weakening;
mod viscous_drag;

pub use averaging_window::AveragingWindow;
pub use clock_offset::ClockOffset;
pub use cohesion::Cohesion;
pub use curvature::Curvature;
pub use depth_change::DepthChange;
pub use entrainment::Entrainment;
pub use friction_hardening::FrictionHardening;
pub use friction_patch::FrictionPatch;
pub use friction_step::FrictionStep;
pub use initial_velocity::InitialVelocity;
pub use list::{Catalogue, catalogue, find};
pub(crate) use list::{applies, is_built_in, is_held};
pub use release_position::ReleasePosition;
pub use sensor_drift::SensorDrift;
pub use slope_bias::SlopeBias;
pub use spreading::Spreading;
pub use surge::Surge;
pub use turbulent_drag::TurbulentDrag;
pub use velocity_scale::VelocityScale;
pub use velocity_weakening::VelocityWeakening;
pub use viscous_drag::ViscousDrag;

use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Mechanism, Unknown};
use crate::physics::Rate;
use crate::physics::forces::{Axis, Shape, Term};
use crate::scalar::{Kind, Real};

/// The prior sd of a force at the upper-quartile speed \[m/s2\].
const FORCE: f64 = 1.5;
/// The prior sd of a change of mu.
const FRICTION: f64 = 0.15;
/// The prior sd of a start speed \[m/s\].
const SPEED: f64 = 5.0;
/// The prior sd of a release's shift \[m\].
const DISTANCE: f64 = 20.0;
/// The prior sd of the ground's angle \[degrees\].
const ANGLE: f64 = 3.0;
/// The prior sd of what a sensor has drifted by the end \[recorded unit\].
const DRIFT: f64 = 2.0;

/// Every mechanism that comes along and applies to an event of this extent,
/// variants one after the other.
fn built_in(extent: &Extent) -> Vec<Box<dyn Mechanism>> {
    let extent = *extent;
    let (place, time) = (Axis::Place, Axis::Time);
    let mut all: Vec<Box<dyn Mechanism>> = vec![
        Box::new(TurbulentDrag { extent }),
        Box::new(ViscousDrag { extent }),
        Box::new(Cohesion { extent }),
        Box::new(Surge { extent }),
        Box::new(Entrainment { extent }),
        Box::new(DepthChange { extent }),
        Box::new(InitialVelocity { extent }),
        Box::new(ReleasePosition { extent }),
        Box::new(ClockOffset),
        Box::new(VelocityScale),
        Box::new(SensorDrift { extent }),
    ];
    if extent.carried && extent.is_released() {
        all.push(Box::new(Spreading { extent }));
    }
    if extent.carried {
        all.push(Box::new(VelocityWeakening { extent }));
        all.push(Box::new(FrictionPatch { extent }));
        for axis in [place, time] {
            all.push(Box::new(FrictionStep { extent, axis }));
            for saturates in [false, true] {
                all.push(Box::new(FrictionHardening {
                    extent,
                    axis,
                    saturates,
                }));
            }
        }
        all.push(Box::new(SlopeBias));
    }
    if extent.bends {
        all.push(Box::new(Curvature { extent }));
    }
    if extent.averages {
        for begins in [true, false] {
            all.push(Box::new(AveragingWindow { begins }));
        }
    }
    all
}

/// A name with what tells the variant from the others that share it.
fn variant(mechanism: &impl Candidate) -> String {
    let along = mechanism.coordinate().map(Axis::name);
    let parts: Vec<&str> = along.into_iter().chain(mechanism.form()).collect();
    format!("{}({})", mechanism.name(), parts.join(", "))
}

/// The words for an amplitude above zero, below it, or unknown.
fn or(amplitude: f64, words: [&'static str; 3]) -> &'static str {
    match amplitude {
        x if x > 0.0 => words[0],
        x if x < 0.0 => words[1],
        _ => words[2],
    }
}

/// Where a stretch of the run begins, uniform, and how long it is: uniform from
/// the shortest that values can show to what is left of the run.
fn stretch(
    names: [&str; 2],
    axis: Axis,
    [begin, end]: [f64; 2],
    shortest: f64,
) -> [Unknown; 2] {
    let lengths = [shortest, end - begin];
    [
        Unknown::edge(names[0], axis, [begin, end]),
        Unknown::length(names[1], axis, lengths, end),
    ]
}

/// An amplitude, where its stretch begins, and how long that is.
fn along_place(extent: &Extent, amplitude: Unknown) -> Vec<Unknown> {
    let Extent { begin, run, duration, step, .. } = *extent;
    let shortest = run * (step / duration).min(0.5);
    let (names, edges) = (["from", "length"], [begin, begin + run]);
    let [from, length] = stretch(names, Axis::Place, edges, shortest);
    vec![amplitude, from, length]
}

/// A rate added along the whole run.
fn everywhere<K: Kind>(extent: &Extent, rate: Rate<K>) -> Change<K> {
    Change::force(extent, Term::everywhere(rate))
}

/// A rate added between two places or times.
fn between<K: Kind>(
    extent: &Extent,
    rate: Rate<K>,
    axis: Axis,
    edges: [Real<K>; 2],
) -> Change<K> {
    Change::force(extent, Term::between(axis, edges, rate))
}
