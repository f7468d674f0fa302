//! Gradients of the motion against differences of eighth order, and the
//! density's continuity where they jump.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use crate::terrain::any_track;
use couloir::Seed;
use couloir::physics::friction::{
    Coulomb, Curvature, LAWS, LawSum, Laws, Voellmy,
};
use couloir::physics::{
    Friction, Path, Release, Sum, Track, Varies, rest, sample,
};
use couloir::prior::AnyPrior;
use couloir::scalar::{Grad, Kind, Plain, Real};
use couloir::seed::Rng;
use rand::RngExt;

type Dual = Grad<8>;

/// A motion as a function of numbers: the law's parameters, then the
/// distance and the speed at the release.
struct Problem {
    law: LawSum,
    track: Track,
    times: Vec<f64>,
    at: Vec<f64>,
    /// How large a step each number takes at most.
    sizes: Vec<f64>,
}

/// Speed, distance and acceleration at each time, then the time and the
/// place of rest; these are 0 where there is none.
fn outcome<K: Kind>(
    problem: &Problem,
    law: &impl Friction<K>,
    distance: Real<K>,
    speed: Real<K>,
) -> Vec<Real<K>> {
    let path = Path::new(&problem.track, 1.3);
    let start = Release { distance, speed };
    let mut all = Vec::new();
    sample(&path, law, start, &problem.times, false, |s| {
        all.extend([s.speed, s.distance, s.acceleration]);
    })
    .unwrap();
    let end = rest(&path, law, start).unwrap();
    let zero = Real::new(0.0);
    all.extend(end.map_or([zero, zero], |r| [r.time, r.distance]));
    all
}

impl Problem {
    fn plain(&self, at: &[f64]) -> Vec<f64> {
        let values: Vec<Real> = at.iter().map(|&x| Real::new(x)).collect();
        let (values, start) = values.split_at(at.len() - 2);
        outcome::<Plain>(self, &self.law.with(values), start[0], start[1])
            .into_iter()
            .map(Real::value)
            .collect()
    }

    fn dual(&self) -> Vec<Real<Dual>> {
        let variables = self.at.iter().enumerate();
        let values: Vec<Real<Dual>> =
            variables.map(|(i, &x)| Real::variable(x, i)).collect();
        let (values, start) = values.split_at(self.at.len() - 2);
        outcome::<Dual>(self, &self.law.with(values), start[0], start[1])
    }

    /// Central differences of eighth order along one number with steps h.
    fn difference(&self, along: usize, h: f64) -> Vec<f64> {
        const WEIGHTS: [f64; 4] =
            [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
        let mut total = vec![0.0; 3 * self.times.len() + 2];
        for (k, weight) in WEIGHTS.iter().enumerate() {
            for sign in [1.0, -1.0] {
                let mut at = self.at.clone();
                at[along] += sign * (k + 1) as f64 * h;
                for (sum, f) in total.iter_mut().zip(self.plain(&at)) {
                    *sum += sign * weight * f / h;
                }
            }
        }
        total
    }
}

/// What came of comparing.
#[derive(Debug, Default)]
struct Tally {
    compared: usize,
    /// Where the differences with different steps do not agree: a border's
    /// crossing passes a sample time within their reach.
    skipped: usize,
    worst: f64,
}

/// Steps as shares of a number's size. Errors of eighth order fall 400-fold
/// from one to the next, round-off doubles.
const STEPS: [f64; 6] = [0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125];

impl Tally {
    /// Compares every gradient with the difference whose steps agree best,
    /// where they agree to a tenth of `tolerance`.
    fn compare(&mut self, problem: &Problem, tolerance: f64) {
        let exact = problem.dual();
        for along in 0..problem.at.len() {
            let size = problem.sizes[along];
            let tables =
                STEPS.map(|step| problem.difference(along, step * size));
            for (i, f) in exact.iter().enumerate() {
                let column = tables.each_ref().map(|table| table[i]);
                // Below a thousandth of f over the number's size a slope is
                // lost in f's round-off.
                let floor = 1e-3 * f.value().abs() / size;
                self.judge(
                    &column,
                    f.partial(along),
                    floor,
                    tolerance,
                    || {
                        format!(
                            "{} {:?} {along} {i} of {}",
                            problem.law,
                            problem.at,
                            exact.len()
                        )
                    },
                );
            }
        }
    }

    fn judge(
        &mut self,
        column: &[f64],
        exact: f64,
        floor: f64,
        tolerance: f64,
        place: impl Fn() -> String,
    ) {
        let doubt = |pair: &[f64]| (pair[0] - pair[1]).abs();
        let best = column
            .windows(2)
            .min_by(|a, b| doubt(a).total_cmp(&doubt(b)))
            .unwrap();
        let scale = best[1].abs().max(floor);
        if scale.max(exact.abs()) == 0.0 {
            return;
        }
        // Large steps may agree by chance on both sides of a crest that the
        // mass just passes.
        let far = (best[1] - column[column.len() - 1]).abs();
        if doubt(best) > 0.1 * tolerance * scale || far > 0.01 * scale {
            self.skipped += 1;
            return;
        }
        let error = (exact - best[1]).abs() / scale.max(1e-300);
        assert!(
            error <= tolerance,
            "{}: {exact} instead of {} in {column:?}",
            place(),
            best[1]
        );
        self.worst = self.worst.max(error);
        self.compared += 1;
    }

    /// Most have to be compared, or the test would say nothing.
    fn assert_mostly_compared(&self) {
        assert!(self.skipped * 5 < self.compared, "{self:?}");
    }
}

/// The median of a field's default prior, as its size.
fn typical(prior: &str) -> f64 {
    AnyPrior::parse(prior).unwrap().quantile(0.5).unwrap()
}

fn problem(law: LawSum, rng: &mut Rng) -> Problem {
    let (mut at, mut sizes) = (Vec::new(), Vec::new());
    for field in law.terms().iter().flat_map(|law| law.fields()) {
        let prior = AnyPrior::parse(field.prior).unwrap();
        let value = prior.quantile(rng.random_range(0.1..0.9)).unwrap();
        at.push(value);
        sizes.push(value);
    }
    let track = any_track(rng);
    at.extend([
        track.length() * rng.random_range(0.1..0.5),
        rng.random_range(5.0..30.0),
    ]);
    sizes.extend([1.0, at[at.len() - 1]]);
    let times = (0..6).map(|_| rng.random_range(0.5..25.0));
    let mut times: Vec<f64> = times.collect();
    times.sort_by(f64::total_cmp);
    Problem { law, track, times, at, sizes }
}

/// Each law alone and beside Coulomb's, those that `wanted` admits.
fn sums(wanted: impl Fn(Varies) -> bool) -> Vec<LawSum> {
    LAWS.iter()
        .filter(|law| wanted(law.varies()))
        .flat_map(|&law| {
            [LawSum::from_iter([law]), LawSum::from_iter([LAWS[0], law])]
        })
        .collect()
}

#[test]
fn exact_laws_have_exact_gradients() {
    let mut tally = Tally::default();
    for (case, law) in
        sums(|varies| varies < Varies::WithSpeed).into_iter().enumerate()
    {
        for part in 0..40 {
            let mut rng = Seed::new(31).child(case as u64).child(part).rng();
            tally.compare(&problem(law.clone(), &mut rng), 1e-7);
        }
    }
    tally.assert_mostly_compared();
}

#[test]
fn sums_of_many_laws_have_exact_gradients() {
    let mut tally = Tally::default();
    let law = Laws::default()
        .parse("voellmy + cohesion + viscous + curvature + entrainment")
        .unwrap();
    for part in 0..100 {
        let mut rng = Seed::new(32).child(part).rng();
        tally.compare(&problem(law.clone(), &mut rng), 1e-7);
    }
    tally.assert_mostly_compared();
}

#[test]
fn integrated_laws_have_gradients_to_the_integrators_error() {
    // A leg's error is 1e-12, and a difference's step some 1 % of a number's
    // size: 1e-10 of a slope, times a few hundred legs.
    let mut tally = Tally::default();
    for (case, law) in
        sums(|varies| varies == Varies::WithSpeed).into_iter().enumerate()
    {
        for part in 0..6 {
            let mut rng = Seed::new(33).child(case as u64).child(part).rng();
            tally.compare(&problem(law.clone(), &mut rng), 1e-7);
        }
    }
    tally.assert_mostly_compared();
}

#[test]
fn amplitudes_of_zero_have_their_gradients() {
    // A mechanism that is off has a slope: what turning it on would do.
    let mut tally = Tally::default();
    for text in [
        "voellmy + viscous",
        "coulomb + viscous",
        "coulomb + entrainment",
        "coulomb + viscous + entrainment",
        "voellmy + curvature",
        "coulomb + curvature + entrainment + viscous",
        "voellmy + cohesion",
    ] {
        let law = Laws::default().parse(text).unwrap();
        for part in 0..30 {
            let mut rng = Seed::new(34).child(part).rng();
            let mut problem = problem(law.clone(), &mut rng);
            let own = law.terms()[0].fields().len();
            let fields = law.terms().iter().flat_map(|law| law.fields());
            for (i, field) in fields.enumerate().skip(own) {
                problem.at[i] = 0.0;
                problem.sizes[i] = 0.1 * typical(field.prior);
            }
            tally.compare(&problem, 1e-7);
        }
    }
    tally.assert_mostly_compared();
}

/// A slope that steepens from 5 to 60 degrees over 100 m, then runs out.
fn hump() -> Track {
    let (mut x, mut z) = (vec![0.0], vec![200.0]);
    let angles = (0..25).map(|i| 5.0 + 2.2 * f64::from(i)).chain([10.0; 40]);
    for (i, angle) in angles.enumerate() {
        x.push(x[i] + 4.0);
        z.push(z[i] - 4.0 * angle.to_radians().tan());
    }
    Track::from_points(&x, &z).unwrap()
}

#[test]
fn lifting_off_and_landing_carry_gradients() {
    let law = Laws::default().parse("coulomb + curvature").unwrap();
    let mut tally = Tally::default();
    for part in 0..40 {
        let mut rng = Seed::new(35).child(part).rng();
        let mut problem = problem(law.clone(), &mut rng);
        problem.track = hump();
        let n = problem.at.len();
        problem.at[1] = rng.random_range(0.8..1.5);
        problem.at[n - 2] = rng.random_range(5.0..9.0);
        problem.at[n - 1] = rng.random_range(15.0..30.0);
        problem.sizes[n - 1] = 15.0;
        tally.compare(&problem, 1e-7);
    }
    tally.assert_mostly_compared();
    // The mass does lift off there: the bed's friction is gone for a while.
    let track = hump();
    let path = Path::new(&track, 1.0);
    let n = Real::<Plain>::new;
    let law = Sum::new(Coulomb { mu: n(0.3) }, Curvature { c: n(1.0) });
    let start = Release { distance: n(5.0), speed: n(20.0) };
    let times: Vec<f64> = (1..100).map(|i| 0.1 * f64::from(i)).collect();
    let mut free = Vec::new();
    sample(&path, &law, start, &times, false, |s| {
        let piece = path.track.piece_at(s.distance.value());
        free.push(s.acceleration == path.track.pieces()[piece].pull);
    })
    .unwrap();
    assert!(free.contains(&true) && free.contains(&false));
}

/// The log density of speeds of 20 m/s recorded at some times, errors of
/// 1 m/s, under Voellmy's law; with the distance at the last time.
fn density(track: &Track, times: &[f64], mu: f64) -> (Real<Grad<4>>, f64) {
    let law = Voellmy { mu: Real::variable(mu, 0), xi: 1000.0.into() };
    let path = Path::new(track, 1.0);
    let start = Release { distance: 0.0.into(), speed: 5.0.into() };
    let (mut total, mut place) = (Real::new(0.0), 0.0);
    sample(&path, &law, start, times, false, |state| {
        total += -0.5 * (state.speed - 20.0).squared();
        place = state.distance.value();
    })
    .unwrap();
    (total, place)
}

#[test]
fn the_density_is_continuous_where_its_slope_jumps() {
    let track = Track::from_points(
        &[0.0, 60.0, 120.0, 200.0],
        &[90.0, 50.0, 20.0, 18.0],
    )
    .unwrap();
    for (border, last) in [(1, 5.5), (2, 9.0)] {
        let (border, times) = (track.pieces()[border].start, [1.0, 3.0, last]);
        // The mu at which the last sample falls on the border.
        let (mut low, mut high) = (0.0, 0.6);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let (_, place) = density(&track, &times, middle);
            if place > border { low = middle } else { high = middle }
        }
        assert!(density(&track, &times, 0.0).1 > border);
        let delta = 1e-9;
        let [(before, _), (after, _)] =
            [low - delta, low + delta].map(|mu| density(&track, &times, mu));
        let slopes = [before.partial(0), after.partial(0)];
        let jump = (after - before).value() - delta * (slopes[0] + slopes[1]);
        // Round-off of a sum of squares of about 300.
        assert!(jump.abs() < 1e-12, "{border}: {jump:e}");
        let kink = (slopes[0] - slopes[1]).abs() / slopes[0].abs();
        assert!(kink > 1e-3, "no kink at {border}: {slopes:?}");
    }
}
