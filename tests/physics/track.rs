//! Tracks from surveys: distances, angles, curvature and what is refused.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use couloir::Seed;
use couloir::physics::{GRAVITY, Track};
use rand::RngExt;

/// A circle's arc as a valley of the given radius \[m\], on points 2 m apart
/// whose elevations are rounded to `grain` \[m\].
fn valley(radius: f64, points: u32, grain: f64) -> Track {
    let x: Vec<f64> = (0..points).map(|i| 2.0 * f64::from(i)).collect();
    let bottom = x[x.len() - 1] + 0.1 * radius;
    let z: Vec<f64> = x
        .iter()
        .map(|x| {
            let depth = (radius.powi(2) - (x - bottom).powi(2)).sqrt();
            ((radius - depth) / grain).round() * grain
        })
        .collect();
    Track::from_points(&x, &z).unwrap()
}

/// The largest error of the curvature in the middle 80 % of a track.
fn curvature_error(track: &Track, truth: f64) -> f64 {
    (100..900)
        .map(|i| track.length() * f64::from(i) / 1000.0)
        .map(|s| (track.curvature(s) - truth).abs())
        .fold(0.0, f64::max)
}

#[test]
fn curvature_survives_a_survey_rounded_to_centimetres() {
    // Rounding by +-5 mm (2.9 mm rms) at 2 m moves the fitted slope of 11
    // angles by 5e-5 rms; the largest of some 40 independent windows stays
    // below four times that. Unsmoothed it would be 2e-3.
    let track = valley(200.0, 80, 0.01);
    let error = curvature_error(&track, 1.0 / 200.0);
    assert!(error < 2e-4, "{error:e}");
}

#[test]
fn curvature_keeps_its_digits_on_ten_thousand_points() {
    // Running sums of s^2 reach 1e12 m3, of which the last digit is 1e-4:
    // 1e-8 of a window's own sum, times angles of up to half a radian.
    let track = valley(60_000.0, 10_000, 1e-12);
    let error = curvature_error(&track, 1.0 / 60_000.0);
    assert!(error < 1e-6, "{error:e}");
}

#[test]
fn few_long_pieces_have_the_curvature_of_their_neighbours() {
    // Pieces longer than the window: angles 40, 30 and 20 degrees.
    let slope = |degrees: f64| degrees.to_radians().tan();
    let x = [0.0, 100.0, 200.0, 300.0];
    let mut z = [500.0; 4];
    for (i, angle) in [40.0, 30.0, 20.0].into_iter().enumerate() {
        z[i + 1] = z[i] - 100.0 * slope(angle);
    }
    let track = Track::from_points(&x, &z).unwrap();
    let pieces = track.pieces();
    let middle = |i: usize| pieces[i].start + 0.5 * pieces[i].length;
    let turn = 10.0_f64.to_radians();
    for (i, j) in [(0, 1), (2, 1)] {
        let truth = turn / (middle(i) - middle(j)).abs();
        assert!((pieces[i].curvature / truth - 1.0).abs() < 1e-9);
    }
    let truth = 2.0 * turn / (middle(2) - middle(0));
    // A least-squares line through three points that nearly lie on one.
    assert!((pieces[1].curvature / truth - 1.0).abs() < 0.01);
    assert_eq!(pieces[3].curvature, 0.0);
}

#[test]
fn distances_are_sums_of_the_pieces_lengths() {
    let mut rng = Seed::new(41).rng();
    let (mut x, mut z) = (vec![-35.0], vec![812.5]);
    for i in 0..50 {
        x.push(x[i] + rng.random_range(0.1..30.0));
        z.push(z[i] - rng.random_range(-8.0..25.0));
    }
    let track = Track::from_points(&x, &z).unwrap();
    let mut sum = 0.0;
    for i in 0..50 {
        let (run, drop) = (x[i + 1] - x[i], z[i] - z[i + 1]);
        let length = run.hypot(drop);
        for share in [0.0, 0.3, 0.999] {
            let s = track.distance_at(x[i] + share * run).unwrap();
            // Round-off of distances of about 1000 m.
            assert!((s - sum - share * length).abs() < 1e-11, "{i} {share}");
            let (px, pz) = track.position(s);
            assert!((px - x[i] - share * run).abs() < 1e-11);
            assert!((pz - z[i] + share * drop).abs() < 1e-11);
        }
        let inside = sum + 0.5 * length;
        assert_eq!(track.piece_at(inside), i);
        assert!((track.angle(inside) - drop.atan2(run)).abs() < 1e-14);
        sum += length;
    }
    assert!((track.length() - sum).abs() < 1e-11);
    assert!((track.distance_at(x[50]).unwrap() - sum).abs() < 1e-11);
}

#[test]
fn the_last_slope_goes_on() {
    let track =
        Track::from_points(&[0.0, 40.0, 80.0], &[60.0, 30.0, 0.0]).unwrap();
    assert_eq!((track.length(), track.piece_at(1e6)), (100.0, 2));
    let (x, z) = track.position(150.0);
    // Round-off.
    assert!((x - 120.0).abs() < 1e-13 && (z + 30.0).abs() < 1e-13);
    let last = track.pieces()[2];
    assert_eq!((last.pull, last.load), (0.6 * GRAVITY, 0.8 * GRAVITY));
    assert!(track.distance_at(81.0).is_err());
    assert!(track.distance_at(-1.0).is_err());
}

#[test]
fn the_origin_is_carried_along_and_moves_nothing() {
    let track = Track::incline(30.0, 100.0).unwrap();
    assert_eq!(track.origin(), 0.0);
    let moved = track.clone().with_origin(250.0);
    assert_eq!(moved.origin(), 250.0);
    assert_eq!(moved.pieces(), track.pieces());
    assert_eq!(moved.position(20.0), track.position(20.0));
}

#[test]
fn impossible_tracks_are_refused_with_the_reason() {
    for (x, z, reason) in [
        (vec![0.0], vec![1.0], "at least two points"),
        (vec![0.0, 1.0], vec![1.0], "at least two points"),
        (vec![0.0, f64::NAN], vec![1.0, 0.0], "finite"),
        (vec![0.0, 1.0], vec![f64::INFINITY, 0.0], "finite"),
        (vec![0.0, 2.0, 2.0], vec![3.0, 2.0, 1.0], "point 3 has x = 2"),
    ] {
        let error = Track::from_points(&x, &z).unwrap_err();
        assert!(error.is_input() && error.to_string().contains(reason));
    }
    assert!(Track::incline(90.5, 1.0).is_err());
    assert!(Track::incline(f64::NAN, 1.0).is_err());
    assert!(Track::incline(30.0, 0.0).is_err());
    assert!(Track::incline(30.0, f64::INFINITY).is_err());
}
