//! The motion under a law with forces added to it, leg by leg.
//!
//! A leg ends where its piece does, where or when an added force changes, or
//! at rest. On it the forces are of the exact family. One that varies along
//! the leg, or with the speed in another way than by u^2, is taken at the
//! three stages of Kutta's method of third order: the mass moves in closed
//! form under their mean, and the rest is added to it (`defect`).

use super::ahead::Ahead;
use super::defect::Defect;
use super::exact::{End, Force, Pace};
use super::forces::{Axis, Forces, Moment, NEAR, Term, nearer};
use super::friction::{Friction, Rate, Varies};
use super::motion::{
    NO_BRAKING, Path, Release, Rest, State, Walker, first_piece, follow,
};
use super::resistance::{Even, Resistance, Tilt};
use super::skim::{Crossing, Entry, skim};
use super::track::Piece;
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// Up to what stiffness times step a force is asked for no more often: speeds of
/// 30 m/s are right to 1 mm/s then (`tests/physics/changed_motion.rs`). Beyond
/// 2.5 stages of third order are not stable.
const STIFF: f64 = 0.25;
/// At which speeds a law that varies with the speed is asked how stiff it is,
/// and over how much of the speed \[m/s\]: most are where the mass is slow.
const LOOKED_AT: [f64; 4] = [0.0, 1.0, 3.0, 10.0];
const ASIDE: f64 = 0.1;
/// How often a step of time is halved at the most: a mass that is braked more
/// than the last one bears hardly moves.
const MOST_HALVED: u32 = 6;

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
pub(crate) struct ChangedWalker<'a, K: Kind> {
    path: Path<'a>,
    law: &'a dyn Friction<K>,
    forces: &'a Forces<K>,
    bends: bool,
    /// The law's rates, if they are the same on all pieces.
    uniform: Option<Rate<K>>,
    tilt: Tilt<K>,
    /// Whether every piece carries the mass in spite of it.
    carries: bool,
    /// What the forces that do not vary add until they change.
    added: Rate<K>,
    /// Whether there are others.
    varies: bool,
    /// The first with the law's, if that is the same on all pieces.
    base: Option<Resistance<K>>,
    /// The whole force, if it is as simple.
    even: Option<Even<K>>,
    ahead: Ahead,
    /// After what time [s] at most a force that varies with the speed is asked
    /// for again.
    step: f64,
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
    defect: Option<Defect<K>>,
    border: Border,
    /// Where, how fast, and after what time the leg ends.
    arrives: Real<K>,
    arrival: Pace<K>,
    after: Real<K>,
    ends: f64,
    rests: bool,
    /// Since when [s], if it does.
    since: Real<K>,
}

impl<'a, K: Kind> ChangedWalker<'a, K> {
    pub(crate) fn new(
        path: &Path<'a>,
        law: &'a dyn Friction<K>,
        forces: &'a Forces<K>,
        release: Release<K>,
    ) -> Result<Self, Stop> {
        let (index, _) = first_piece(path, &release)?;
        let (zero, tilt) = (Real::new(0.0), Tilt::by(forces.tilt));
        let mut walker = Self {
            path: *path,
            law,
            forces,
            bends: law.varies() == Varies::WithSpeed || forces.bends(),
            uniform: path.uniform(law, index, 0.0),
            tilt,
            carries: tilt.carries(path.track.pieces()),
            added: Rate::default(),
            varies: forces.varying().next().is_some(),
            base: None,
            even: None,
            ahead: Ahead::default(),
            step: f64::INFINITY,
            cut: None,
            moment: None,
            whole: 0,
            index,
            place: release.distance,
            begins: zero,
            pace: Pace::new(release.speed),
            force: Force { a: zero, b: zero, c: zero },
            defect: None,
            border: Border::Nothing,
            arrives: zero,
            arrival: Pace::new(zero),
            after: zero,
            ends: f64::INFINITY,
            rests: false,
            since: zero,
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
        self.look_at_depth(time);
        self.whole = self.whole_pieces();
        let speed = self.pace.u;
        let here = Moment { place: at.into(), time: time.into(), speed };
        self.added = self.forces.even(&here);
        if self.bends {
            self.step = step(self.forces, self.stiffness_of_law());
        }
        // What presses a mass into a bend is asked for where it varies.
        let presses = |term: &Term<K>| !term.rate.pressed.is_constantly_zero();
        let is_simple = self.carries && !self.forces.varying().any(presses);
        let base = self
            .uniform
            .filter(|_| is_simple)
            .and_then(|law| Resistance::of(&(law + self.added)));
        self.base = base.filter(|base| self.bends || !base.is_linear());
        let even = base.filter(|_| !self.varies);
        self.even = even.and_then(|base| Even::of(&base, &self.tilt));
        self.ahead.forget();
    }

    /// About how much more the law brakes a mass the faster it is, at the most
    /// \[1/s\], beside what grows with the square of the speed.
    fn stiffness_of_law(&self) -> f64 {
        if let Some(rate) = &self.uniform {
            return rate.linear.value().abs();
        }
        if self.law.varies() != Varies::WithSpeed {
            return 0.0;
        }
        let site = self.path.site(self.index, self.begins.value());
        let brakes = |speed: f64| {
            let rate = self.law.rate(&site, Real::new(speed));
            let [mu, constant, linear] = [rate.mu, rate.constant, rate.linear];
            (mu * site.load + constant).value() + linear.value() * speed
        };
        let slope = |from: f64| (brakes(from + ASIDE) - brakes(from)) / ASIDE;
        let speeds = LOOKED_AT.into_iter().chain([self.pace.u.value()]);
        speeds.map(|speed| slope(speed).abs()).fold(0.0, f64::max)
    }

    /// The depth from a time on, and until when that holds.
    fn look_at_depth(&mut self, time: f64) {
        let Some(steps) = self.path.steps() else { return };
        let next = steps.next(time, NEAR).map(Real::new);
        self.moment = nearer(self.moment, next);
        let site = self.path.site(self.index, time);
        let zero = Real::new(0.0);
        self.uniform = self.uniform.map(|_| self.law.rate(&site, zero));
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

    /// The rates of law and forces on the leg's piece: of the terms that act at
    /// `from`, in the state `at`.
    fn rate(&self, from: &Moment<K>, at: &Moment<K>) -> Rate<K> {
        let site = || self.path.site(self.index, self.begins.value());
        let law = || self.law.rate(&site(), at.speed);
        let mut rate = self.uniform.unwrap_or_else(law) + self.added;
        for term in self.forces.varying_from(from) {
            rate = rate + term.rate_at(at);
        }
        rate.mu = rate.mu.max(0.0);
        rate
    }

    /// The forces as du/dt = a - c u^2, of the terms that act at `from`, in the
    /// state `at`; where they bend, what depends on the speed otherwise is in
    /// a.
    #[inline(always)]
    fn balance(
        &self,
        piece: &Piece,
        from: &Moment<K>,
        at: &Moment<K>,
    ) -> Force<K> {
        let Some(base) = self.base else { return self.balance_of(from, at) };
        let mut sum = base;
        for term in self.forces.varying_from(from) {
            sum = sum.and(term, at);
        }
        let (a, c) = sum.at_speed(piece, &self.tilt, at.speed);
        Force { a, b: Real::new(0.0), c }
    }

    /// The same where the law differs from piece to piece.
    #[inline(never)]
    fn balance_of(&self, from: &Moment<K>, at: &Moment<K>) -> Force<K> {
        let (rate, speed) = (self.rate(from, at), at.speed);
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

    /// The mean force on a stretch of a piece, from a place [m along the
    /// slope] and a time [s] on, that is left before a moment, and what it is
    /// beyond that.
    ///
    /// The stages are those of Kutta's method: with the force f0 at the
    /// beginning, that in the middle where f0 would lead, that at the end
    /// where 2 fm - f0 would.
    #[inline(always)]
    fn force_on(
        &self,
        piece: &Piece,
        [place, length]: [Real<K>; 2],
        pace: &Pace<K>,
        begins: Real<K>,
        moment: Option<Real<K>>,
    ) -> (Force<K>, Option<Defect<K>>) {
        let place = place + self.path.track.origin();
        let from = Moment { place, time: begins, speed: pace.u };
        let first = self.balance(piece, &from, &from);
        if !self.varies && !self.bends {
            return (first, None);
        }
        let mut lasts = first.lasts_about(pace, length);
        if let Some(moment) = moment {
            lasts = lasts.min(moment - begins);
        }
        if !(lasts.value() > 0.0 && lasts.value().is_finite()) {
            return (first, None);
        }
        let after = |part: f64, push: Real<K>| {
            let t = lasts * part;
            let speed = (pace.u + push * t).max(0.0);
            let place = from.place + (pace.u + speed) * t * 0.5;
            Moment { place, time: begins + t, speed }
        };
        let f0 = first.acceleration(pace.u);
        let at = after(0.5, f0);
        let middle = self.balance(piece, &from, &at);
        let to = after(1.0, middle.acceleration(at.speed) * 2.0 - f0);
        let last = self.balance(piece, &from, &to);
        let stages = [first, middle, last];
        let speeds = [pace.u, at.speed, to.speed];
        let (mean, defect) = Defect::of(stages, speeds, lasts);
        (mean, Some(defect))
    }

    /// When the leg ends at the latest: an added force changes, or has to be
    /// looked at again. That is at moments which do not depend on any
    /// parameter, so that derivatives are exact.
    fn latest(&self) -> Option<Real<K>> {
        let (time, step) = (self.begins.value(), self.step);
        let mut latest = f64::INFINITY;
        if step.is_finite() && !self.rests {
            latest = (((time + NEAR) / step).floor() + 1.0) * step;
        }
        if self.varies {
            latest = latest.min(self.forces.stair(Axis::Time, time));
        }
        match self.moment {
            Some(next) if next <= latest => Some(next),
            _ if latest.is_finite() => Some(Real::new(latest)),
            next => next,
        }
    }

    /// How far the leg reaches at most, and what is there.
    fn furthest(&self) -> (Real<K>, Border) {
        let piece = self.piece();
        let end = piece.start + piece.length;
        let (mut far, place) = (f64::INFINITY, self.place.value());
        if self.varies {
            let at = self.path.track.origin() + place;
            if end - place > self.forces.longest(Axis::Place, at) {
                far = self.forces.stair(Axis::Place, at)
                    - self.path.track.origin();
            }
        }
        match self.cut {
            Some(cut) if cut < end && cut <= far => (cut, Border::Place),
            _ if far < end => (Real::new(far), Border::Place),
            _ => (Real::new(end), Border::Piece),
        }
    }

    /// Finds the end of the leg that begins here and now.
    fn set_off(&mut self) -> Result<(), Stop> {
        if self.is_beyond_cut() {
            self.look_ahead();
        }
        let rested = std::mem::take(&mut self.rests);
        let (reach, border) = self.furthest();
        let length = reach - self.place;
        let moment = self.latest();
        self.ask(length, moment);
        if self.pace.u <= 0.0 && self.force.a <= 0.0 {
            if !rested {
                self.since = self.begins;
            }
            self.rests = true;
            self.wait(self.latest());
            return Ok(());
        }
        (self.arrives, self.border) = (reach, border);
        self.traverse(length);
        self.ends = (self.begins + self.after).value();
        self.end_by(moment)?;
        if self.ends == f64::INFINITY {
            // What is never over has no parabola.
            self.defect = None;
        }
        Ok(())
    }

    /// Asks for the force on the leg.
    #[inline(always)]
    fn ask(&mut self, length: Real<K>, moment: Option<Real<K>>) {
        if let Some(even) = &self.even {
            (self.force, self.defect) = (even.on(self.piece()), None);
            return;
        }
        let stretch = [self.place, length];
        let (pace, begins) = (&self.pace, self.begins);
        (self.force, self.defect) =
            self.force_on(self.piece(), stretch, pace, begins, moment);
    }

    /// Finds how a stretch ends if nothing ends it before.
    #[inline(always)]
    fn traverse(&mut self, length: Real<K>) {
        match self.force.traverse(self.pace, length) {
            End::Leaves { arrival, after } => {
                (self.arrival, self.after) = (arrival, after);
                if self.defect.is_some() {
                    self.mend(length);
                }
            }
            End::Stops { distance, after } => {
                self.stop(distance, length, after);
            }
            End::Never => {
                self.after = Real::new(f64::INFINITY);
                self.border = Border::Nothing;
            }
        }
    }

    /// Whether nothing but the speed will change the forces any more.
    fn is_steady(&self) -> bool {
        let last = self.index + 1 == self.path.track.pieces().len();
        let at = self.path.track.origin() + self.place.value();
        let stairs = self
            .forces
            .stair(Axis::Place, at)
            .min(self.forces.stair(Axis::Time, self.begins.value()));
        let cut = self.cut.is_some() || self.moment.is_some();
        last && !cut && stairs == f64::INFINITY
    }

    /// Whether a mass whose force depends on its speed alone is not braked: then
    /// it never will be.
    fn never_brakes(&self) -> bool {
        !self.rests && self.state(self.begins).acceleration > -NO_BRAKING
    }

    /// Adds to the arrival what the force is beyond its mean.
    #[inline(never)]
    fn mend(&mut self, length: Real<K>) {
        let Some(defect) = &mut self.defect else { return };
        defect.lasts = self.after;
        match defect.mended(&self.force, self.arrival, self.after) {
            Some((arrival, after)) => {
                (self.arrival, self.after) = (arrival, after);
            }
            None => self.stop(length, length, self.after),
        }
    }

    /// Ends the leg at rest, before its far border.
    fn stop(&mut self, distance: Real<K>, length: Real<K>, after: Real<K>) {
        let mut covered = distance;
        if let Some(defect) = &mut self.defect {
            defect.lasts = after;
            covered += defect.distance(after);
        }
        self.arrives = self.place + covered.min(length - NEAR).max(0.0);
        self.arrival = Pace::new(Real::new(0.0));
        self.after = after;
        self.border = Border::Rest;
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

    /// How the next piece is entered.
    #[inline(always)]
    fn entry(&self) -> Entry<K> {
        let begins = self.begins + self.after;
        Entry { index: self.index + 1, pace: self.arrival, begins }
    }

    /// `time`, or when a force changes before that.
    fn until(&self, time: f64) -> f64 {
        self.moment.map_or(time, |m| m.value().min(time))
    }

    /// Crosses whole pieces until one holds `time`, or something else than
    /// its border ends the leg, where no force varies.
    #[inline(always)]
    fn skim_even(&mut self, time: f64) -> Result<(), Stop> {
        let Some(even) = &self.even else { return self.advance() };
        let (mut entry, until) = (self.entry(), self.until(time));
        let (track, whole) = (self.path.track, self.whole);
        let crossing = self.ahead.skim(track, even, &mut entry, whole, until);
        self.defect = None;
        self.enter(entry, crossing)
    }

    /// The same where some do.
    #[inline(never)]
    fn skim_varying(&mut self, time: f64) -> Result<(), Stop> {
        let (step, origin) = (self.step, self.path.track.origin());
        let mut beyond = None;
        let cross = |piece: &Piece, Entry { pace, begins, .. }: &Entry<K>| {
            beyond = None;
            let [place, length] = [piece.start, piece.length].map(Real::new);
            let on = [place, length];
            let (force, defect) =
                self.force_on(piece, on, pace, *begins, self.moment);
            let time = begins.value();
            let span = step.min(self.forces.longest(Axis::Time, time));
            let far = self.forces.longest(Axis::Place, origin + piece.start);
            let crossed = force.cross(*pace, length).filter(|(_, after)| {
                piece.length <= far && after.value() <= span
            });
            let Some((arrival, after)) = crossed else { return (force, None) };
            let Some(mut defect) = defect else { return (force, crossed) };
            defect.lasts = after;
            beyond = Some(defect);
            (force, defect.mended(&force, arrival, after))
        };
        let (pieces, until) = (self.path.track.pieces(), self.until(time));
        let (entry, crossing) =
            skim(pieces, self.entry(), self.whole, until, cross);
        self.defect = beyond;
        self.enter(entry, crossing)
    }

    /// Enters a piece, and crosses it if that is known.
    #[inline(always)]
    fn enter(
        &mut self,
        entry: Entry<K>,
        crossing: Option<Crossing<K>>,
    ) -> Result<(), Stop> {
        self.index = entry.index;
        (self.pace, self.begins) = (entry.pace, entry.begins);
        let piece = self.piece();
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
        if let Some(defect) = &mut self.defect {
            defect.lasts = self.after;
        }
        let State { speed, distance, .. } = self.state(moment);
        (self.arrival, self.arrives) = (Pace::new(speed.max(0.0)), distance);
        self.border = Border::Time;
        self.ends = moment.value();
    }

    /// At rest, until a force changes with time if one ever does.
    fn wait(&mut self, moment: Option<Real<K>>) {
        let zero = Real::new(0.0);
        self.pace = Pace::new(zero);
        self.force = Force { a: zero, b: zero, c: zero };
        self.defect = None;
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
        let speed = self.force.speed_after(self.pace.u, after);
        let Some(defect) = &self.defect else { return speed };
        (speed + defect.speed(after)).max(0.0)
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
        let mut state = State {
            speed,
            distance: self.place + covered,
            acceleration: self.force.acceleration(speed),
        };
        if let Some(defect) = &self.defect {
            let speed = (speed + defect.speed(after)).max(0.0);
            state.speed = speed;
            state.distance += defect.distance(after);
            state.acceleration =
                self.force.acceleration(speed) + defect.force(after);
        }
        state
    }
}

/// The step of the forces, halved until it suits how stiff they and the law are.
fn step<K: Kind>(forces: &Forces<K>, law: f64) -> f64 {
    let stiffness = law + forces.stiffness();
    let mut step = forces.step;
    for _ in 0..MOST_HALVED {
        if step * stiffness <= STIFF {
            break;
        }
        step *= 0.5;
    }
    step
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
    fn leap(&mut self, time: f64) -> Result<(), Stop> {
        if self.border != Border::Piece || self.base.is_none() {
            self.advance()
        } else if self.even.is_some() {
            self.skim_even(time)
        } else {
            self.skim_varying(time)
        }
    }

    fn speed_at(&mut self, time: f64) -> Result<Real<K>, Stop> {
        Ok(self.speed(Real::new(time)))
    }

    fn state_at(&mut self, time: f64) -> Result<State<K>, Stop> {
        Ok(self.state(Real::new(time)))
    }

    fn at_rest(&self) -> Option<Rest<K>> {
        let for_good = self.rests && self.border == Border::Nothing;
        for_good.then_some(Rest { time: self.since, distance: self.place })
    }

    fn is_endless(&self) -> bool {
        let never_ends = self.ends == f64::INFINITY;
        never_ends || self.is_steady() && self.never_brakes()
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
        let state = if speed_only {
            let zero = Real::new(0.0);
            let speed = walker.speed(time);
            State { speed, distance: zero, acceleration: zero }
        } else {
            walker.state(time)
        };
        // A force that drives the mass the more the faster it is may have
        // taken it beyond every number, and back from the other side.
        let is_motion =
            state.speed.value() > -1e-6 && state.distance.value().is_finite();
        if !is_motion {
            return Err(Stop::Reject("the motion is not a finite number"));
        }
        visit(state);
    }
    Ok(())
}

/// Follows the motion under law and forces until the mass rests; `None` if it
/// never does.
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
