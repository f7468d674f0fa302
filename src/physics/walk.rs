//! Sliding along the track, leg by leg.
//!
//! A [`Walker`] stands on one leg of the motion at a time, knows when it ends
//! and the state at any time on it. The exact walker here serves every law of
//! the exact family, the one in `numeric` the rest; sampling a flow at given
//! times and following it to rest are written once, over both.

use super::ahead::Ahead;
use super::changed::ChangedWalker;
use super::exact::{End, Force, Pace};
use super::forces::Forces;
use super::friction::{Friction, Rate, Site, Varies};
use super::numeric::{FEW, NumericWalker, PLAIN, WITH_FEW, WITH_MANY};
use super::resistance::Even;
use super::skim::{Crossing, Entry, skim_even};
use super::track::{Piece, Track};
use crate::error::Stop;
use crate::scalar::{Kind, Real};

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
    visit: impl FnMut(State<K>),
) -> Result<(), Stop> {
    match law.varies() {
        Varies::WithSpeed if K::DIRECTIONS == 0 => {
            let walker = NumericWalker::<K, L, PLAIN>::new;
            visit_times(walker(path, law, release)?, times, speed_only, visit)
        }
        Varies::WithSpeed if K::DIRECTIONS <= FEW => {
            let walker = NumericWalker::<K, L, WITH_FEW>::new;
            visit_times(walker(path, law, release)?, times, speed_only, visit)
        }
        Varies::WithSpeed => {
            let walker = NumericWalker::<K, L, WITH_MANY>::new;
            visit_times(walker(path, law, release)?, times, speed_only, visit)
        }
        _ => {
            let walker = ExactWalker::new(path, law, release)?;
            visit_times(walker, times, speed_only, visit)
        }
    }
}

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
/// family, as [`sample`] with speeds only.
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

/// Follows the motion until the mass rests; `None` if it never does.
///
/// # Errors
/// [`Stop::Reject`] where the law has no flow with these values.
pub fn rest<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
    release: Release<K>,
) -> Result<Option<Rest<K>>, Stop> {
    match law.varies() {
        Varies::WithSpeed if K::DIRECTIONS == 0 => {
            follow(NumericWalker::<K, L, PLAIN>::new(path, law, release)?)
        }
        Varies::WithSpeed if K::DIRECTIONS <= FEW => {
            follow(NumericWalker::<K, L, WITH_FEW>::new(path, law, release)?)
        }
        Varies::WithSpeed => {
            follow(NumericWalker::<K, L, WITH_MANY>::new(path, law, release)?)
        }
        _ => follow(ExactWalker::new(path, law, release)?),
    }
}

/// The same with forces added to the law.
///
/// # Errors
/// [`Stop::Reject`] where the law has no flow with these values.
pub fn rest_changed<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
    forces: &Forces<K>,
    release: Release<K>,
) -> Result<Option<Rest<K>>, Stop> {
    follow(ChangedWalker::new(path, law, forces, release)?)
}

/// The ground a flow runs on: the track and the flow depth \[m\].
#[derive(Debug, Clone, Copy)]
pub struct Path<'a> {
    /// The terrain.
    pub track: &'a Track,
    /// The mean flow depth \[m\].
    pub depth: f64,
}

#[inline(always)]
fn visit_times<K: Kind>(
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

fn follow<K: Kind>(
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

/// The site of a piece, as laws see it.
pub(crate) fn site(piece: &Piece, depth: f64) -> Site {
    let half = if piece.length.is_finite() { 0.5 * piece.length } else { 0.0 };
    Site {
        distance: piece.start + half,
        pull: piece.pull,
        load: piece.load,
        curvature: piece.curvature,
        depth,
    }
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

/// The walker of the exact family.
struct ExactWalker<'a, K: Kind, L> {
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
    fn new(
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
            .then(|| law.rate(&site(&pieces[index], path.depth), zero));
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
            None => self.law.rate(&site(piece, self.depth), Real::new(0.0)),
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
        match (self.even, self.end) {
            (Some(even), End::Leaves { arrival, after }) => {
                self.skim(time, &even, arrival, after)
            }
            _ => self.advance(),
        }
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
    /// border ends the leg.
    #[inline(always)]
    fn skim(
        &mut self,
        time: f64,
        even: &Even<K>,
        arrival: Pace<K>,
        after: Real<K>,
    ) -> Result<(), Stop> {
        let begins = self.begins + after;
        let entry = Entry { index: self.index + 1, pace: arrival, begins };
        let last = self.pieces.len() - 1;
        let ahead = &mut self.ahead;
        let (entry, crossing) =
            skim_even(self.track, even, ahead, entry, last, time);
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
            None => self.law.rate(&site(piece, self.depth), Real::new(0.0)),
        };
        // Along one piece the speed changes one way only: no second crossing.
        self.begin_bent(piece, &rate, None)
    }
}
