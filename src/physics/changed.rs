//! The motion under a law with forces added to it, leg by leg.
//!
//! A leg ends where its piece does, where or when an added force changes, or
//! at rest. On it the forces are of the exact family: a force that varies
//! with the speed in another way is taken as linear in u^2 between the speeds
//! at both ends (the secant), over steps so short that the error, of second
//! order, is far below any noise.

use super::exact::{End, Force, Pace};
use super::forces::{Axis, Forces, Moment};
use super::friction::{Friction, Rate, Varies};
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

/// The walker of a law with forces added.
pub(crate) struct ChangedWalker<'a, K: Kind, L> {
    path: Path<'a>,
    law: &'a L,
    forces: &'a Forces<K>,
    bends: bool,
    /// Sine and cosine of the tilt.
    tilt: (Real<K>, Real<K>),
    index: usize,
    /// Distance along the slope [m], time [s] and speed [m/s] at which the
    /// leg begins.
    place: Real<K>,
    begins: Real<K>,
    speed: Real<K>,
    force: Force<K>,
    border: Border,
    /// Where, how fast, and after what time the leg ends.
    arrives: Real<K>,
    arrival: Real<K>,
    after: Real<K>,
    ends: f64,
    rests: bool,
}

impl<'a, K: Kind, L: Friction<K>> ChangedWalker<'a, K, L> {
    pub(crate) fn new(
        path: &Path<'a>,
        law: &'a L,
        forces: &'a Forces<K>,
        release: Release<K>,
    ) -> Result<Self, Stop> {
        let (index, _) = first_piece(path, &release)?;
        let zero = Real::new(0.0);
        let mut walker = Self {
            path: *path,
            law,
            forces,
            bends: law.varies() == Varies::WithSpeed || forces.bends(),
            tilt: (forces.tilt.sin(), forces.tilt.cos()),
            index,
            place: release.distance,
            begins: zero,
            speed: release.speed,
            force: Force { a: zero, b: zero, c: zero },
            border: Border::Nothing,
            arrives: zero,
            arrival: zero,
            after: zero,
            ends: f64::INFINITY,
            rests: false,
        };
        walker.set_off()?;
        Ok(walker)
    }

    fn piece(&self) -> &'a Piece {
        &self.path.track.pieces()[self.index]
    }

    /// The rates of law and forces at the leg's beginning with some speed.
    fn rate(&self, speed: Real<K>) -> Rate<K> {
        let at = Moment {
            place: self.path.track.origin() + self.place.value(),
            time: self.begins.value(),
            speed,
        };
        let site = site(self.piece(), self.path.depth);
        let mut rate = self.law.rate(&site, speed);
        self.forces.add_to(&mut rate, &at);
        rate.mu = rate.mu.max(0.0);
        rate
    }

    /// Pull and load of the piece on the tilted ground.
    fn ground(&self) -> (Real<K>, Real<K>) {
        let Piece { pull, load, .. } = *self.piece();
        if self.forces.tilt.is_constantly_zero() {
            return (Real::new(pull), Real::new(load));
        }
        let (sin, cos) = self.tilt;
        (cos * pull + sin * load, cos * load - sin * pull)
    }

    /// The forces as du/dt = a - c u^2 at a given speed; what depends on the
    /// speed otherwise is in a.
    fn balance(&self, speed: Real<K>) -> Force<K> {
        let rate = self.rate(speed);
        let (pull, load) = self.ground();
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
        let first = self.balance(self.speed);
        if !self.bends {
            return first;
        }
        let pace = self.speed.value();
        let push = first.acceleration(self.speed);
        let crossing = if pace > 0.0 { length / pace } else { f64::INFINITY };
        let lasts = (moment - self.begins.value()).min(crossing);
        let reached = (self.speed + push * lasts).max(0.0);
        let (w0, w1) = (self.speed.squared(), reached.squared());
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
        let next = self.forces.next(Axis::Time, time);
        let step = time + self.forces.step;
        match next {
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
        let origin = self.path.track.origin();
        let at = origin + self.place.value();
        match self.forces.next(Axis::Place, at) {
            Some(cut) if cut - origin < end => (cut - origin, Border::Place),
            _ => (Real::new(end), Border::Piece),
        }
    }

    /// Finds the end of the leg that begins here and now.
    fn set_off(&mut self) -> Result<(), Stop> {
        let (reach, border) = self.furthest();
        let length = reach - self.place;
        let moment = self.latest();
        let limit = moment.map_or(f64::INFINITY, |m| m.value());
        self.force = self.force_until(limit, length.value());
        if self.speed <= 0.0 && self.force.a <= 0.0 {
            self.rests = true;
            let moment = self.latest();
            self.wait(moment);
            return Ok(());
        }
        self.rests = false;
        (self.arrives, self.border) = (reach, border);
        match self.force.traverse(Pace::new(self.speed), length) {
            End::Leaves { arrival, after } => {
                (self.arrival, self.after) = (arrival.u, after);
            }
            End::Stops { distance, after } => {
                self.arrives = self.place + distance;
                (self.arrival, self.after) = (Real::new(0.0), after);
                self.border = Border::Rest;
            }
            End::Never => {
                self.after = Real::new(f64::INFINITY);
                self.border = Border::Nothing;
            }
        }
        self.ends = (self.begins + self.after).value();
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

    /// Ends the leg at a time, under way.
    fn pause(&mut self, moment: Real<K>) {
        self.after = moment - self.begins;
        self.arrival = self.force.speed_after(self.speed, self.after).max(0.0);
        let covered = self.force.distance_after(self.speed, self.after);
        self.arrives = self.place + covered;
        self.border = Border::Time;
        self.ends = moment.value();
    }

    /// At rest, until a force changes with time if one ever does.
    fn wait(&mut self, moment: Option<Real<K>>) {
        let zero = Real::new(0.0);
        self.speed = zero;
        self.force = Force { a: zero, b: zero, c: zero };
        (self.arrives, self.arrival) = (self.place, zero);
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

    /// The state at a time on the current leg; before the release, that at
    /// the release.
    pub(crate) fn state(&self, time: Real<K>) -> State<K> {
        let after = time - self.begins;
        if after < 0.0 {
            let acceleration = Real::new(0.0);
            let (speed, distance) = (self.speed, self.place);
            return State { speed, distance, acceleration };
        }
        let speed = self.force.speed_after(self.speed, after);
        let covered = self.force.distance_after(self.speed, after);
        State {
            speed,
            distance: self.place + covered,
            acceleration: self.force.acceleration(speed),
        }
    }
}

impl<K: Kind, L: Friction<K>> Walker<K> for ChangedWalker<'_, K, L> {
    fn ends(&self) -> f64 {
        self.ends
    }

    fn advance(&mut self) -> Result<(), Stop> {
        if self.border == Border::Nothing {
            return Ok(());
        }
        self.begins += self.after;
        (self.place, self.speed) = (self.arrives, self.arrival);
        match self.border {
            Border::Piece => {
                self.index += 1;
                self.place = Real::new(self.piece().start);
            }
            Border::Rest => self.speed = Real::new(0.0),
            _ => {}
        }
        self.set_off()
    }

    fn speed_at(&mut self, time: f64) -> Result<Real<K>, Stop> {
        Ok(self.state(Real::new(time)).speed)
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
/// times, which do not decrease \[s\], to `visit`.
///
/// # Errors
/// [`Stop::Reject`] where the law has no flow with these values.
pub fn sample_changed<K: Kind, L: Friction<K>>(
    path: &Path<'_>,
    law: &L,
    forces: &Forces<K>,
    release: Release<K>,
    times: impl Iterator<Item = Real<K>>,
    mut visit: impl FnMut(State<K>),
) -> Result<(), Stop> {
    let mut walker = ChangedWalker::new(path, law, forces, release)?;
    for time in times {
        walker.advance_to(time.value())?;
        visit(walker.state(time));
    }
    Ok(())
}
