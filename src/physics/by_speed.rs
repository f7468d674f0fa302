//! The motion under laws that vary with the speed in a way of their own.
//!
//! On a piece of the track such a force depends on the speed alone. A leg
//! covers a piece, or as much of it as a polynomial describes, and the mass
//! moves on it in closed form, under the force of the exact family that
//! [`Fitted`] finds for the leg's speeds. Derivatives need no thought of their
//! own: all is computed in the kind of number that the law computes in.

use super::exact::{End, Force, Pace};
use super::fitted::{Fitted, Nearest};
use super::friction::{Friction, Site};
use super::motion::{
    NO_BRAKING, Path, Release, Rest, State, Walker, first_piece,
};
use super::track::Piece;
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// What the speed at a leg's end may be wrong by \[m/s\].
const TOLERANCE: f64 = 1e-12;

/// The range of speeds \[m/s\] that the first leg may cover, and the range
/// below which a motion is given up.
const FIRST_RANGE: f64 = 1.0;
const LEAST_RANGE: f64 = 1e-12;

/// A leg ends within about this time \[s\].
const LONGEST: f64 = 60.0;

/// The most that c times the length of a leg is, c the coefficient of u^2.
const MOST_DECAY: f64 = 0.5;

/// By what share of its range a leg may end beside it.
const BESIDE: f64 = 0.1;

/// Trials before a motion is given up as endless: far above any real track, it
/// only keeps a pathological law from running for ever.
const MAX_TRIALS: usize = 1_000_000;

const LOST: Stop = Stop::Reject("the motion cannot be integrated");

/// A stretch of the motion on one piece.
#[derive(Clone, Copy)]
struct Leg<K: Kind> {
    /// The law's force over the speeds on it, and the simple one.
    fitted: Fitted<K>,
    nearest: Nearest<K>,
    end: End<K>,
}

/// The walker of laws that vary with the speed.
pub(super) struct SpeedWalker<'a, K: Kind, L> {
    pieces: &'a [Piece],
    path: Path<'a>,
    law: &'a L,
    index: usize,
    /// How far into its piece the leg begins [m].
    within: Real<K>,
    /// Time [s] and speed [m/s] at which it begins.
    begins: Real<K>,
    pace: Pace<K>,
    /// `None` at rest.
    leg: Option<Leg<K>>,
    /// How long it is [m], and whether it ends at the border of its piece.
    covers: Real<K>,
    arrives: bool,
    ends: f64,
    /// The coefficient of u^2 on the last leg [1/m], and the range of speeds
    /// that the next one may cover [m/s].
    decay: Real<K>,
    range: f64,
    trials: usize,
}

impl<'a, K: Kind, L: Friction<K>> SpeedWalker<'a, K, L> {
    pub(super) fn new(
        path: &Path<'a>,
        law: &'a L,
        release: Release<K>,
    ) -> Result<Self, Stop> {
        let (index, within) = first_piece(path, &release)?;
        let zero = Real::new(0.0);
        let mut walker = Self {
            pieces: path.track.pieces(),
            path: *path,
            law,
            index,
            within,
            begins: zero,
            pace: Pace::new(release.speed),
            leg: None,
            covers: zero,
            arrives: false,
            ends: f64::INFINITY,
            decay: zero,
            range: FIRST_RANGE,
            trials: 0,
        };
        walker.begin()?;
        Ok(walker)
    }

    fn site(&self) -> Site {
        self.path.site(self.index, self.begins.value())
    }

    fn acceleration(&self, speed: Real<K>) -> Real<K> {
        let site = self.site();
        acceleration(self.law, &site, speed)
    }

    /// Finds the leg that begins here and now.
    fn begin(&mut self) -> Result<(), Stop> {
        let site = self.site();
        let push = acceleration(self.law, &site, self.pace.u);
        if self.pace.u <= 0.0 && push <= 0.0 {
            self.come_to_rest();
            return Ok(());
        }
        let left = Real::new(self.pieces[self.index].length) - self.within;
        let (mut length, mut to) = self.guess(push, left);
        let mut is_guess = true;
        while self.range > LEAST_RANGE && self.trials < MAX_TRIALS {
            self.trials += 1;
            let leg = self.leg(&site, push, length, to);
            if leg.fitted.jumps()
                && let Some((leg, length)) = self.over_jump(&leg, push, left)
            {
                self.arrives = false;
                return self.take(leg, length);
            }
            self.decay = leg.nearest.force.c;
            let ends_beside = leg.ends_beside(to);
            if ends_beside && is_guess && leg.arrival() >= 0.0 {
                (to, is_guess) = (leg.arrival(), false);
            } else if self.adapt(&leg, ends_beside) {
                self.arrives = length.value() == left.value();
                return self.take(leg, length);
            } else {
                (length, to) = self.guess(push, left);
                is_guess = true;
            }
        }
        Err(LOST)
    }

    /// How far a leg reaches at most \[m\], and about how fast the mass then
    /// is; 0 where it stops before.
    #[inline(always)]
    fn guess(&self, push: Real<K>, left: Real<K>) -> (Real<K>, Real<K>) {
        let (u, a, range) = (self.pace.u.value(), push.value(), self.range);
        // From w0 + 2 a l = (u +- range)^2.
        let by_range = if a > 0.0 {
            range * (u + 0.5 * range) / a
        } else if a < 0.0 && u > range {
            range * (u - 0.5 * range) / -a
        } else {
            f64::INFINITY
        };
        let by_decay = MOST_DECAY / self.decay.value().abs();
        let most = by_range.min(by_decay).min(LONGEST * (u + range));
        let length = if most < left.value() { Real::new(most) } else { left };
        let gain = push * length * 2.0 / (self.decay * length + 1.0);
        let w = self.pace.w + gain;
        let stops = w.value() <= 0.0;
        (length, if stops { Real::new(0.0) } else { w.sqrt() })
    }

    /// A leg of at most a given length whose speeds end at `to`.
    #[inline(always)]
    fn leg(
        &self,
        site: &Site,
        push: Real<K>,
        length: Real<K>,
        to: Real<K>,
    ) -> Leg<K> {
        let force = |u: Real<K>| acceleration(self.law, site, u);
        let fitted = Fitted::through([self.pace.u, to], push, force);
        let nearest = fitted.nearest();
        let mut end = nearest.force.traverse(self.pace, length);
        if let End::Leaves { arrival, .. } = &mut end {
            let beyond = arrival.u - fitted.to();
            *arrival = Pace::new(arrival.u + nearest.further(beyond));
        }
        Leg { fitted, nearest, end }
    }

    /// A leg over a jump of the law, with its length: to a speed beyond it,
    /// and not to a place, so that the mass is at the jump when it has that
    /// speed, whatever the parameters are. `None` where it does not get there.
    #[cold]
    fn over_jump(
        &self,
        leg: &Leg<K>,
        push: Real<K>,
        left: Real<K>,
    ) -> Option<(Leg<K>, Real<K>)> {
        let to = Real::new(leg.fitted.to().value());
        let after = (to - self.pace.u) / push;
        let length = (to + self.pace.u) * after * 0.5;
        let end = End::Leaves { arrival: Pace::new(to), after };
        let gets_there = after.value() > 0.0 && length < left;
        gets_there.then_some((Leg { end, ..*leg }, length))
    }

    /// Whether a leg is good enough; how wide the next one may be.
    #[inline(always)]
    fn adapt(&mut self, leg: &Leg<K>, ends_beside: bool) -> bool {
        let width = leg.fitted.width();
        if !ends_beside && leg.nearest.error < 0.01 * TOLERANCE {
            self.range = self.range.max(2.0 * width);
            return true;
        }
        // Of fifth order; what is not a number shrinks the range, too.
        let good = !ends_beside && leg.nearest.error <= TOLERANCE;
        let factor = 0.9 * (TOLERANCE / leg.nearest.error).powf(0.2);
        let most = if good { 2.0 } else { 0.5 };
        self.range = width.min(self.range) * factor.max(0.1).min(most);
        good
    }

    fn take(&mut self, leg: Leg<K>, length: Real<K>) -> Result<(), Stop> {
        let after = match leg.end {
            End::Leaves { after, .. } => {
                self.covers = length;
                after
            }
            End::Stops { distance, after } => {
                (self.covers, self.arrives) = (distance, false);
                after
            }
            End::Never => return Err(LOST),
        };
        self.ends = (self.begins + after).value();
        self.leg = Some(leg);
        if self.ends.is_nan() { Err(LOST) } else { Ok(()) }
    }

    #[cold]
    fn come_to_rest(&mut self) {
        self.pace = Pace::new(Real::new(0.0));
        self.leg = None;
        self.ends = f64::INFINITY;
    }

    fn place(&self) -> Real<K> {
        self.within + self.pieces[self.index].start
    }

    /// The simple force from the leg's beginning to a time after it \[s\], and
    /// the speed then.
    #[inline(always)]
    fn until(&self, leg: &Leg<K>, after: Real<K>) -> (Force<K>, Real<K>) {
        let from = self.pace.u;
        let to = leg.nearest.force.speed_after(from, after).max(0.0);
        if to == from {
            return (leg.nearest.force, to);
        }
        let nearest = leg.fitted.over([from, to]).nearest();
        let speed = nearest.force.speed_after(from, after);
        let speed = speed + nearest.further(speed - to);
        (nearest.force, speed.max(0.0))
    }
}

impl<K: Kind> Leg<K> {
    fn arrival(&self) -> Real<K> {
        match self.end {
            End::Leaves { arrival, .. } => arrival.u,
            End::Stops { .. } => Real::new(0.0),
            End::Never => Real::new(f64::NAN),
        }
    }

    /// Whether it ends so far from the speed it was fitted to that it has to
    /// be fitted again.
    #[inline(always)]
    fn ends_beside(&self, to: Real<K>) -> bool {
        let width = self.fitted.width();
        let beside = (self.arrival() - to).value().abs();
        if self.fitted.is_narrow() {
            return beside.is_nan() || beside > 2.0 * width;
        }
        let near = beside <= BESIDE * width.min(to.value());
        // That share of what is done about it is missed.
        let further = self.nearest.further(Real::new(beside)).value();
        !near || further.abs() * beside > 0.1 * TOLERANCE * width
    }
}

impl<K: Kind, L: Friction<K>> Walker<K> for SpeedWalker<'_, K, L> {
    fn ends(&self) -> f64 {
        self.ends
    }

    fn advance(&mut self) -> Result<(), Stop> {
        let Some(leg) = self.leg else { return Ok(()) };
        let (arrival, after) = match leg.end {
            End::Leaves { arrival, after } => (arrival, after),
            End::Stops { after, .. } => (Pace::new(Real::new(0.0)), after),
            End::Never => return Ok(()),
        };
        (self.pace, self.begins) = (arrival, self.begins + after);
        self.within += self.covers;
        if self.arrives {
            self.within = Real::new(0.0);
            self.index += 1;
        }
        self.begin()
    }

    fn speed_at(&mut self, time: f64) -> Result<Real<K>, Stop> {
        let Some(leg) = &self.leg else { return Ok(self.pace.u) };
        let after = time - self.begins;
        Ok(self.until(leg, after).1)
    }

    fn state_at(&mut self, time: f64) -> Result<State<K>, Stop> {
        let Some(leg) = &self.leg else {
            let zero = Real::new(0.0);
            let distance = self.place();
            return Ok(State { speed: zero, distance, acceleration: zero });
        };
        let after = time - self.begins;
        let (force, speed) = self.until(leg, after);
        let covered = force.distance_after(self.pace.u, after);
        let acceleration = self.acceleration(speed);
        Ok(State { speed, distance: self.place() + covered, acceleration })
    }

    fn at_rest(&self) -> Option<Rest<K>> {
        let rest = Rest { time: self.begins, distance: self.place() };
        self.leg.is_none().then_some(rest)
    }

    // Past the last border nothing but the speed changes the force: a mass
    // that does not brake here never will.
    fn is_endless(&self) -> bool {
        let last = self.index + 1 == self.pieces.len();
        last && self.acceleration(self.pace.u) > -NO_BRAKING
    }
}

#[inline(always)]
fn acceleration<K: Kind, L: Friction<K>>(
    law: &L,
    site: &Site,
    speed: Real<K>,
) -> Real<K> {
    site.pull - law.rate(site, speed).resistance(site, speed)
}
