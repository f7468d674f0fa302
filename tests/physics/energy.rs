//! Energy and the textbook: no friction law adds energy, and laws give the
//! closed forms that they are known for.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use crate::terrain::any_track;
use couloir::Seed;
use couloir::physics::friction::{
    Cohesion, Coulomb, LAWS, LawSum, Pcm, Turbulent, Voellmy,
};
use couloir::physics::track::Piece;
use couloir::physics::{
    Friction, GRAVITY, Path, Release, Rest, Site, State, Sum, Track, Varies,
    rest, sample,
};
use couloir::prior::AnyPrior;
use couloir::scalar::{Plain, Real};
use couloir::seed::Rng;
use rand::RngExt;

fn n(value: f64) -> Real {
    Real::new(value)
}

fn release(distance: f64, speed: f64) -> Release<Plain> {
    Release { distance: n(distance), speed: n(speed) }
}

fn states(
    track: &Track,
    depth: f64,
    law: &impl Friction<Plain>,
    start: Release<Plain>,
    times: &[f64],
) -> Vec<State<Plain>> {
    let mut states = Vec::new();
    let path = Path::new(track, depth);
    sample(&path, law, start, times, false, |s| states.push(s)).unwrap();
    states
}

fn end(
    track: &Track,
    law: &impl Friction<Plain>,
    start: Release<Plain>,
) -> Option<Rest<Plain>> {
    rest(&Path::new(track, 1.0), law, start).unwrap()
}

/// Each law alone, and each beside Coulomb's, which those need that act
/// through mu.
fn sums() -> impl Iterator<Item = LawSum> {
    let alone = LAWS.iter().map(|&law| LawSum::from_iter([law]));
    let beside = LAWS.iter().map(|&law| LawSum::from_iter([LAWS[0], law]));
    alone.chain(beside)
}

/// Values of a sum's parameters from their default priors.
fn drawn(law: &LawSum, rng: &mut Rng) -> Vec<Real> {
    let fields = law.terms().iter().flat_map(|law| law.fields());
    fields
        .map(|field| {
            let prior = AnyPrior::parse(field.prior).unwrap();
            n(prior.draw(rng).unwrap())
        })
        .collect()
}

/// What a state may be wrong by, relative: round-off, or what the legs of an
/// integration, of 1e-12 each, add up to.
fn slack(law: &impl Friction<Plain>) -> f64 {
    if law.varies() == Varies::WithSpeed { 1e-8 } else { 1e-12 }
}

/// Kinetic and potential energy of a unit mass \[m2/s2\].
fn energy(track: &Track, state: &State<Plain>) -> f64 {
    let u = state.speed.value();
    let height = track.position(state.distance.value()).1;
    0.5 * u * u + GRAVITY * height
}

#[test]
fn no_law_adds_energy() {
    for (case, law) in sums().enumerate() {
        for part in 0..60 {
            let mut rng = Seed::new(21).child(case as u64).child(part).rng();
            let values = drawn(&law, &mut rng);
            let valued = law.with(&values);
            let track = any_track(&mut rng);
            let start = release(0.0, rng.random_range(0.0..60.0));
            let times: Vec<f64> =
                (0..400).map(|i| 0.1 * f64::from(i)).collect();
            let states = states(&track, 1.0, &valued, start, &times);
            let mut scale = 1e3;
            for pair in states.windows(2) {
                let [before, after] =
                    [&pair[0], &pair[1]].map(|s| energy(&track, s));
                scale = before.abs().max(after.abs()).max(scale);
                assert!(
                    after - before <= slack(&valued) * scale,
                    "{law} {values:?} {part}: {:e}",
                    after - before
                );
                assert!(pair[1].distance >= pair[0].distance.value() - 1e-9);
                assert!(pair[1].speed >= 0.0, "{law} {values:?}");
            }
        }
    }
}

/// The resistance of a law to a mass at rest on a piece, less the pull.
fn holds(law: &impl Friction<Plain>, piece: &Piece) -> f64 {
    let site = Site {
        distance: piece.start,
        pull: piece.pull,
        load: piece.load,
        curvature: piece.curvature,
        depth: 1.0,
    };
    let rate = law.rate(&site, n(0.0));
    rate.resistance(&site, n(0.0)).value() - piece.pull
}

#[test]
fn a_mass_stops_and_stays_where_friction_holds_it() {
    let mut stops = 0;
    for (case, law) in sums().enumerate() {
        for part in 0..60 {
            let mut rng = Seed::new(22).child(case as u64).child(part).rng();
            let values = drawn(&law, &mut rng);
            let valued = law.with(&values);
            let track = any_track(&mut rng);
            let start = release(0.0, rng.random_range(0.0..30.0));
            let Some(rest) = end(&track, &valued, start) else { continue };
            stops += 1;
            let (time, place) = (rest.time.value(), rest.distance.value());
            let piece = &track.pieces()[track.piece_at(place)];
            assert!(holds(&valued, piece) >= 0.0, "{law} {values:?} {part}");
            let after = [0.001, 1.0, 1e4].map(|late| time + late);
            for state in states(&track, 1.0, &valued, start, &after) {
                assert_eq!(state.speed, 0.0);
                assert_eq!(state.acceleration, 0.0);
                let moved = state.distance - place;
                assert_eq!(moved, 0.0, "{law} {values:?} {part}");
            }
        }
    }
    // Of 18 sums about half let the mass stop somewhere.
    assert!(stops > 300, "{stops}");
}

#[test]
fn where_friction_holds_a_mass_at_rest_never_starts() {
    for (case, law) in sums().enumerate() {
        for part in 0..60 {
            let mut rng = Seed::new(23).child(case as u64).child(part).rng();
            let values = drawn(&law, &mut rng);
            let valued = law.with(&values);
            let track = any_track(&mut rng);
            let piece = &track.pieces()[0];
            let rest = end(&track, &valued, release(0.0, 0.0));
            let rests = rest.is_some_and(|rest| rest.time == 0.0);
            let held = holds(&valued, piece) >= 0.0;
            assert_eq!(rests, held, "{law} {values:?} {part}");
        }
    }
}

#[test]
fn coulomb_turns_height_into_speed() {
    // v^2 = v0^2 + 2 g (drop - mu run): mu acts on the horizontal way.
    let mut rng = Seed::new(24).rng();
    let track = crate::terrain::random_track(&mut rng, 40, 20.0, (20.0, 40.0));
    let law = Coulomb { mu: n(0.25) };
    let times: Vec<f64> = (0..200).map(|i| 0.1 * f64::from(i)).collect();
    let (x0, z0) = track.position(5.0);
    for state in states(&track, 1.0, &law, release(5.0, 7.0), &times) {
        let (x, z) = track.position(state.distance.value());
        let w = 49.0 + 2.0 * GRAVITY * ((z0 - z) - 0.25 * (x - x0));
        let error = state.speed.value().powi(2) - w;
        // Round-off of w and of heights near 1000 m, times g.
        assert!(error.abs() <= 1e-11 * w.max(1e3), "{error:e}");
    }
}

#[test]
fn voellmy_reaches_its_terminal_speed() {
    for (angle, depth) in [(30.0, 1.0), (45.0, 2.5), (16.8, 0.5)] {
        let track = Track::incline(angle, 100.0).unwrap();
        let law = Voellmy { mu: n(0.3), xi: n(1000.0) };
        let piece = track.pieces()[0];
        let excess = piece.pull - 0.3 * piece.load;
        let terminal = (excess * 1000.0 * depth / GRAVITY).sqrt();
        for from in [0.0, terminal, 3.0 * terminal] {
            let start = release(0.0, from);
            let times = [1e5, 1e6];
            for state in states(&track, depth, &law, start, &times) {
                let error = state.speed.value() / terminal - 1.0;
                assert!(error.abs() < 1e-14, "{angle} {from}: {error:e}");
                assert!(state.acceleration.value().abs() < 1e-13);
            }
        }
    }
}

#[test]
fn free_fall_is_free() {
    let track = Track::incline(90.0, 60.0).unwrap();
    // On a wall Coulomb's friction has no load to act with.
    let law = Coulomb { mu: n(0.6) };
    let times = [0.5, 1.0, 3.0, 10.0];
    for (t, state) in
        times.iter().zip(states(&track, 1.0, &law, release(0.0, 2.0), &times))
    {
        let (u, s) = (2.0 + GRAVITY * t, 2.0 * t + 0.5 * GRAVITY * t * t);
        assert!((state.speed.value() - u).abs() < 1e-15 * 8.0 * u);
        assert!((state.distance.value() - s).abs() < 1e-15 * 8.0 * s);
        assert_eq!(state.acceleration, GRAVITY);
    }
}

/// Asserts that two laws give the same motion, to round-off.
fn same(
    (track, depth): (&Track, f64),
    one: &impl Friction<Plain>,
    other: &impl Friction<Plain>,
    what: &str,
) {
    let times: Vec<f64> = (0..100).map(|i| 0.5 * f64::from(i)).collect();
    let start = release(0.0, 12.0);
    let one = states(track, depth, one, start, &times);
    let other = states(track, depth, other, start, &times);
    for (a, b) in one.iter().zip(&other) {
        assert!((a.speed - b.speed).value().abs() < 1e-11, "{what}");
        assert!((a.distance - b.distance).value().abs() < 1e-10, "{what}");
    }
}

#[test]
fn laws_that_are_one_law_in_two_forms_agree() {
    for case in 0..100 {
        let mut rng = Seed::new(25).child(case).rng();
        let track = any_track(&mut rng);
        let mu = n(rng.random_range(0.1..0.5));
        let xi = n(rng.random_range(200.0..3000.0));
        let depth = rng.random_range(0.3..4.0);
        let voellmy = Voellmy { mu, xi };
        let pcm = Pcm { mu, md: xi * depth / GRAVITY };
        let sum = Sum::new(Coulomb { mu }, Turbulent { xi });
        same((&track, depth), &voellmy, &pcm, "xi h = g M/D");
        same((&track, depth), &voellmy, &sum, "coulomb + turbulent");
    }
}

#[test]
fn cohesion_stops_a_mass_on_the_flat_like_a_brake() {
    // 300 m of flat in three pieces: v^2/(2 k) on, after v/k.
    let track =
        Track::from_points(&[0.0, 20.0, 70.0, 300.0], &[5.0; 4]).unwrap();
    for (speed, k) in [(10.0, 2.0), (10.0, 0.4), (3.0, 2.0), (30.0, 0.1)] {
        let law = Cohesion { cohesion: n(k) };
        let rest = end(&track, &law, release(1.0, speed)).unwrap();
        let place = 1.0 + 0.5 * speed * speed / k;
        assert!((rest.distance.value() / place - 1.0).abs() < 1e-13);
        // The speed at the last border is a root: some digits go there.
        assert!((rest.time.value() * k / speed - 1.0).abs() < 1e-13);
    }
}
