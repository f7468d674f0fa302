//! Many parameter sets at once, one motion each: eight side by side.
//!
//! Where the rates of a law are the same along the whole track and a leg can
//! only end at a border or at rest, motions under different values cross the
//! same pieces with the same formulas (those of `exact`). Eight of them are
//! worked out as the lanes of one vector: plain loops over `[f64; 8]`, which
//! the compiler turns into vector instructions of the machine it builds for
//! (`-C target-cpu=native`). The results are the same to round-off without.
//!
//! A lane leaves the others where it meets anything but a border: a stop, a
//! slope without end, a number that is none. It goes on from there as every
//! other motion does.

#![allow(
    clippy::needless_range_loop,
    reason = "loops over an index become vectors, chains of iterators do not"
)]

use super::eight::{EIGHT, Eight, atanhc, expc, tanhc};
use super::exact::{FAR, Pace};
use super::friction::{Friction, Rate};
use super::motion::{Path, Release, State, first_piece};
use super::sample::sample;
use super::track::Piece;
use super::walk::{Standing, sample_from};
use crate::error::Stop;
use crate::scalar::{Plain, Real};

/// How many motions are solved side by side.
const LANES: usize = EIGHT;

/// One number for each lane.
type Lanes = Eight;

/// After how many pieces it is asked whether all lanes have seen their last
/// time.
const PAUSE: usize = 8;

/// The speeds \[m/s\] at increasing `times` \[s\] under each of many laws, in
/// their order: what [`sample`] gives for each, to round-off.
///
/// [`Stop::Reject`] stands where a law has no flow with its values.
pub fn speeds<L: Friction<Plain>>(
    path: &Path<'_>,
    laws: &[L],
    release: Release<Plain>,
    times: &[f64],
) -> Vec<Result<Vec<f64>, Stop>> {
    let mut legs = Legs::default();
    let mut all = Vec::with_capacity(laws.len());
    for laws in laws.chunks(LANES) {
        side_by_side(path, laws, release, times, &mut legs, &mut all);
    }
    all
}

/// The same of at most eight laws.
fn side_by_side<L: Friction<Plain>>(
    path: &Path<'_>,
    laws: &[L],
    release: Release<Plain>,
    times: &[f64],
    legs: &mut Legs,
    all: &mut Vec<Result<Vec<f64>, Stop>>,
) {
    let alone = |law| {
        let mut speeds = Vec::with_capacity(times.len());
        let visit = |s: State<Plain>| speeds.push(s.speed.value());
        sample(path, law, release, times, true, visit).map(|()| speeds)
    };
    let rates: Option<Vec<_>> = laws.iter().map(|l| plain(path, l)).collect();
    let (Some(rates), Ok((index, within))) =
        (rates, first_piece(path, &release))
    else {
        all.extend(laws.iter().map(alone));
        return;
    };
    let until = times.last().copied().unwrap_or(0.0);
    let common = Common::of(&rates);
    let pieces = path.track.pieces();
    legs.cross(pieces, &common, (index, within.value(), release), until);
    let mut found: [Vec<f64>; LANES] =
        std::array::from_fn(|_| Vec::with_capacity(times.len()));
    legs.read(pieces, &common, times, &mut found);
    for ((lane, law), mut speeds) in laws.iter().enumerate().zip(found) {
        let rest = &times[speeds.len()..];
        let from = legs.left[lane].filter(|_| !rest.is_empty());
        let visit = |s: State<Plain>| speeds.push(s.speed.value());
        let done = from
            .map_or(Ok(()), |from| sample_from(path, law, from, rest, visit));
        all.push(done.map(|()| speeds));
    }
}

/// A law's rates, where they are the same everywhere and leave nothing to
/// meet but borders and stops.
fn plain<L: Friction<Plain>>(path: &Path<'_>, law: &L) -> Option<Rate<Plain>> {
    if path.steps().is_some() {
        return None;
    }
    let rate = path.uniform(law, 0, 0.0)?;
    let zero = |x: Real<Plain>| x.value() == 0.0;
    (zero(rate.pressed) && zero(rate.linear)).then_some(rate)
}

/// What the law of each lane is made of: du/dt = pull - mu load - constant
/// - c u^2.
#[derive(Clone, Copy)]
struct Common {
    mu: Lanes,
    constant: Lanes,
    c: Lanes,
}

impl Common {
    /// Of at most eight rates; lanes left over repeat the first.
    fn of(rates: &[Rate<Plain>]) -> Self {
        let of = |part: fn(&Rate<Plain>) -> Real<Plain>| {
            std::array::from_fn(|lane| {
                rates
                    .get(lane)
                    .or(rates.first())
                    .map_or(0.0, |r| part(r).value())
            })
        };
        Self {
            mu: of(|r| r.mu),
            constant: of(|r| r.constant),
            c: of(|r| r.quadratic + r.growth),
        }
    }

    /// The steady part of the force on a piece.
    #[inline(always)]
    fn pull(&self, piece: &Piece, lane: usize) -> f64 {
        piece.pull - self.mu[lane] * piece.load - self.constant[lane]
    }
}

/// The legs of eight motions: when and how fast each reaches each border.
#[derive(Default)]
struct Legs {
    /// The piece that the first leg is on.
    first: usize,
    /// Where the lanes are at the beginning of each leg. Longer than needed:
    /// it is kept for the next eight.
    fronts: Vec<Front>,
    /// How many legs of each lane end at a border.
    whole: [usize; LANES],
    /// Where each lane left the others.
    left: [Option<Standing<Plain>>; LANES],
}

/// Where eight motions are at a border: speed, its square, which the solution
/// over distance needs, and time.
#[derive(Clone, Copy)]
struct Front {
    u: Lanes,
    w: Lanes,
    t: Lanes,
}

impl Legs {
    /// Crosses pieces until all lanes are past `until` or have left.
    fn cross(
        &mut self,
        pieces: &[Piece],
        common: &Common,
        (first, within, release): (usize, f64, Release<Plain>),
        until: f64,
    ) {
        let mut front = Front::of(release.speed.value());
        let mut going = [true; LANES];
        let mut running = *common;
        self.first = first;
        self.left = [None; LANES];
        self.fronts.resize(pieces.len().max(self.fronts.len()), front);
        self.fronts[0] = front;
        // The last piece has no end.
        let finite = &pieces[first..pieces.len() - 1];
        let mut legs = finite.len();
        for (i, piece) in finite.iter().enumerate() {
            let skipped = if i == 0 { within } else { 0.0 };
            let length = piece.length - skipped;
            if front.step(piece, length, &running) {
                let over = |l| front.is_over(&running, length, l);
                self.part(over, (i, skipped), &mut going);
                if !front.close_ranks(&mut running, &going) {
                    return;
                }
            }
            self.fronts[i + 1] = front;
            if i % PAUSE == PAUSE - 1 && front.is_past(until) {
                legs = i + 1;
                break;
            }
        }
        self.end(legs, &going);
    }

    /// The lanes that still go on stand at the same border.
    fn end(&mut self, legs: usize, going: &[bool; LANES]) {
        for lane in (0..LANES).filter(|&lane| going[lane]) {
            self.whole[lane] = legs;
            self.left[lane] = Some(self.standing(legs, 0.0, lane));
        }
    }

    fn standing(
        &self,
        leg: usize,
        within: f64,
        lane: usize,
    ) -> Standing<Plain> {
        let Front { u, w, t } = &self.fronts[leg];
        let pace = Pace { u: u[lane].into(), w: w[lane].into() };
        let (index, within) = (self.first + leg, within.into());
        Standing { index, within, begins: t[lane].into(), pace }
    }

    /// Lets the lanes leave that met something else than a border.
    #[cold]
    fn part(
        &mut self,
        over: impl Fn(usize) -> bool,
        (leg, within): (usize, f64),
        going: &mut [bool; LANES],
    ) {
        for lane in 0..LANES {
            if going[lane] && !over(lane) {
                going[lane] = false;
                self.whole[lane] = leg;
                self.left[lane] = Some(self.standing(leg, within, lane));
            }
        }
    }

    /// The speeds at increasing times, as far as each lane's legs reach.
    fn read(
        &self,
        pieces: &[Piece],
        common: &Common,
        times: &[f64],
        found: &mut [Vec<f64>; LANES],
    ) {
        let mut legs = [0; LANES];
        for &time in times {
            let (mut a, mut u, mut after) =
                ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for lane in 0..LANES {
                let mut leg = legs[lane];
                while leg < self.whole[lane]
                    && self.fronts[leg + 1].t[lane] <= time
                {
                    leg += 1;
                }
                legs[lane] = leg;
                a[lane] = common.pull(&pieces[self.first + leg], lane);
                u[lane] = self.fronts[leg].u[lane];
                after[lane] = time - self.fronts[leg].t[lane];
            }
            let speeds = speeds_after(&a, &common.c, &u, &after);
            for lane in 0..LANES {
                if legs[lane] < self.whole[lane] {
                    found[lane].push(speeds[lane]);
                }
            }
        }
    }
}

impl Front {
    /// The release: at t = 0 with speed `u`.
    fn of(u: f64) -> Self {
        Self { u: [u; LANES], w: [u * u; LANES], t: [0.0; LANES] }
    }

    fn is_past(&self, time: f64) -> bool {
        self.t.iter().all(|t| *t > time)
    }

    /// Goes on over one piece, as `Force::cross`; whether a lane met
    /// something else than its border.
    #[inline(always)]
    fn step(&mut self, piece: &Piece, length: f64, law: &Common) -> bool {
        let mut x = [0.0; LANES];
        for l in 0..LANES {
            x[l] = law.c[l] * length * 2.0;
        }
        let (ratio, _) = expc(&x, false);
        let (mut q, mut z) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            let spread = ratio[l] * length * 2.0;
            let a = law.pull(piece, l);
            let decay = 1.0 - law.c[l] * spread;
            self.w[l] = self.w[l] * decay + a * spread;
            let u = self.w[l].sqrt();
            q[l] = spread / (u + self.u[l] * decay);
            self.u[l] = u;
            z[l] = a * law.c[l] * q[l] * q[l];
        }
        let (slowed, _) = atanhc(&z, false);
        for l in 0..LANES {
            self.t[l] += q[l] * slowed[l];
        }
        // A loop of its own: together they are not made vectors of.
        let mut all = true;
        for l in 0..LANES {
            all &= (self.w[l] > 0.0) & (x[l].abs() <= FAR);
            all &= self.t[l] < f64::INFINITY;
        }
        !all
    }

    /// Whether a lane came over a piece of this length and stands at its
    /// border.
    fn is_over(&self, law: &Common, length: f64, lane: usize) -> bool {
        let x = law.c[lane] * length * 2.0;
        self.w[lane] > 0.0 && x.abs() <= FAR && self.t[lane] < f64::INFINITY
    }

    /// Lanes that have left take on law and state of one that goes on, so
    /// that they meet nothing more; false where none does.
    #[cold]
    fn close_ranks(
        &mut self,
        law: &mut Common,
        going: &[bool; LANES],
    ) -> bool {
        let Some(on) = going.iter().position(|g| *g) else { return false };
        for lane in (0..LANES).filter(|&lane| !going[lane]) {
            for numbers in [
                &mut self.u,
                &mut self.w,
                &mut self.t,
                &mut law.mu,
                &mut law.constant,
                &mut law.c,
            ] {
                numbers[lane] = numbers[on];
            }
        }
        true
    }
}

/// `Force::speed_after` on each lane.
#[inline(always)]
fn speeds_after(a: &Lanes, c: &Lanes, u: &Lanes, t: &Lanes) -> Lanes {
    let mut z = [0.0; LANES];
    for l in 0..LANES {
        z[l] = a[l] * c[l] * t[l] * t[l];
    }
    let mut g = tanhc(&z);
    for l in 0..LANES {
        g[l] *= t[l];
    }
    let mut speeds = [0.0; LANES];
    for l in 0..LANES {
        speeds[l] = (a[l] * g[l] + u[l]) / (c[l] * u[l] * g[l] + 1.0);
    }
    speeds
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::physics::Track;
    use crate::physics::friction::{
        Cohesion, Sum, VelocityWeakening, Voellmy,
    };

    type Number = Real<Plain>;

    fn alone<L: Friction<Plain>>(
        path: &Path<'_>,
        law: &L,
        release: Release<Plain>,
        times: &[f64],
    ) -> Option<Vec<f64>> {
        let mut speeds = Vec::new();
        let visit = |s: State<Plain>| speeds.push(s.speed.value());
        let done = sample(path, law, release, times, true, visit);
        done.ok().map(|()| speeds)
    }

    /// Squared speeds are what the solution sums up: near a stop the speed
    /// itself has half of their digits. The tolerance is round-off over some
    /// hundred pieces.
    fn compare<L: Friction<Plain>>(
        path: &Path<'_>,
        laws: &[L],
        release: Release<Plain>,
        times: &[f64],
    ) {
        let all = speeds(path, laws, release, times);
        assert_eq!(all.len(), laws.len());
        for (found, law) in all.into_iter().zip(laws) {
            let expected = alone(path, law, release, times);
            assert_eq!(found.is_ok(), expected.is_some());
            let (found, expected) =
                (found.unwrap_or_default(), expected.unwrap_or_default());
            assert_eq!(found.len(), expected.len());
            let top = expected.iter().fold(1.0_f64, |a, u| a.max(u * u));
            for ((u, v), t) in found.iter().zip(&expected).zip(times) {
                let off = (u * u - v * v).abs();
                assert!(off < 2e-12 * top, "{u} {v} at {t} s");
            }
        }
    }

    proptest! {
        /// Tracks of steep and flat and rising pieces, short and long; laws
        /// with which some masses stop, some at once, some never.
        #[test]
        fn lanes_are_what_each_is_alone(
            steps in prop::collection::vec((0.3..40.0_f64, -0.5..1.2_f64), 1..60),
            values in prop::collection::vec(
                (-0.1..0.9_f64, 20.0..3000.0_f64, -1.0..3.0_f64), 1..20),
            start in (0.0..1.0_f64, prop_oneof![Just(0.0), 0.0..30.0_f64]),
            every in 0.05..3.0_f64,
        ) {
            let (mut x, mut z) = (vec![0.0], vec![0.0]);
            for (run, fall) in steps {
                x.push(x[x.len() - 1] + run);
                z.push(z[z.len() - 1] - run * fall);
            }
            let track = Track::from_points(&x, &z).unwrap();
            let path = Path::new(&track, 1.7);
            let number = Number::new;
            let laws: Vec<_> = values
                .into_iter()
                .map(|(mu, xi, k)| {
                    let friction = Voellmy { mu: number(mu), xi: number(xi) };
                    Sum::new(friction, Cohesion { cohesion: number(k) })
                })
                .collect();
            let release = Release {
                distance: number(start.0 * track.length()),
                speed: number(start.1),
            };
            let times: Vec<f64> =
                (0..60).map(|i| every * f64::from(i)).collect();
            compare(&path, &laws, release, &times);
        }
    }

    #[test]
    fn other_laws_and_impossible_ones_are_solved_one_by_one() {
        let track = Track::incline(30.0, 400.0).unwrap();
        let path = Path::new(&track, 1.0);
        let number = Number::new;
        let release = Release { distance: number(0.0), speed: number(2.0) };
        let times = [0.0, 1.0, 2.5, 9.0];
        let weakening = |mu| VelocityWeakening {
            mu: number(mu),
            r: number(0.6),
            u0: number(8.0),
        };
        compare(&path, &[0.2, 0.3].map(weakening), release, &times);
        let voellmy = |mu| Voellmy { mu: number(mu), xi: number(400.0) };
        compare(&path, &[0.2, f64::NAN, 0.9].map(voellmy), release, &times);
        let off = Release { distance: number(-1.0), ..release };
        compare(&path, &[0.2, 0.3].map(voellmy), off, &times);
        compare(&path, &[0.2].map(voellmy), release, &[]);
    }
}
