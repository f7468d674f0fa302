//! How a case comes about: a ground, a law and starts on it, an effect that
//! fits, the motion, and what is read off it.

use rand::RngExt;
use rand_distr::{Distribution, Gamma, LogNormal};

use super::case::{Case, Coordinate, Interval, Mix, Recording, Truth};
use super::clock::{Clock, Rates};
use super::effects::{Effect, Kind, Nothing, Scene, Stretch, Void};
use super::errors::Instrument;
use super::files;
use super::ground::{Ground, Shape};
use super::moments::{Run, Start};
use super::motion::{Law, STEP, slide};
use super::scatter::{Errors, Scatter};
use super::visible::{Shown, baseline, baseline_under};
use crate::error::{Error, Result};
use crate::seed::{Rng, Seed};

/// The instrument's standard deviation \[m/s\]; of real errors, which differ
/// more from place to place.
const NOISE: (f64, f64) = (0.2, 0.4);
const REAL_NOISE: (f64, f64) = (0.1, 0.5);
/// The least friction coefficient that may act.
const LEAST_MU: f64 = 0.02;
/// How often a ground is drawn for an effect before there is none.
const TRIES: u64 = 5000;
/// How often an effect is fitted into the run that it makes.
const ROUNDS: usize = 12;
/// An avalanche: the least upper quartile of the baseline's speeds, and the
/// greatest speed with the effect \[m/s\].
const SPEEDS: (f64, f64) = (8.0, 65.0);
/// How fast every mass becomes with the effect, at the least \[m/s\]: under a
/// cohesion one may never move, and what is read off it is errors alone.
const MOVES: f64 = 3.0;
/// How much of the track below the release a baseline's recording covers, if
/// the mass does not come to rest.
const COVERED: f64 = 0.6;
/// The room above every release, so that one may be stated too low \[m\].
const HEADROOM: f64 = 45.0;

/// What a case is to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Order {
    pub(super) kind: &'static Kind,
    /// The effect's size; drawn where not given.
    pub(super) size: Option<f64>,
    /// The noise \[m/s\]; drawn where not given.
    pub(super) sd: Option<f64>,
    pub(super) mix: Mix,
    /// What real errors are like; the effect's own where not given.
    pub(super) scatter: Option<Scatter>,
}

impl Order {
    fn errors(&self) -> Errors {
        self.scatter.map_or(Errors::Simple, |_| Errors::Real)
    }

    /// From what to what the standard deviation is drawn \[m/s\].
    fn noise(&self) -> (f64, f64) {
        match self.errors() {
            Errors::Simple => NOISE,
            Errors::Real => REAL_NOISE,
        }
    }
}

/// Draws a case. The size comes first and is kept: no effect is drawn again
/// for being weak or strong, only the ground until the effect is possible.
pub(super) fn draw(order: &Order, name: &str, seed: Seed) -> Result<Case> {
    let mut rng = seed.child(0).rng();
    let drawn = [order.kind.size(&mut rng), order.kind.size(&mut rng)];
    let sizes = order.size.map_or(drawn, |size| [size; 2]);
    let (least, most) = order.noise();
    let noise: f64 = rng.random_range(least..most);
    let sd = order.sd.unwrap_or(noise);
    let draw = |scatter| Instrument::draw(scatter, sd, &mut rng);
    let instrument = order.scatter.map(draw);
    for attempt in 1..=TRIES {
        let seed = seed.child(attempt);
        if let Some(scenery) = Scenery::draw(order, sizes, seed)
            && let Some(case) = scenery.record(
                order,
                sizes[0],
                Noise { sd, instrument, ..Noise::default() },
                name,
                seed,
            )
        {
            return Ok(case);
        }
    }
    Err(Error::inference(format!(
        "{name}: no ground was found for {} of {}",
        order.kind.name, sizes[0]
    )))
}

/// Ground, law, effect and motion of a case that is possible.
struct Scenery {
    /// The track that the files have.
    survey: Ground,
    law: Law,
    depth: f64,
    effect: Box<dyn Effect>,
    /// Where the files say that the masses start \[m, horizontally\].
    releases: Vec<f64>,
    runs: Vec<(Run, Clock)>,
}

/// Ground, law and starts, before an effect is put in.
struct Stage {
    ground: Ground,
    law: Law,
    depth: f64,
    releases: Vec<f64>,
    plans: Vec<Clock>,
    /// How long a mass at rest is recorded \[s\].
    tail: f64,
}

impl Stage {
    fn draw(order: &Order, rng: &mut Rng) -> Option<Self> {
        let depth = (rng.random_range(1.0..3.0_f64) * 100.0).round() / 100.0;
        let law = draw_law(order.kind, depth, rng)?;
        let shape = Shape::ALL[rng.random_range(0..Shape::ALL.len())];
        if hides(shape, &law, order.kind.void) {
            return None;
        }
        let ground = Ground::draw(shape, rng);
        let width = ground.x[ground.x.len() - 1];
        let first = HEADROOM + rng.random_range(0.0..0.1) * width;
        let below = rng.random_range(0.08..0.2) * width;
        let releases = [first, first + below.max(25.0)]
            .into_iter()
            .take(order.mix.recordings())
            .map(|x| (x * 10.0).round() / 10.0)
            .collect::<Vec<_>>();
        let rates = Rates::of(order.errors());
        let plans = releases.iter().map(|_| Clock::draw(rates, rng)).collect();
        let tail = rng.random_range(0.0..1.5);
        Some(Self { ground, law, depth, releases, plans, tail })
    }

    /// The motions with an effect, each with the times at which it is
    /// recorded; nothing where a mass is too soon at rest or off the track.
    fn run(&self, effect: &dyn Effect) -> Option<Vec<(Run, Clock)>> {
        let masses = self.releases.iter().zip(&self.plans).enumerate();
        masses
            .map(|(which, (x, plan))| {
                let place = self.ground.along(*x);
                let stated = Start { place, speed: 0.0 };
                let start = effect.start(stated, which);
                // A clock may be late by some seconds.
                let until = plan.duration() + 2.0;
                let law = &self.law;
                let run = slide(&self.ground, law, effect, start, until, STEP);
                let late = effect.late(which).max(0.0);
                let seconds = self.recorded(&run, late);
                let clock = plan.within(seconds)?;
                Some((run, clock))
            })
            .collect()
    }

    /// How long a run can be recorded \[s\] by a clock that is late: a while
    /// after its stop, and not in the last tenth of the track.
    fn recorded(&self, run: &Run, late: f64) -> f64 {
        let from = run.place(0.0);
        let last = from + 0.9 * (self.ground.length() - from);
        let leaves = run.when(last).unwrap_or(f64::INFINITY);
        let rests = run.rest.map_or(f64::INFINITY, |t| t + self.tail);
        (leaves - late).min(rests)
    }

    /// Whether the recordings are of avalanches and not of their beginnings:
    /// up to the stop, or over most of the track.
    fn covered(&self, runs: &[(Run, Clock)]) -> bool {
        runs.iter().all(|(run, clock)| {
            let (from, end) = (run.place(0.0), clock.duration());
            let share =
                (run.place(end) - from) / (self.ground.length() - from);
            share >= COVERED || run.rest.is_some_and(|rest| rest <= end)
        })
    }

    fn scene(&self, sizes: [f64; 2], runs: &[(Run, Clock)]) -> Scene<'_> {
        let mut speeds: Vec<f64> = runs
            .iter()
            .flat_map(|(run, clock)| clock.times().map(|t| run.speed(t)))
            .collect();
        speeds.sort_by(f64::total_cmp);
        let least = |of: &dyn Fn(&(Run, Clock)) -> f64| {
            runs.iter().map(of).fold(f64::INFINITY, f64::min)
        };
        Scene {
            size: sizes[0],
            other: sizes[1],
            ground: &self.ground,
            upper: speeds[3 * speeds.len() / 4],
            top: least(&|(run, _)| run.place(0.0)),
            from: -least(&|(run, _)| -run.place(0.0)),
            to: least(&|(run, clock)| run.place(clock.duration())),
            duration: least(&|(_, clock)| clock.duration()),
        }
    }
}

/// Whether a track hides an effect entirely.
fn hides(shape: Shape, law: &Law, void: Void) -> bool {
    let coulomb = matches!(law, Law::Coulomb { .. });
    let incline = shape == Shape::Incline;
    match void {
        Void::Never => false,
        Void::OnIncline => incline,
        Void::OnInclineUnderCoulomb => incline && coulomb,
        Void::WithoutBends => {
            matches!(shape, Shape::Incline | Shape::Parabola | Shape::Sigmoid)
        }
    }
}

/// The baseline, its parameters from the priors in the event's file, but for
/// their tails.
fn draw_law(kind: &Kind, depth: f64, rng: &mut Rng) -> Option<Law> {
    let mu: f64 = Gamma::new(9.0, 0.03).ok()?.sample(rng);
    let xi: f64 = LogNormal::new(6.9, 0.7).ok()?.sample(rng);
    let coulomb = rng.random_bool(0.5) || kind.coulomb_only;
    let usual = (0.12..0.5).contains(&mu) && (300.0..3500.0).contains(&xi);
    usual.then_some(if coulomb {
        Law::Coulomb { mu }
    } else {
        Law::Voellmy { mu, xi, depth }
    })
}

impl Scenery {
    /// Draws a ground and fits the effect into the run that it makes itself:
    /// its place within the distance run, its force at the speeds reached.
    fn draw(order: &Order, sizes: [f64; 2], seed: Seed) -> Option<Self> {
        let stage = Stage::draw(order, &mut seed.child(0).rng())?;
        let mut runs = stage.run(&Nothing)?;
        let slow = stage.scene(sizes, &runs).upper < SPEEDS.0;
        if slow || !stage.covered(&runs) {
            return None;
        }
        for _ in 0..ROUNDS {
            let scene = stage.scene(sizes, &runs);
            let mut rng = seed.child(1).rng();
            let effect = (order.kind.make)(&scene, &mut rng)?;
            let fresh = stage.run(&*effect)?;
            let settled = alike(&scene, &stage.scene(sizes, &fresh));
            runs = fresh;
            if settled {
                return possible(&*effect, &runs)
                    .then(|| Self::new(stage, effect, runs));
            }
        }
        None
    }

    fn new(
        stage: Stage,
        effect: Box<dyn Effect>,
        runs: Vec<(Run, Clock)>,
    ) -> Self {
        let Stage { ground, law, depth, releases, .. } = stage;
        let (survey, releases) = match effect.survey(&ground) {
            None => (ground, releases),
            Some(survey) => {
                // A release is as far along the survey as along the ground.
                let moved = |x: &f64| survey.across(ground.along(*x));
                let releases = releases.iter().map(moved).collect();
                (survey, releases)
            }
        };
        Self { survey, law, depth, effect, releases, runs }
    }

    /// The case; nothing if a recording would show more than the track has.
    fn record(
        &self,
        order: &Order,
        size: f64,
        mut noise: Noise,
        name: &str,
        seed: Seed,
    ) -> Option<Case> {
        let mut rng = seed.child(2).rng();
        let (mut recordings, mut shown) = (Vec::new(), Vec::new());
        for which in 0..self.runs.len() {
            let one = self.read(which, &mut noise, &mut rng);
            let room = self.survey.length() - one.from;
            if distance(&one.times, &one.values) > 0.98 * room {
                return None;
            }
            let folder = format!("{name}-{}", ["a", "b"][which % 2]);
            let sheet = files::Sheet {
                name: &folder,
                ground: &self.survey,
                release: self.releases[which],
                depth: self.depth,
                law: &self.law,
                times: &one.times,
                values: &one.values,
                is_real: noise.instrument.is_some(),
            };
            let files = sheet.files();
            recordings.push(Recording { folder, files });
            shown.push(one);
        }
        let best = noise.best(&self.survey, &self.law, &shown);
        let truth = self.truth(order.kind, size, &noise, best);
        Some(Case { name: name.to_owned(), truth, recordings })
    }

    /// What is read off a motion, with errors.
    fn read(&self, which: usize, noise: &mut Noise, rng: &mut Rng) -> Shown {
        let (run, clock) = &self.runs[which];
        let times: Vec<f64> = clock.times().collect();
        let read = |t: &f64| self.effect.read(run, *t, which);
        let clean: Vec<f64> = times.iter().map(read).collect();
        let errors = noise.draw(&*self.effect, &times, &clean, rng);
        let pairs = clean.iter().zip(&errors);
        let values = pairs.map(|(v, e)| v + e).collect();
        let from = self.survey.along(self.releases[which]);
        Shown { from, times, values }
    }

    /// `best`: the log likelihood of the best baseline.
    fn truth(
        &self,
        kind: &Kind,
        size: f64,
        noise: &Noise,
        best: f64,
    ) -> Truth {
        Truth {
            effect: kind.name,
            class: kind.class,
            interval: self.interval(),
            size,
            unit: kind.unit,
            scatter: noise.scatter(kind),
            noise_sd: noise.sd,
            noise_rms: (noise.squares / noise.count as f64).sqrt(),
            gain: noise.log_density - best,
        }
    }

    /// Where the effect acts, up to where the recordings end.
    fn interval(&self) -> Option<Interval> {
        let (run, clock) = self.runs.first()?;
        let greatest = |of: &dyn Fn(&(Run, Clock)) -> f64| {
            self.runs.iter().map(of).fold(0.0, f64::max)
        };
        match self.effect.stretch() {
            Stretch::Whole => None,
            Stretch::Time(from, to) => {
                let to = to.min(greatest(&|(_, c)| c.duration()));
                let coordinate = Coordinate::Time;
                let (time_from, time_to) = (from, to);
                Some(Interval { coordinate, from, to, time_from, time_to })
            }
            Stretch::Place(from, to) => {
                let to = to.min(greatest(&|(r, c)| r.place(c.duration())));
                let coordinate = Coordinate::Arclength;
                let when = |s| run.when(s).unwrap_or(f64::INFINITY);
                let [time_from, time_to] =
                    [from, to].map(|s| when(s).min(clock.duration()));
                Some(Interval { coordinate, from, to, time_from, time_to })
            }
        }
    }
}

/// The errors of all recordings of a case.
#[derive(Debug, Default)]
struct Noise {
    /// The instrument's standard deviation \[m/s\].
    sd: f64,
    /// What makes real errors.
    instrument: Option<Instrument>,
    /// The sum of squares \[m2/s2\].
    squares: f64,
    count: usize,
    log_density: f64,
}

impl Noise {
    /// The errors of one recording, which are noted.
    fn draw(
        &mut self,
        effect: &dyn Effect,
        times: &[f64],
        values: &[f64],
        rng: &mut Rng,
    ) -> Vec<f64> {
        let (errors, log_density) = if let Some(real) = self.instrument {
            let recorder = real.at(times);
            let errors = recorder.draw(rng);
            let log_density = recorder.log_density(&errors);
            (errors, log_density)
        } else {
            let errors = effect.noise(self.sd, values, rng);
            let log_density = effect.log_density(self.sd, &errors, values);
            (errors, log_density)
        };
        self.squares += errors.iter().map(|e| e * e).sum::<f64>();
        self.count += errors.len();
        self.log_density += log_density;
        errors
    }

    /// The greatest log likelihood that the baseline reaches.
    fn best(&self, ground: &Ground, law: &Law, all: &[Shown]) -> f64 {
        match self.instrument {
            None => baseline(ground, law, all),
            Some(real) => baseline_under(ground, law, all, real),
        }
    }

    fn scatter(&self, kind: &Kind) -> Scatter {
        let of_effect = Scatter::of_effect(kind.name);
        self.instrument.map_or(of_effect, |real| real.scatter)
    }
}

/// Whether an effect that is fitted into either scene is the same.
fn alike(a: &Scene<'_>, b: &Scene<'_>) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 0.02 * a.abs();
    near(a.upper, b.upper)
        && near(a.to - a.from, b.to - b.from)
        && near(a.duration, b.duration)
}

/// Whether friction is never next to nothing, every mass moves and none is
/// absurdly fast, and each is recorded in at least half of the stretch where
/// the effect acts.
fn possible(effect: &dyn Effect, runs: &[(Run, Clock)]) -> bool {
    let half = |from: f64, to: f64, end: f64| {
        let needed = if to.is_finite() { 0.5 * (to - from) } else { 0.0 };
        end > from + needed
    };
    runs.iter().all(|(run, clock)| {
        let end = clock.duration();
        let met = match effect.stretch() {
            Stretch::Whole => true,
            Stretch::Place(from, to) => half(from, to, run.place(end)),
            Stretch::Time(from, to) => {
                half(from, to, run.rest.map_or(end, |rest| rest.min(end)))
            }
        };
        let fastest = clock.times().map(|t| run.speed(t)).fold(0.0, f64::max);
        met && run.least_mu >= LEAST_MU
            && (MOVES..=SPEEDS.1).contains(&fastest)
    })
}

/// The distance that speeds show from rest \[m\], by the trapezoidal rule.
fn distance(times: &[f64], speeds: &[f64]) -> f64 {
    let (mut last, mut speed, mut all) = (0.0, 0.0, 0.0);
    for (t, v) in times.iter().zip(speeds) {
        all += 0.5 * (speed + v) * (t - last);
        (last, speed) = (*t, *v);
    }
    all
}
