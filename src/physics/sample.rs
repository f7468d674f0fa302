//! The motion under a law, asked for: its states at given times, its end.

use super::by_speed::SpeedWalker;
use super::changed::ChangedWalker;
use super::forces::{Forces, STEPS};
use super::friction::{Friction, Rate, Site, Varies};
use super::motion::{Path, Release, Rest, State, follow, visit_times};
use super::walk::ExactWalker;
use crate::error::Stop;
use crate::scalar::{Kind, Real};

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
    if !path.is_even() {
        let visit = &mut visit;
        return sample_uneven(path, law, release, times, speed_only, visit);
    }
    if is_exact(path, law) {
        return sample_exact(path, law, release, times, speed_only, visit);
    }
    let walker = SpeedWalker::new(path, law, release)?;
    visit_times(walker, times, speed_only, visit)
}

/// Whether a law is of the exact family, on a path of one depth.
#[inline]
pub(crate) fn is_exact<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
) -> bool {
    path.is_even() && law.varies() != Varies::WithSpeed
}

/// The motion of [`sample`] where [`is_exact`] says so.
///
/// # Errors
/// As [`sample`].
#[inline]
pub(crate) fn sample_exact<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
    release: Release<K>,
    times: &[f64],
    speed_only: bool,
    visit: impl FnMut(State<K>),
) -> Result<(), Stop> {
    let walker = ExactWalker::new(path, law, release)?;
    visit_times(walker, times, speed_only, visit)
}

/// The same where the depth changes. Its own code, and not compiled for every
/// law: the loop that calibrations spend their time in is best by itself.
#[cold]
#[inline(never)]
fn sample_uneven<K: Kind>(
    path: &Path<'_>,
    law: &dyn Friction<K>,
    release: Release<K>,
    times: &[f64],
    speed_only: bool,
    visit: &mut dyn FnMut(State<K>),
) -> Result<(), Stop> {
    let law = &PieceByPiece(law);
    if path.steps().is_some() {
        let forces = none(times.last().copied());
        let walker = ChangedWalker::new(path, law.0, &forces, release)?;
        visit_times(walker, times, speed_only, visit)
    } else if law.varies() == Varies::WithSpeed {
        let walker = SpeedWalker::new(path, law, release)?;
        visit_times(walker, times, speed_only, visit)
    } else {
        let walker = ExactWalker::new(path, law, release)?;
        visit_times(walker, times, speed_only, visit)
    }
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
    if !path.is_even() {
        return rest_uneven(path, law, release);
    }
    if law.varies() == Varies::WithSpeed {
        follow(SpeedWalker::new(path, law, release)?)
    } else {
        follow(ExactWalker::new(path, law, release)?)
    }
}

/// The same where the depth changes.
#[cold]
#[inline(never)]
fn rest_uneven<K: Kind>(
    path: &Path<'_>,
    law: &dyn Friction<K>,
    release: Release<K>,
) -> Result<Option<Rest<K>>, Stop> {
    let law = &PieceByPiece(law);
    if let Some(steps) = path.steps() {
        let forces = none(Some(steps.last()));
        follow(ChangedWalker::new(path, law.0, &forces, release)?)
    } else if law.varies() == Varies::WithSpeed {
        follow(SpeedWalker::new(path, law, release)?)
    } else {
        follow(ExactWalker::new(path, law, release)?)
    }
}

/// A law where the depth differs from piece to piece, and its rates do too.
struct PieceByPiece<'a, K>(&'a dyn Friction<K>);

impl<K: Kind> Friction<K> for PieceByPiece<'_, K> {
    fn varies(&self) -> Varies {
        self.0.varies().max(Varies::WithPlace)
    }

    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K> {
        self.0.rate(at, speed)
    }
}

/// No forces beside the law: a depth that changes with time is met where
/// forces that do are. A law that varies with the speed is looked at as often
/// as under a mechanism's force, in a run that lasts so long \[s\].
fn none<K: Kind>(lasts: Option<f64>) -> Forces<K> {
    let lasts = lasts.filter(|t| *t > 1.0).unwrap_or(1.0);
    Forces { step: lasts / STEPS, ..Forces::default() }
}
