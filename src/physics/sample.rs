//! The motion under a law, asked for: its states at given times, its end.

use super::by_speed::SpeedWalker;
use super::changed::ChangedWalker;
use super::forces::{Forces, STEPS};
use super::friction::{Friction, Varies};
use super::motion::{Path, Release, Rest, State, follow, visit_times};
use super::walk::ExactWalker;
use crate::error::Stop;
use crate::scalar::Kind;

/// Solves the motion and hands the state at each of the increasing `times`
/// \[s\] to `visit`. With `speed_only`, distance and acceleration are left at
/// 0 and cost nothing.
///
/// # Errors
/// [`Stop::Reject`] where the law has no flow with these values.
#[inline]
pub fn sample<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
    release: Release<K>,
    times: &[f64],
    speed_only: bool,
    mut visit: impl FnMut(State<K>),
) -> Result<(), Stop> {
    if path.steps().is_some() {
        return sample_during(
            path, law, release, times, speed_only, &mut visit,
        );
    }
    sample_steady(path, law, release, times, speed_only, visit)
}

/// The same where the depth does not change with time, which is not asked:
/// the loop that calibrations spend their time in is best by itself.
#[inline]
pub(crate) fn sample_steady<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
    release: Release<K>,
    times: &[f64],
    speed_only: bool,
    visit: impl FnMut(State<K>),
) -> Result<(), Stop> {
    if law.varies() == Varies::WithSpeed {
        let walker = SpeedWalker::new(path, law, release)?;
        visit_times(walker, times, speed_only, visit)
    } else {
        let walker = ExactWalker::new(path, law, release)?;
        visit_times(walker, times, speed_only, visit)
    }
}

/// The same where it does.
#[cold]
#[inline(never)]
fn sample_during<K: Kind>(
    path: &Path<'_>,
    law: &dyn Friction<K>,
    release: Release<K>,
    times: &[f64],
    speed_only: bool,
    visit: &mut dyn FnMut(State<K>),
) -> Result<(), Stop> {
    let forces = none(times.last().copied());
    let walker = ChangedWalker::new(path, law, &forces, release)?;
    visit_times(walker, times, speed_only, visit)
}

/// Follows the motion until the mass rests; `None` if it never does.
///
/// # Errors
/// [`Stop::Reject`] where the law has no flow with these values.
pub fn rest<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
    release: Release<K>,
) -> Result<Option<Rest<K>>, Stop> {
    if let Some(steps) = path.steps() {
        let forces = none(Some(steps.last()));
        return follow(ChangedWalker::new(path, law, &forces, release)?);
    }
    if law.varies() == Varies::WithSpeed {
        follow(SpeedWalker::new(path, law, release)?)
    } else {
        follow(ExactWalker::new(path, law, release)?)
    }
}

/// No forces beside the law: a depth that changes with time is met where
/// forces that do are. A law that varies with the speed is looked at as often
/// as under a mechanism's force, in a run that lasts so long \[s\].
fn none<K: Kind>(lasts: Option<f64>) -> Forces<K> {
    let lasts = lasts.filter(|t| *t > 1.0).unwrap_or(1.0);
    Forces { step: lasts / STEPS, ..Forces::default() }
}
