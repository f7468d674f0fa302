//! The motion under laws outside the exact family, by Dormand and Prince.
//!
//! ode_solvers integrates plain numbers; derivatives ride along as further
//! components of the state (the sensitivity equations), and enter the times
//! at which a border or the stop is met through ds = u dt.

use nalgebra::DVector;
use ode_solvers::continuous_output_model::ContinuousOutputModel;
use ode_solvers::dop_shared::IntegrationError;
use ode_solvers::{Dopri5, System};

use super::exact::{End, Pace};
use super::friction::{Friction, Site};
use super::track::Piece;
use super::walk::{Path, Release, Rest, State, Walker, first_piece, site};
use crate::error::Stop;
use crate::scalar::{Kind, Real};

/// Relative and absolute tolerance of the integration (m, m/s).
const TOLERANCE: f64 = 1e-10;

/// Braking below this \[m/s2\] is the integration's error about a terminal
/// speed.
const NO_BRAKING: f64 = 1e-9;

/// A leg is integrated over at most this time [s].
const LONGEST: f64 = 60.0;

/// The walker of laws that vary with the speed.
pub(crate) struct NumericWalker<'a, K: Kind, L> {
    pieces: &'a [Piece],
    depth: f64,
    law: &'a L,
    index: usize,
    within: Real<K>,
    begins: Real<K>,
    speed: Real<K>,
    output: ContinuousOutputModel<f64, DVector<f64>>,
    end: End<K>,
    covers: Real<K>,
    /// Whether the leg ends at the border of its piece.
    arrives: bool,
    ends: f64,
    resting: bool,
}

impl<'a, K: Kind, L: Friction<K>> NumericWalker<'a, K, L> {
    pub(crate) fn new(
        path: &Path<'a>,
        law: &'a L,
        release: Release<K>,
    ) -> Result<Self, Stop> {
        let (index, within) = first_piece(path, &release)?;
        let mut walker = Self {
            pieces: path.track.pieces(),
            depth: path.depth,
            law,
            index,
            within,
            begins: Real::new(0.0),
            speed: release.speed,
            output: ContinuousOutputModel::default(),
            end: End::Never,
            covers: Real::new(0.0),
            arrives: false,
            ends: f64::INFINITY,
            resting: false,
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
        let motion = Motion {
            law: self.law,
            site: self.site(),
            length: length.value(),
            kind: std::marker::PhantomData::<K>,
        };
        let start = pack(Real::new(0.0), self.speed);
        let (output, last) = motion.integrate(start)?;
        self.output = output;
        self.find_end(length, last);
        Ok(())
    }

    /// Which comes first after the integrated stretch: the border, the stop,
    /// or the end of the stretch itself.
    fn find_end(&mut self, length: Real<K>, last: f64) {
        let y = self.at(last);
        let stop = (y[1] < 0.0).then(|| self.root(last, |y| -y[1]));
        // Past its stop the integration runs backwards.
        let furthest = stop.unwrap_or(last);
        let border = (self.at(furthest)[0] >= length.value())
            .then(|| self.root(furthest, |y| y[0] - length.value()));
        self.arrives = false;
        let (end, covers) = match (border, stop) {
            (Some(t), _) => {
                let (s, u) = unpack(&self.at(t));
                let after = Real::new(t) - (s - length) / u.value();
                let late = after - t;
                let speed = u + self.acceleration(u) * late;
                self.arrives = true;
                (End::Leaves { arrival: Pace::new(speed), after }, length)
            }
            (None, Some(t)) => {
                let (s, u) = unpack(&self.at(t));
                let brake = self.acceleration(Real::new(0.0)).value();
                let after = Real::new(t) - u / brake;
                (End::Stops { distance: s, after }, s)
            }
            (None, None) => {
                let (s, speed) = unpack(&y);
                let arrival = Pace::new(speed);
                (End::Leaves { arrival, after: Real::new(last) }, s)
            }
        };
        let (End::Leaves { after, .. } | End::Stops { after, .. }) = end
        else {
            return;
        };
        self.end = end;
        self.covers = covers;
        self.ends = (self.begins + after).value();
    }

    /// The state at local time `t`, kept inside the integrated stretch.
    fn at(&self, t: f64) -> DVector<f64> {
        let (low, high) = self.output.bounds();
        let y = self.output.evaluate(t.clamp(low, high));
        y.unwrap_or_else(|| pack(Real::new(0.0), self.speed))
    }

    /// Where a function of the state rises through 0 in (0, last].
    fn root(&self, last: f64, f: impl Fn(&DVector<f64>) -> f64) -> f64 {
        let value = |t: f64| f(&self.at(t));
        let (mut a, mut fa) = (0.0, value(0.0));
        let (mut b, mut fb) = (last, value(last));
        let mut side = 0.0;
        // The false position, with the Illinois rule against a stuck end.
        for _ in 0..60 {
            let t = (a * fb - b * fa) / (fb - fa);
            if !(t > a && t < b) || b - a <= 1e-15 * last {
                break;
            }
            let ft = value(t);
            if ft == 0.0 {
                return t;
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
        if -fa < fb { a } else { b }
    }
}

impl<K: Kind, L: Friction<K>> Walker<K> for NumericWalker<'_, K, L> {
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

    fn speed_at(&self, time: f64) -> Real<K> {
        self.state_at(time).speed
    }

    fn state_at(&self, time: f64) -> State<K> {
        let place = self.within + self.pieces[self.index].start;
        if self.resting {
            let zero = Real::new(0.0);
            return State { speed: zero, distance: place, acceleration: zero };
        }
        let (s, u) = unpack::<K>(&self.at(time - self.begins.value()));
        // The leg began `late` later than its value says, in each direction.
        let late = self.begins - self.begins.value();
        let acceleration = self.acceleration(u);
        let speed = u - acceleration * late;
        State {
            speed,
            distance: place + s - u * late,
            acceleration: self.acceleration(speed),
        }
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

/// (s, u) and their derivatives in one vector.
fn pack<K: Kind>(s: Real<K>, u: Real<K>) -> DVector<f64> {
    DVector::from_fn(2 * (1 + K::DIRECTIONS), |i, _| {
        let number = if i % 2 == 0 { s } else { u };
        if i < 2 { number.value() } else { number.partial(i / 2 - 1) }
    })
}

fn unpack<K: Kind>(y: &DVector<f64>) -> (Real<K>, Real<K>) {
    let number = |k: usize| Real::assemble(y[k], |i| y[2 * (i + 1) + k]);
    (number(0), number(1))
}

/// The equations of motion on one piece.
struct Motion<'a, K, L> {
    law: &'a L,
    site: Site,
    length: f64,
    kind: std::marker::PhantomData<K>,
}

impl<K: Kind, L: Friction<K>> Motion<'_, K, L> {
    /// Integrates until the border is passed, the mass stops, or [`LONGEST`].
    fn integrate(
        self,
        start: DVector<f64>,
    ) -> Result<(ContinuousOutputModel<f64, DVector<f64>>, f64), Stop> {
        let mut output = ContinuousOutputModel::default();
        let mut solver = Dopri5::new(
            self, 0.0, LONGEST, LONGEST, start, TOLERANCE, TOLERANCE,
        );
        solver.integrate_with_continuous_output_model(&mut output).map_err(
            |error: IntegrationError| match error {
                IntegrationError::MaxNumStepReached { .. } => {
                    Stop::Reject("the integration takes too many steps")
                }
                _ => Stop::Reject("the integration's step became too small"),
            },
        )?;
        let last = output.bounds().1;
        Ok((output, last))
    }
}

impl<K: Kind, L: Friction<K>> System<f64, DVector<f64>> for Motion<'_, K, L> {
    fn system(&self, _: f64, y: &DVector<f64>, dy: &mut DVector<f64>) {
        let (_, u) = unpack::<K>(y);
        dy.copy_from(&pack(u, acceleration(self.law, &self.site, u)));
    }

    fn solout(&mut self, _: f64, y: &DVector<f64>, _: &DVector<f64>) -> bool {
        y[0] >= self.length || y[1] < 0.0
    }
}
