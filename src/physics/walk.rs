//! The motion under a law of the exact family, leg by leg.

use super::ahead::Ahead;
use super::exact::{End, Force, Pace};
use super::friction::{Friction, Rate, Site, Varies};
use super::motion::{
    Path, Release, Rest, State, Walker, first_piece, visit_times,
};
use super::resistance::Even;
use super::skim::{Crossing, Entry};
use super::track::{Piece, Track};
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// A place on the track that the mass has reached, and when.
#[derive(Debug, Clone, Copy)]
pub(super) struct Standing<K: Kind> {
    /// The piece it is on, and how far into it [m].
    pub(super) index: usize,
    pub(super) within: Real<K>,
    /// The time [s] and the speed.
    pub(super) begins: Real<K>,
    pub(super) pace: Pace<K>,
}

/// Goes on with a motion from where it stands, under a law of the exact
/// family, as `sample` with speeds only.
///
/// # Errors
/// [`Stop::Reject`] where the law has no flow with these values.
pub(super) fn sample_from<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
    from: Standing<K>,
    times: &[f64],
    visit: impl FnMut(State<K>),
) -> Result<(), Stop> {
    let walker = ExactWalker::standing(path, law, from)?;
    visit_times(walker, times, true, visit)
}

/// The walker of the exact family.
pub(super) struct ExactWalker<'a, K: Kind, L> {
    track: &'a Track,
    pieces: &'a [Piece],
    depth: f64,
    law: &'a L,
    /// The law's rates, if they are the same everywhere.
    uniform: Option<Rate<K>>,
    /// The same, if moreover a leg can only end at a border or at rest.
    even: Option<Even<K>>,
    ahead: Ahead,
    index: usize,
    /// How far into its piece the leg begins [m].
    within: Real<K>,
    /// Time [s] and speed [m/s] at which it begins.
    begins: Real<K>,
    pace: Pace<K>,
    /// How long it is [m].
    length: Real<K>,
    /// Whether the bed carries no load: a bend has lifted the mass off.
    lifted: bool,
    /// Whether the leg ends where that changes, inside its piece.
    crosses: bool,
    force: Force<K>,
    end: End<K>,
    ends: f64,
    resting: bool,
}

impl<'a, K: Kind, L: Friction<K>> ExactWalker<'a, K, L> {
    #[inline]
    pub(super) fn new(
        path: &Path<'a>,
        law: &'a L,
        release: Release<K>,
    ) -> Result<Self, Stop> {
        let (index, within) = first_piece(path, &release)?;
        let begins = Real::new(0.0);
        let pace = Pace::new(release.speed);
        Self::standing(path, law, Standing { index, within, begins, pace })
    }

    #[inline]
    fn standing(
        path: &Path<'a>,
        law: &'a L,
        from: Standing<K>,
    ) -> Result<Self, Stop> {
        let Standing { index, within, begins, pace } = from;
        let pieces = path.track.pieces();
        let zero = Real::new(0.0);
        let uniform = (law.varies() == Varies::Nowhere)
            .then(|| law.rate(&path.site(index, 0.0), zero));
        let mut walker = Self {
            track: path.track,
            pieces,
            depth: path.depth,
            law,
            uniform,
            even: uniform.as_ref().and_then(Even::untilted),
            ahead: Ahead::default(),
            index,
            within,
            begins,
            pace,
            length: zero,
            lifted: false,
            crosses: false,
            force: Force { a: zero, b: zero, c: zero },
            end: End::Never,
            ends: f64::INFINITY,
            resting: false,
        };
        walker.enter_piece()?;
        Ok(walker)
    }

    /// Steps onto a piece: the bed carries the mass unless it is too fast.
    #[inline(always)]
    fn enter_piece(&mut self) -> Result<(), Stop> {
        self.lifted = false;
        let piece = &self.pieces[self.index];
        let rate = match &self.uniform {
            Some(rate) => *rate,
            None => self.law.rate(&self.site(), Real::new(0.0)),
        };
        if rate.pressed.is_constantly_zero() {
            return self.begin(piece, &rate);
        }
        let lift_off = lift_off(piece, &rate);
        self.lifted = lift_off.is_some_and(|speed| self.pace.u > speed);
        self.begin_bent(piece, &rate, lift_off)
    }

    /// Begins a leg where the load does not depend on the speed.
    #[inline(always)]
    fn begin(&mut self, piece: &Piece, rate: &Rate<K>) -> Result<(), Stop> {
        self.force = Force {
            a: piece.pull - rate.mu * piece.load - rate.constant,
            b: rate.linear,
            c: rate.quadratic + rate.growth,
        };
        self.set_off(piece)
    }

    /// Begins a leg in a bend, and ends it where the bed begins or ceases to
    /// carry the mass.
    #[inline(never)]
    fn begin_bent(
        &mut self,
        piece: &Piece,
        rate: &Rate<K>,
        lift_off: Option<Real<K>>,
    ) -> Result<(), Stop> {
        let mu = if self.lifted { Real::new(0.0) } else { rate.mu };
        self.force = Force {
            a: piece.pull - mu * piece.load - rate.constant,
            b: rate.linear,
            c: rate.quadratic
                + rate.growth
                + mu * rate.pressed * piece.curvature,
        };
        self.set_off(piece)?;
        let Some(threshold) = lift_off else { return Ok(()) };
        let arrives = match self.end {
            End::Leaves { arrival, .. } => arrival.u,
            _ => Real::new(0.0),
        };
        let crosses = if self.lifted {
            arrives < threshold
        } else {
            arrives > threshold
        };
        let after = self.force.time_to_speed(self.pace.u, threshold);
        if !self.resting && crosses && after.value() >= 0.0 {
            self.length = self.force.distance_after(self.pace.u, after);
            self.end = End::Leaves { arrival: Pace::new(threshold), after };
            self.crosses = true;
            self.ends = (self.begins + after).value();
        }
        Ok(())
    }

    /// Finds the end of the leg whose force has just been set.
    #[inline(always)]
    fn set_off(&mut self, piece: &Piece) -> Result<(), Stop> {
        self.length = Real::new(piece.length) - self.within;
        if self.pace.u.value() <= 0.0 && self.force.a.value() <= 0.0 {
            self.come_to_rest();
            return Ok(());
        }
        self.end = self.force.traverse(self.pace, self.length);
        let after = match self.end {
            End::Leaves { after, .. } | End::Stops { after, .. } => after,
            End::Never => Real::new(f64::INFINITY),
        };
        self.ends = self.begins.value() + after.value();
        finite(self.ends)
    }

    #[cold]
    fn come_to_rest(&mut self) {
        let zero = Real::new(0.0);
        self.pace = Pace::new(zero);
        self.force = Force { a: zero, b: zero, c: zero };
        self.end = End::Never;
        self.ends = f64::INFINITY;
        self.resting = true;
    }

    /// The piece it is on, as laws see it.
    #[inline(always)]
    fn site(&self) -> Site {
        Path::new(self.track, self.depth).site(self.index, 0.0)
    }

    fn place(&self) -> Real<K> {
        self.within + self.pieces[self.index].start
    }
}

#[inline(always)]
fn finite(time: f64) -> Result<(), Stop> {
    if time.is_nan() {
        return Err(Stop::Reject("the motion is not a finite number"));
    }
    Ok(())
}

/// The speed at which a bend lifts the mass off the bed, where one does.
fn lift_off<K: Kind>(piece: &Piece, rate: &Rate<K>) -> Option<Real<K>> {
    let lift = -(rate.pressed * piece.curvature);
    (lift > 0.0 && piece.load > 0.0).then(|| (piece.load / lift).sqrt())
}

impl<K: Kind, L: Friction<K>> Walker<K> for ExactWalker<'_, K, L> {
    #[inline(always)]
    fn ends(&self) -> f64 {
        self.ends
    }

    #[inline(always)]
    fn advance(&mut self) -> Result<(), Stop> {
        match self.end {
            End::Leaves { arrival, after } => {
                self.begins += after;
                self.pace = arrival;
                if self.crosses {
                    return self.cross();
                }
                self.within = Real::new(0.0);
                self.index += 1;
                self.enter_piece()
            }
            End::Stops { distance, after } => {
                self.begins += after;
                self.within += distance;
                self.come_to_rest();
                Ok(())
            }
            End::Never => Ok(()),
        }
    }

    #[inline(always)]
    fn leap(&mut self, time: f64) -> Result<(), Stop> {
        self.skim(time)
    }

    #[inline(always)]
    fn speed_at(&mut self, time: f64) -> Result<Real<K>, Stop> {
        Ok(self.force.speed_after(self.pace.u, time - self.begins))
    }

    #[inline]
    fn state_at(&mut self, time: f64) -> Result<State<K>, Stop> {
        let after = time - self.begins;
        let speed = self.force.speed_after(self.pace.u, after);
        let covered = self.force.distance_after(self.pace.u, after);
        Ok(State {
            speed,
            distance: self.place() + covered,
            acceleration: self.force.acceleration(speed),
        })
    }

    fn at_rest(&self) -> Option<Rest<K>> {
        self.resting
            .then(|| Rest { time: self.begins, distance: self.place() })
    }
}

impl<K: Kind, L: Friction<K>> ExactWalker<'_, K, L> {
    /// Crosses whole pieces until one holds `time` or something else than a
    /// border ends the leg, where pieces can be crossed so; else goes on by one
    /// leg.
    #[inline(always)]
    fn skim(&mut self, time: f64) -> Result<(), Stop> {
        let (Some(even), End::Leaves { arrival, after }) =
            (&self.even, &self.end)
        else {
            return self.advance();
        };
        let (index, begins) = (self.index + 1, self.begins + *after);
        let mut entry = Entry { index, pace: *arrival, begins };
        let last = self.pieces.len() - 1;
        let track = self.track;
        let crossing = self.ahead.skim(track, even, &mut entry, last, time);
        self.within = Real::new(0.0);
        let Some(Crossing { force, arrival, after, ends }) = crossing else {
            return self.land(entry.index, entry.pace, entry.begins);
        };
        self.force = force;
        self.index = entry.index;
        (self.pace, self.begins) = (entry.pace, entry.begins);
        self.length = Real::new(self.pieces[entry.index].length);
        self.end = End::Leaves { arrival, after };
        self.ends = ends;
        finite(ends)
    }

    /// Enters a piece in the general way.
    #[cold]
    fn land(
        &mut self,
        index: usize,
        pace: Pace<K>,
        begins: Real<K>,
    ) -> Result<(), Stop> {
        (self.index, self.pace, self.begins) = (index, pace, begins);
        self.enter_piece()
    }

    /// Goes on within a piece, the load now on or off.
    #[cold]
    fn cross(&mut self) -> Result<(), Stop> {
        self.within += self.length;
        self.crosses = false;
        self.lifted = !self.lifted;
        let piece = &self.pieces[self.index];
        let rate = match &self.uniform {
            Some(rate) => *rate,
            None => self.law.rate(&self.site(), Real::new(0.0)),
        };
        // Along one piece the speed changes one way only: no second crossing.
        self.begin_bent(piece, &rate, None)
    }
}
