//! Random ground for the tests of the physics.

use couloir::physics::Track;
use couloir::seed::Rng;
use rand::RngExt;

/// A track of `pieces` pieces, each 0.5 m to `longest` across, with slope
/// angles \[degrees\] drawn between `from` and `to` and smoothed a little.
pub(crate) fn random_track(
    rng: &mut Rng,
    pieces: usize,
    longest: f64,
    (from, to): (f64, f64),
) -> Track {
    let (mut x, mut z) = (vec![0.0], vec![1000.0]);
    let mut angle = rng.random_range(from..to);
    for i in 0..pieces {
        angle = 0.5 * (angle + rng.random_range(from..to));
        let run = rng.random_range(0.5..longest);
        x.push(x[i] + run);
        z.push(z[i] - run * angle.to_radians().tan());
    }
    Track::from_points(&x, &z).expect("the points are a track")
}

/// A track of whichever character: steep, flat, uphill or mixed, of one
/// piece, of some, or an incline.
pub(crate) fn any_track(rng: &mut Rng) -> Track {
    const RANGES: [(f64, f64); 5] =
        [(25.0, 60.0), (-3.0, 3.0), (-30.0, -2.0), (-15.0, 45.0), (0.0, 40.0)];
    let range = RANGES[rng.random_range(0..RANGES.len())];
    match rng.random_range(0..8) {
        0 => {
            let angle = rng.random_range(range.0..range.1);
            Track::incline(angle, rng.random_range(10.0..1000.0))
                .expect("a slope within bounds")
        }
        1 => random_track(rng, 1, 300.0, range),
        2 => random_track(rng, 5, 200.0, range),
        3 => random_track(rng, 100, 6.0, range),
        _ => random_track(rng, 30, 30.0, range),
    }
}
