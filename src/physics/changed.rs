//! The motion under a law with forces added to it, leg by leg.
//!
//! A leg ends where its piece does, where or when an added force changes, or
//! at rest. On it the forces are of the exact family: a force that varies
//! with the speed in another way is taken as linear in u^2 between the speeds
//! at both ends (the secant), over steps so short that the error, of second
//! order, is far below any noise.

use super::exact::{End, Force, Pace};
use super::forces::{Axis, Forces, Moment, NEAR};
use super::friction::{Friction, Rate, Varies};
use super::skim::{Crossing, Entry, skim};
use super::track::Piece;
use super::walk::{Path, Release, Rest, State, Walker, first_piece, site};
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// What ends a leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Border {
    Piece,
    Place,
    Time,
    Rest,
    Nothing,
}

/// The force on every piece alike, du/dt = along pull - across load -
/// constant - c u^2. On ground tilted by delta, pull and load turn by it:
/// along = cos(delta) + mu sin(delta), across = mu cos(delta) - sin(delta).
#[derive(Debug, Clone, Copy)]
struct Even<K: Kind> {
    along: Real<K>,
    across: Real<K>,
    constant: Real<K>,
    c: Real<K>,
}

impl<K: Kind> Even<K> {
    /// `None` where the rates have more to them.
    fn of(rate: &Rate<K>, tilt: &Tilt<K>) -> Option<Self> {
        let is_all = rate.pressed.is_constantly_zero()
            && rate.linear.is_constantly_zero();
        let mu = rate.mu.max(0.0);
        is_all.then(|| Self {
            along: tilt.cos + mu * tilt.sin,
            across: mu * tilt.cos - tilt.sin,
            constant: rate.constant,
            c: rate.quadratic + rate.growth,
        })
    }

    /// The force but for the drag c u^2.
    #[inline(always)]
    fn push(&self, piece: &Piece) -> Real<K> {
        self.along * piece.pull - self.across * piece.load - self.constant
    }
}

/// How the ground is tilted.
#[derive(Debug, Clone, Copy)]
struct Tilt<K: Kind> {
    sin: Real<K>,
    cos: Real<K>,
}

impl<K: Kind> Tilt<K> {
    /// Whether every piece still carries the mass: none is beyond the
    /// vertical.
    fn carries(&self, pieces: &[Piece]) -> bool {
        let (sin, cos) = (self.sin.value(), self.cos.value());
        sin == 0.0 || pieces.iter().all(|p| cos * p.load > sin * p.pull)
    }

    /// Pull and load of a piece on the tilted ground.
    fn ground(&self, piece: &Piece) -> (Real<K>, Real<K>) {
        let Piece { pull, load, .. } = *piece;
        let Self { sin, cos } = *self;
        (cos * pull + sin * load, cos * load - sin * pull)
    }
}

/// The walker of a law with forces added.
pub(crate) struct ChangedWalker<'a, K: Kind> {
    path: Path<'a>,
    law: &'a dyn Friction<K>,
    forces: &'a Forces<K>,
    bends: bool,
    /// The law's rates, if they are the same everywhere.
    uniform: Option<Rate<K>>,
    tilt: Tilt<K>,
    /// Whether every piece carries the mass in spite of it.
    carries: bool,
    /// What the forces add until they change, unless they bend.
    added: Rate<K>,
    /// The same with the law's, if it is as simple on all pieces.
    even: Option<Even<K>>,
    /// Where [m along the slope] and when [s] the forces change next.
    cut: Option<Real<K>>,
    moment: Option<Real<K>>,
    /// Pieces before this one end before that place.
    whole: usize,
    index: usize,
    /// Distance along the slope [m], time [s] and speed [m/s] at which the
    /// leg begins.
    place: Real<K>,
    begins: Real<K>,
    pace: Pace<K>,
    force: Force<K>,
    border: Border,
    /// Where, how fast, and after what time the leg ends.
    arrives: Real<K>,
    arrival: Pace<K>,
    after: Real<K>,
    ends: f64,
    rests: bool,
}

impl<'a, K: Kind> ChangedWalker<'a, K> {
    pub(crate) fn new(
        path: &Path<'a>,
        law: &'a dyn Friction<K>,
        forces: &'a Forces<K>,
        release: Release<K>,
    ) -> Result<Self, Stop> {
        let (index, _) = first_piece(path, &release)?;
        let zero = Real::new(0.0);
        let piece = &path.track.pieces()[index];
        let tilt = Tilt { sin: forces.tilt.sin(), cos: forces.tilt.cos() };
        let mut walker = Self {
            path: *path,
            law,
            forces,
            bends: law.varies() == Varies::WithSpeed || forces.bends(),
            uniform: (law.varies() == Varies::Nowhere)
                .then(|| law.rate(&site(piece, path.depth), zero)),
            tilt,
            carries: tilt.carries(path.track.pieces()),
            added: Rate::default(),
            even: None,
            cut: None,
            moment: None,
            whole: 0,
            index,
            place: release.distance,
            begins: zero,
            pace: Pace::new(release.speed),
            force: Force { a: zero, b: zero, c: zero },
            border: Border::Nothing,
            arrives: zero,
            arrival: Pace::new(zero),
            after: zero,
            ends: f64::INFINITY,
            rests: false,
        };
        walker.look_ahead();
        walker.set_off()?;
        Ok(walker)
    }

    fn piece(&self) -> &'a Piece {
        &self.path.track.pieces()[self.index]
    }

    /// What the forces add here and now, and until where and when that holds.
    fn look_ahead(&mut self) {
        let origin = self.path.track.origin();
        let at = origin + self.place.value();
        let time = self.begins.value();
        let next = self.forces.next(Axis::Place, at);
        self.cut = next.map(|cut| cut - origin);
        self.moment = self.forces.next(Axis::Time, time);
        self.whole = self.whole_pieces();
        if self.bends {
            return;
        }
        self.added = Rate::default();
        let here = Moment { place: at, time, speed: self.pace.u };
        self.forces.add_to(&mut self.added, &here);
        self.even = self
            .uniform
            .filter(|_| self.carries)
            .and_then(|law| Even::of(&(law + self.added), &self.tilt));
    }

    /// The piece in which the next cut lies, or the last one.
    fn whole_pieces(&self) -> usize {
        let pieces = self.path.track.pieces();
        let last = pieces.len() - 1;
        let Some(cut) = self.cut else { return last };
        let before =
            |piece: &Piece| piece.start + piece.length + NEAR < cut.value();
        self.index + pieces[self.index..last].partition_point(before)
    }

    /// Whether the forces have changed since they were looked at.
    fn is_beyond_cut(&self) -> bool {
        let beyond = |cut: Option<Real<K>>, x: Real<K>| {
            cut.is_some_and(|cut| cut.value() <= x.value() + NEAR)
        };
        beyond(self.cut, self.place) || beyond(self.moment, self.begins)
    }

    /// The rates of law and forces at the leg's beginning with some speed.
    fn rate(&self, speed: Real<K>) -> Rate<K> {
        let law =
            || self.law.rate(&site(self.piece(), self.path.depth), speed);
        let mut rate = self.uniform.unwrap_or_else(law);
        if self.bends {
            let at = Moment {
                place: self.path.track.origin() + self.place.value(),
                time: self.begins.value(),
                speed,
            };
            self.forces.add_to(&mut rate, &at);
        } else {
            rate = rate + self.added;
        }
        rate.mu = rate.mu.max(0.0);
        rate
    }

    /// The forces as du/dt = a - c u^2 at a given speed; what depends on the
    /// speed otherwise is in a.
    fn balance(&self, speed: Real<K>) -> Force<K> {
        let rate = self.rate(speed);
        let (pull, load) = self.tilt.ground(self.piece());
        let pressed = rate.pressed * self.piece().curvature;
        // A bend that lifts the mass off leaves it without friction.
        let carried = pressed * speed * speed + load > 0.0;
        let mu = if carried { rate.mu } else { Real::new(0.0) };
        let a = pull - mu * load - rate.constant;
        let c = rate.quadratic + rate.growth + mu * pressed;
        if self.bends {
            let a = a - rate.linear * speed;
            return Force { a, b: Real::new(0.0), c };
        }
        Force { a, b: rate.linear, c }
    }

    /// The force on a leg that lasts at most until `moment` and reaches at
    /// most `length` further.
    fn force_until(&self, moment: f64, length: f64) -> Force<K> {
        let first = self.balance(self.pace.u);
        if !self.bends {
            return first;
        }
        let pace = self.pace.u.value();
        let push = first.acceleration(self.pace.u);
        let crossing = if pace > 0.0 { length / pace } else { f64::INFINITY };
        let lasts = (moment - self.begins.value()).min(crossing);
        let reached = (self.pace.u + push * lasts).max(0.0);
        let (w0, w1) = (self.pace.w, reached.squared());
        if (w1 - w0).abs() < 1e-9 {
            return first;
        }
        let last = self.balance(reached);
        let slope = (last.a - first.a) / (w1 - w0);
        Force { a: first.a - slope * w0, c: first.c - slope, ..first }
    }

    /// When the leg ends at the latest: an added force changes, or a force
    /// that varies with the speed has to be looked at again.
    fn latest(&self) -> Option<Real<K>> {
        let time = self.begins.value();
        let step = time + self.forces.step;
        match self.moment {
            Some(next) if !self.bends || next <= step => Some(next),
            _ if self.bends && !self.rests && step.is_finite() => {
                Some(Real::new(step))
            }
            next => next,
        }
    }

    /// How far the leg reaches at most, and what is there.
    fn furthest(&self) -> (Real<K>, Border) {
        let piece = self.piece();
        let end = piece.start + piece.length;
        match self.cut {
            Some(cut) if cut < end => (cut, Border::Place),
            _ => (Real::new(end), Border::Piece),
        }
    }

    /// Finds the end of the leg that begins here and now.
    fn set_off(&mut self) -> Result<(), Stop> {
        if self.is_beyond_cut() {
            self.look_ahead();
        }
        let (reach, border) = self.furthest();
        let length = reach - self.place;
        let moment = self.latest();
        let limit = moment.map_or(f64::INFINITY, |m| m.value());
        self.force = self.force_until(limit, length.value());
        if self.pace.u <= 0.0 && self.force.a <= 0.0 {
            self.rests = true;
            self.wait(self.latest());
            return Ok(());
        }
        self.rests = false;
        (self.arrives, self.border) = (reach, border);
        match self.force.traverse(self.pace, length) {
            End::Leaves { arrival, after } => {
                (self.arrival, self.after) = (arrival, after);
            }
            End::Stops { distance, after } => {
                self.arrives = self.place + distance;
                self.arrival = Pace::new(Real::new(0.0));
                self.after = after;
                self.border = Border::Rest;
            }
            End::Never => {
                self.after = Real::new(f64::INFINITY);
                self.border = Border::Nothing;
            }
        }
        self.ends = (self.begins + self.after).value();
        self.end_by(moment)
    }

    /// Ends the leg at a moment, unless it ends before.
    #[inline(always)]
    fn end_by(&mut self, moment: Option<Real<K>>) -> Result<(), Stop> {
        if let Some(moment) = moment
            && (self.ends > moment.value() || self.ends.is_nan())
        {
            self.pause(moment);
        }
        if self.ends.is_nan() {
            return Err(Stop::Reject("the motion is not a finite number"));
        }
        Ok(())
    }

    /// Crosses whole pieces until one holds `time`, or something else than
    /// its border ends the leg.
    #[inline(always)]
    fn skim(&mut self, time: f64, even: &Even<K>) -> Result<(), Stop> {
        let begins = self.begins + self.after;
        let (index, pace) = (self.index + 1, self.arrival);
        let entry = Entry { index, pace, begins };
        let pieces = self.path.track.pieces();
        let until = self.moment.map_or(time, |m| m.value().min(time));
        let (entry, crossing) =
            skim(pieces, entry, self.whole, until, even.c, |piece| {
                even.push(piece)
            });
        self.index = entry.index;
        (self.pace, self.begins) = (entry.pace, entry.begins);
        let piece = &pieces[entry.index];
        self.place = Real::new(piece.start);
        let Some(Crossing { force, arrival, after, ends }) = crossing else {
            return self.set_off();
        };
        (self.force, self.border) = (force, Border::Piece);
        self.arrives = Real::new(piece.start + piece.length);
        (self.arrival, self.after, self.ends) = (arrival, after, ends);
        self.end_by(self.moment)
    }

    /// Ends the leg at a time, under way.
    fn pause(&mut self, moment: Real<K>) {
        self.after = moment - self.begins;
        let speed = self.force.speed_after(self.pace.u, self.after);
        self.arrival = Pace::new(speed.max(0.0));
        let covered = self.force.distance_after(self.pace.u, self.after);
        self.arrives = self.place + covered;
        self.border = Border::Time;
        self.ends = moment.value();
    }

    /// At rest, until a force changes with time if one ever does.
    fn wait(&mut self, moment: Option<Real<K>>) {
        let zero = Real::new(0.0);
        self.pace = Pace::new(zero);
        self.force = Force { a: zero, b: zero, c: zero };
        (self.arrives, self.arrival) = (self.place, self.pace);
        match moment {
            Some(moment) => {
                self.after = moment - self.begins;
                self.ends = moment.value();
                self.border = Border::Time;
            }
            None => {
                self.ends = f64::INFINITY;
                self.border = Border::Nothing;
            }
        }
    }

    /// The speed at a time on the current leg; before the release, that at
    /// the release.
    #[inline(always)]
    fn speed(&self, time: Real<K>) -> Real<K> {
        let after = time - self.begins;
        if after < 0.0 {
            return self.pace.u;
        }
        self.force.speed_after(self.pace.u, after)
    }

    /// The whole state there.
    fn state(&self, time: Real<K>) -> State<K> {
        let after = time - self.begins;
        if after < 0.0 {
            let acceleration = Real::new(0.0);
            let (speed, distance) = (self.pace.u, self.place);
            return State { speed, distance, acceleration };
        }
        let speed = self.force.speed_after(self.pace.u, after);
        let covered = self.force.distance_after(self.pace.u, after);
        State {
            speed,
            distance: self.place + covered,
            acceleration: self.force.acceleration(speed),
        }
    }
}

impl<K: Kind> Walker<K> for ChangedWalker<'_, K> {
    #[inline(always)]
    fn ends(&self) -> f64 {
        self.ends
    }

    fn advance(&mut self) -> Result<(), Stop> {
        if self.border == Border::Nothing {
            return Ok(());
        }
        self.begins += self.after;
        (self.place, self.pace) = (self.arrives, self.arrival);
        match self.border {
            Border::Piece => {
                self.index += 1;
                self.place = Real::new(self.piece().start);
            }
            Border::Rest => self.pace = Pace::new(Real::new(0.0)),
            _ => {}
        }
        self.set_off()
    }

    #[inline(always)]
    fn advance_to(&mut self, time: f64) -> Result<(), Stop> {
        while self.ends <= time {
            match (self.even, self.border) {
                (Some(even), Border::Piece) => self.skim(time, &even)?,
                _ => self.advance()?,
            }
        }
        Ok(())
    }

    fn speed_at(&mut self, time: f64) -> Result<Real<K>, Stop> {
        Ok(self.speed(Real::new(time)))
    }

    fn state_at(&mut self, time: f64) -> Result<State<K>, Stop> {
        Ok(self.state(Real::new(time)))
    }

    fn at_rest(&self) -> Option<Rest<K>> {
        let for_good = self.rests && self.border == Border::Nothing;
        for_good.then_some(Rest { time: self.begins, distance: self.place })
    }
}

/// Solves the motion under law and forces, and hands the state at each of the
/// times, which do not decrease \[s\], to `visit`. With `speed_only`, distance
/// and acceleration are left at 0 and cost nothing.
///
/// # Errors
/// [`Stop::Reject`] where the law has no flow with these values.
pub fn sample_changed<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
    forces: &Forces<K>,
    release: Release<K>,
    times: impl Iterator<Item = Real<K>>,
    speed_only: bool,
    mut visit: impl FnMut(State<K>),
) -> Result<(), Stop> {
    let mut walker = ChangedWalker::new(path, law, forces, release)?;
    for time in times {
        walker.advance_to(time.value())?;
        visit(if speed_only {
            let zero = Real::new(0.0);
            let speed = walker.speed(time);
            State { speed, distance: zero, acceleration: zero }
        } else {
            walker.state(time)
        });
    }
    Ok(())
}
