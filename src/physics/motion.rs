//! What a motion is: the ground, the release, and one leg after the other.
//!
//! A [`Walker`] stands on one leg of the motion at a time, knows when it ends
//! and the state at any time on it. Sampling a flow at given times and
//! following it to rest are written once, over every walker.

use super::depth::DepthSteps;
use super::forces::NEAR;
use super::friction::{Friction, Rate, Site, Varies};
use super::track::Track;
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// The ground a flow runs on: the track and the flow depth.
#[derive(Debug, Clone, Copy)]
pub struct Path<'a> {
    /// The terrain, with the flow depth where that changes along it.
    pub track: &'a Track,
    /// The mean flow depth \[m\], where it does not change.
    pub depth: f64,
    /// How it changes with time.
    steps: Option<&'a DepthSteps>,
}

impl<'a> Path<'a> {
    /// A track on which the flow has one depth \[m\], but where the track
    /// itself says otherwise.
    pub fn new(track: &'a Track, depth: f64) -> Self {
        Self { track, depth, steps: None }
    }

    /// The same with a depth that changes with time.
    pub(crate) fn during(self, steps: Option<&'a DepthSteps>) -> Self {
        Self { steps, ..self }
    }

    /// How the depth changes with time, where it does.
    pub(super) fn steps(&self) -> Option<&'a DepthSteps> {
        self.steps
    }

    /// Whether the depth is one number.
    pub(super) fn is_even(&self) -> bool {
        self.steps.is_none() && !self.track.has_depths()
    }

    /// A law's rates at a time \[s\], where they are the same on all pieces.
    #[inline(always)]
    pub(super) fn uniform<K: Kind, L: Friction<K> + ?Sized>(
        &self,
        law: &L,
        index: usize,
        time: f64,
    ) -> Option<Rate<K>> {
        let even = law.varies() == Varies::Nowhere && !self.track.has_depths();
        even.then(|| law.rate(&self.site(index, time), Real::new(0.0)))
    }

    /// A piece, as laws see it from a time \[s\] on.
    #[inline]
    pub(crate) fn site(&self, index: usize, time: f64) -> Site {
        let piece = &self.track.pieces()[index];
        let endless = !piece.length.is_finite();
        let half = if endless { 0.0 } else { 0.5 * piece.length };
        let depth = match (self.track.depth_on(index), self.steps) {
            (Some(depth), _) => depth,
            (None, Some(steps)) => steps.at(time, NEAR),
            (None, None) => self.depth,
        };
        Site {
            distance: piece.start + half,
            pull: piece.pull,
            load: piece.load,
            curvature: piece.curvature,
            depth,
        }
    }
}

/// How the mass starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Release<K: Kind> {
    /// Distance along the slope \[m\].
    pub distance: Real<K>,
    /// Speed at t = 0 \[m/s\].
    pub speed: Real<K>,
}

/// The state of the mass at one time.
#[derive(Debug, Clone, Copy)]
pub struct State<K: Kind> {
    /// Speed \[m/s\].
    pub speed: Real<K>,
    /// Distance along the slope from the track's first point \[m\].
    pub distance: Real<K>,
    /// du/dt \[m/s2\].
    pub acceleration: Real<K>,
}

/// Where and when the mass comes to rest.
#[derive(Debug, Clone, Copy)]
pub struct Rest<K: Kind> {
    /// Time \[s\].
    pub time: Real<K>,
    /// Distance along the slope from the track's first point \[m\].
    pub distance: Real<K>,
}

/// One leg of the motion after the other.
pub(crate) trait Walker<K: Kind> {
    /// The time at which the current leg ends \[s\]; infinite at rest.
    fn ends(&self) -> f64;
    /// Goes on to the next leg.
    fn advance(&mut self) -> Result<(), Stop>;
    /// Goes on by one leg or by many, but not beyond the one that holds
    /// `time` \[s\].
    #[inline(always)]
    fn leap(&mut self, _time: f64) -> Result<(), Stop> {
        self.advance()
    }
    /// Goes on to the leg that holds `time`.
    #[inline(always)]
    fn advance_to(&mut self, time: f64) -> Result<(), Stop> {
        while self.ends() <= time {
            self.leap(time)?;
        }
        Ok(())
    }
    /// The speed at a time on the current leg.
    fn speed_at(&mut self, time: f64) -> Result<Real<K>, Stop>;
    /// The whole state there.
    fn state_at(&mut self, time: f64) -> Result<State<K>, Stop>;
    /// Where and when the mass came to rest, once it has.
    fn at_rest(&self) -> Option<Rest<K>>;
    /// Whether the mass moves on for ever.
    fn is_endless(&self) -> bool {
        self.ends() == f64::INFINITY
    }
}

/// Legs before a flow is given up as endless: far above any real track, it
/// only keeps a pathological law from running for ever.
const MAX_LEGS: usize = 10_000_000;

/// Braking below this \[m/s2\] is an error about a terminal speed.
pub(super) const NO_BRAKING: f64 = 1e-9;

#[inline(always)]
pub(super) fn visit_times<K: Kind>(
    mut walker: impl Walker<K>,
    times: &[f64],
    speed_only: bool,
    mut visit: impl FnMut(State<K>),
) -> Result<(), Stop> {
    for &time in times {
        walker.advance_to(time)?;
        visit(if speed_only {
            let speed = walker.speed_at(time)?;
            let zero = Real::new(0.0);
            State { speed, distance: zero, acceleration: zero }
        } else {
            walker.state_at(time)?
        });
    }
    Ok(())
}

/// Follows a motion until the mass rests; `None` if it never does.
pub(super) fn follow<K: Kind>(
    mut walker: impl Walker<K>,
) -> Result<Option<Rest<K>>, Stop> {
    for _ in 0..MAX_LEGS {
        if let Some(rest) = walker.at_rest() {
            return Ok(Some(rest));
        }
        if walker.is_endless() {
            return Ok(None);
        }
        walker.leap(f64::INFINITY)?;
    }
    Ok(None)
}

/// The piece at the start and how far into it the mass stands.
pub(crate) fn first_piece<K: Kind>(
    path: &Path<'_>,
    release: &Release<K>,
) -> Result<(usize, Real<K>), Stop> {
    if !release.distance.value().is_finite()
        || !release.speed.value().is_finite()
        || release.distance < 0.0
        || release.speed < 0.0
    {
        return Err(Stop::Reject(
            "the mass starts off the track or backwards",
        ));
    }
    let index = path.track.piece_at(release.distance.value());
    Ok((index, release.distance - path.track.pieces()[index].start))
}
