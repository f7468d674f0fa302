//! The motion under laws outside the exact family, by Dormand and Prince.
//!
//! ode_solvers integrates plain numbers; derivatives ride along as further
//! components of the state (the sensitivity equations), and enter the times
//! at which a border or the stop is met through ds = u dt.

use nalgebra::SVector;
use ode_solvers::{Dopri5, OutputType, System};

use super::exact::{End, Force, Pace};
use super::friction::{Friction, Site};
use super::track::Piece;
use super::walk::{Path, Release, Rest, State, Walker, first_piece, site};
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// Relative and absolute tolerance of the integration (m, m/s, and the same
/// per unit of a parameter).
const TOLERANCE: f64 = 1e-12;

/// Braking below this \[m/s2\] is the integration's error about a terminal
/// speed.
const NO_BRAKING: f64 = 1e-9;

/// A leg is integrated over at most this time [s].
const LONGEST: f64 = 60.0;

/// The share of its time by which Newton's method may move a crossing; beyond
/// it, the crossing is bracketed.
const NEAR: f64 = 0.25;

/// The last move of a crossing [s], made to first order in it: what that
/// leaves out of a derivative is of the order of this share.
const LAST_MOVE: f64 = 1e-10;

/// How many components (s, u) and their derivatives take: two each.
pub(crate) const PLAIN: usize = 2;
/// Directions that are few: an integrator over as many as there can be would
/// carry more zeros than numbers.
pub(crate) const FEW: usize = 8;
/// The same with derivatives in few directions, and in up to sixteen.
pub(crate) const WITH_FEW: usize = 18;
pub(crate) const WITH_MANY: usize = 34;

/// The walker of laws that vary with the speed; a state has `N` components.
pub(crate) struct NumericWalker<'a, K: Kind, L, const N: usize> {
    pieces: &'a [Piece],
    depth: f64,
    law: &'a L,
    index: usize,
    within: Real<K>,
    begins: Real<K>,
    speed: Real<K>,
    end: End<K>,
    covers: Real<K>,
    /// Whether the leg ends at the border of its piece.
    arrives: bool,
    ends: f64,
    resting: bool,
    /// The last time asked for, from the leg's beginning, and the state then:
    /// times increase, so the next one is integrated from there.
    reached: (f64, SVector<f64, N>),
}

impl<'a, K: Kind, L: Friction<K>, const N: usize> NumericWalker<'a, K, L, N> {
    pub(crate) fn new(
        path: &Path<'a>,
        law: &'a L,
        release: Release<K>,
    ) -> Result<Self, Stop> {
        debug_assert!(N >= 2 * (1 + K::DIRECTIONS), "components");
        let (index, within) = first_piece(path, &release)?;
        let mut walker = Self {
            pieces: path.track.pieces(),
            depth: path.depth,
            law,
            index,
            within,
            begins: Real::new(0.0),
            speed: release.speed,
            end: End::Never,
            covers: Real::new(0.0),
            arrives: false,
            ends: f64::INFINITY,
            resting: false,
            reached: (0.0, SVector::zeros()),
        };
        walker.begin()?;
        Ok(walker)
    }

    fn site(&self) -> Site {
        site(&self.pieces[self.index], self.depth)
    }

    fn acceleration(&self, speed: Real<K>) -> Real<K> {
        acceleration(self.law, &self.site(), speed)
    }

    fn begin(&mut self) -> Result<(), Stop> {
        if self.speed <= 0.0 && self.acceleration(Real::new(0.0)) <= 0.0 {
            self.speed = Real::new(0.0);
            self.resting = true;
            self.ends = f64::INFINITY;
            return Ok(());
        }
        let length = Real::new(self.pieces[self.index].length) - self.within;
        self.reached = (0.0, pack(Real::new(0.0), self.speed));
        let guess = self.guess(length).min(LONGEST);
        let (last, y) = self.integrate(guess, Some(length.value()))?;
        self.find_end(length, last, &y)
    }

    /// About when the leg ends [s]; beyond the stop, so that the stop is
    /// bracketed.
    fn guess(&self, length: Real<K>) -> f64 {
        let frozen = |speed: Real<K>| {
            let a = self.acceleration(speed);
            let force = Force { a, b: Real::new(0.0), c: Real::new(0.0) };
            force.traverse(Pace::new(self.speed), length)
        };
        match frozen(self.speed) {
            // The force halfway makes it good to third order.
            End::Leaves { arrival, after } => {
                match frozen(0.5 * (self.speed + arrival.u)) {
                    End::Leaves { after, .. } => after.value(),
                    _ => after.value(),
                }
            }
            End::Stops { after, .. } => 1.5 * after.value(),
            End::Never => LONGEST,
        }
    }

    /// Which comes first after the integrated stretch: the border, the stop,
    /// or the end of the stretch itself. On a piece the speed rises or falls
    /// throughout, so that one look at the end of the stretch tells.
    fn find_end(
        &mut self,
        length: Real<K>,
        last: f64,
        y: &SVector<f64, N>,
    ) -> Result<(), Stop> {
        let border = length.value();
        let crossing = match self.approach(border, last, y)? {
            None if y[1] < 0.0 => {
                let (stop, at_stop) = self.root(last, |y| -y[1])?;
                if at_stop[0] < border {
                    self.stops(stop, &at_stop);
                    return Ok(());
                }
                Some(self.root(stop, |y| y[0] - border)?)
            }
            None if y[0] >= border => {
                Some(self.root(last, |y| y[0] - border)?)
            }
            near => near,
        };
        self.arrives = crossing.is_some();
        let Some((t, y)) = crossing else {
            let (s, speed) = unpack(y);
            self.leaves(speed, Real::new(last), s);
            return Ok(());
        };
        let (s, u) = unpack(&y);
        let after = Real::new(t) - (s - length) / u.value();
        let late = after - t;
        let speed = u + self.acceleration(u) * late;
        self.leaves(speed, after, length);
        Ok(())
    }

    fn leaves(&mut self, speed: Real<K>, after: Real<K>, covers: Real<K>) {
        self.end = End::Leaves { arrival: Pace::new(speed), after };
        self.covers = covers;
        self.ends = (self.begins + after).value();
    }

    fn stops(&mut self, t: f64, y: &SVector<f64, N>) {
        let (s, u) = unpack::<K, N>(y);
        let brake = self.acceleration(Real::new(0.0)).value();
        let after = Real::new(t) - u / brake;
        self.end = End::Stops { distance: s, after };
        self.covers = s;
        self.ends = (self.begins + after).value();
    }

    /// The time and state of crossing a border that lies close to where the stretch
    /// ends, by Newton's method; `None` where it does not.
    fn approach(
        &self,
        border: f64,
        last: f64,
        y: &SVector<f64, N>,
    ) -> Result<Option<(f64, SVector<f64, N>)>, Stop> {
        let (mut t, mut y) = (last, *y);
        for _ in 0..8 {
            let miss = (border - y[0]) / y[1];
            if !(y[1] > 0.0 && (t + miss - last).abs() < NEAR * last) {
                return Ok(None);
            }
            let speed = Real::new(y[1]);
            let brisk = self.acceleration(speed).value().abs() / y[1];
            if miss.abs() * brisk.max(1.0) < LAST_MOVE {
                return Ok(Some((t, y)));
            }
            t += miss;
            y = self.at(t)?;
        }
        Ok(None)
    }

    /// Integrates the leg over a time or, with a border, to just past that
    /// or the stop; the time reached and the state there.
    fn integrate(
        &self,
        time: f64,
        border: Option<f64>,
    ) -> Result<(f64, SVector<f64, N>), Stop> {
        let start = pack(Real::new(0.0), self.speed);
        self.motion(border).integrate(start, time)
    }

    fn motion(&self, border: Option<f64>) -> Motion<'a, K, L> {
        let kind = std::marker::PhantomData::<K>;
        Motion { law: self.law, site: self.site(), border, kind }
    }

    /// The state at local time `t`.
    fn at(&self, t: f64) -> Result<SVector<f64, N>, Stop> {
        self.integrate(t, None).map(|(_, y)| y)
    }

    /// The same, from the last time that was asked for.
    fn go_on_to(&mut self, t: f64) -> Result<SVector<f64, N>, Stop> {
        let (last, y) = self.reached;
        let (_, y) = if t >= last {
            self.motion(None).integrate(y, t - last)?
        } else {
            self.integrate(t, None)?
        };
        self.reached = (t, y);
        Ok(y)
    }

    /// Where a function of the state rises through 0 in (0, last].
    fn root(
        &self,
        last: f64,
        f: impl Fn(&SVector<f64, N>) -> f64,
    ) -> Result<(f64, SVector<f64, N>), Stop> {
        let value = |t: f64| self.at(t).map(|y| f(&y));
        let (mut a, mut fa) = (0.0, value(0.0)?);
        let (mut b, mut fb) = (last, value(last)?);
        let mut side = 0.0;
        // The false position, with the Illinois rule against a stuck end.
        for _ in 0..60 {
            let t = (a * fb - b * fa) / (fb - fa);
            if !(t > a && t < b) || b - a <= 1e-15 * last {
                break;
            }
            let ft = value(t)?;
            if ft == 0.0 {
                return Ok((t, self.at(t)?));
            }
            if ft < 0.0 {
                (a, fa) = (t, ft);
                fb *= if side < 0.0 { 0.5 } else { 1.0 };
            } else {
                (b, fb) = (t, ft);
                fa *= if side > 0.0 { 0.5 } else { 1.0 };
            }
            side = ft;
        }
        let t = if -fa < fb { a } else { b };
        Ok((t, self.at(t)?))
    }
}

impl<K: Kind, L: Friction<K>, const N: usize> Walker<K>
    for NumericWalker<'_, K, L, N>
{
    fn ends(&self) -> f64 {
        self.ends
    }

    fn advance(&mut self) -> Result<(), Stop> {
        match self.end {
            End::Leaves { arrival, after } => {
                self.begins += after;
                self.speed = arrival.u;
                self.within += self.covers;
                if self.arrives {
                    self.within = Real::new(0.0);
                    self.index += 1;
                }
            }
            End::Stops { after, .. } => {
                self.begins += after;
                self.within += self.covers;
                self.speed = Real::new(0.0);
            }
            End::Never => return Ok(()),
        }
        self.begin()
    }

    fn speed_at(&mut self, time: f64) -> Result<Real<K>, Stop> {
        self.state_at(time).map(|state| state.speed)
    }

    fn state_at(&mut self, time: f64) -> Result<State<K>, Stop> {
        let place = self.within + self.pieces[self.index].start;
        if self.resting {
            let zero = Real::new(0.0);
            return Ok(State {
                speed: zero,
                distance: place,
                acceleration: zero,
            });
        }
        let y = self.go_on_to(time - self.begins.value())?;
        let (s, u) = unpack::<K, N>(&y);
        // The leg began `late` later than its value says, in each direction.
        let late = self.begins - self.begins.value();
        let speed = u - self.acceleration(u) * late;
        Ok(State {
            speed,
            distance: place + s - u * late,
            acceleration: self.acceleration(speed),
        })
    }

    fn at_rest(&self) -> Option<Rest<K>> {
        self.resting.then(|| Rest {
            time: self.begins,
            distance: self.within + self.pieces[self.index].start,
        })
    }

    // Past the last border nothing but the speed changes the force: a mass
    // that does not brake here never will.
    fn is_endless(&self) -> bool {
        let last = self.index + 1 == self.pieces.len();
        last && self.acceleration(self.speed) > -NO_BRAKING
    }
}

fn acceleration<K: Kind, L: Friction<K>>(
    law: &L,
    site: &Site,
    speed: Real<K>,
) -> Real<K> {
    site.pull - law.rate(site, speed).resistance(site, speed)
}

/// (s, u) and their derivatives in one vector; what is left of it is 0.
fn pack<K: Kind, const N: usize>(s: Real<K>, u: Real<K>) -> SVector<f64, N> {
    SVector::from_fn(|i, _| {
        let number = if i % 2 == 0 { s } else { u };
        if i < 2 { number.value() } else { number.carried(i / 2 - 1) }
    })
}

fn unpack<K: Kind, const N: usize>(y: &SVector<f64, N>) -> (Real<K>, Real<K>) {
    let number = |k: usize| Real::carrying(y[k], |i| y[2 * (i + 1) + k]);
    (number(0), number(1))
}

/// The equations of motion on one piece.
struct Motion<'a, K, L> {
    law: &'a L,
    site: Site,
    /// Where the integration may end early; it then ends at the stop too.
    border: Option<f64>,
    kind: std::marker::PhantomData<K>,
}

impl<K: Kind, L: Friction<K>> Motion<'_, K, L> {
    /// The time reached and the state there.
    fn integrate<const N: usize>(
        self,
        start: SVector<f64, N>,
        time: f64,
    ) -> Result<(f64, SVector<f64, N>), Stop> {
        if time <= 0.0 {
            return Ok((0.0, start));
        }
        // The whole time is tried as one step: a piece is short.
        let (safety, beta, shrink, grow, steps) =
            (0.9, 0.04, 0.2, 10.0, 100_000);
        let mut solver = Dopri5::from_param(
            self,
            0.0,
            time,
            time,
            start,
            TOLERANCE,
            TOLERANCE,
            safety,
            beta,
            shrink,
            grow,
            time,
            time,
            steps,
            1000,
            OutputType::Sparse,
        );
        let done = solver.integrate();
        match (done, solver.x_out().last(), solver.y_out().last()) {
            (Ok(_), Some(t), Some(y)) if t.is_finite() => Ok((*t, *y)),
            _ => Err(Stop::Reject("the motion cannot be integrated")),
        }
    }
}

impl<K: Kind, L: Friction<K>, const N: usize> System<f64, SVector<f64, N>>
    for Motion<'_, K, L>
{
    fn system(&self, _: f64, y: &SVector<f64, N>, dy: &mut SVector<f64, N>) {
        let (_, u) = unpack::<K, N>(y);
        *dy = pack(u, acceleration(self.law, &self.site, u));
    }

    fn solout(
        &mut self,
        _: f64,
        y: &SVector<f64, N>,
        _: &SVector<f64, N>,
    ) -> bool {
        self.border.is_some_and(|border| y[0] >= border || y[1] < 0.0)
    }
}
