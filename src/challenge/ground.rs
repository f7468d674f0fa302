//! Random tracks: what an avalanche may run down.
//!
//! Written for the challenge alone. The engine has its own track, and a slip
//! in one of them shows as a mismatch instead of cancelling out.

use std::f64::consts::TAU;

use rand::RngExt;

use crate::seed::Rng;

/// The shapes that tracks are drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// One constant slope.
    Incline,
    /// A concave parabola.
    Parabola,
    /// Steep, a bench, steep again, and a runout.
    Bench,
    /// Convex above, concave below.
    Sigmoid,
    /// A channel whose slope swings.
    Bends,
    /// A parabola with rough ground.
    Rough,
}

impl Shape {
    pub(super) const ALL: [Self; 6] = [
        Self::Incline,
        Self::Parabola,
        Self::Bench,
        Self::Sigmoid,
        Self::Bends,
        Self::Rough,
    ];
}

/// A straight piece between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// Distance along the slope at its beginning \[m\].
    pub(super) start: f64,
    /// Distance along the slope at its end \[m\].
    pub(super) end: f64,
    /// Its angle \[radians\], positive downhill.
    pub(super) angle: f64,
}

/// A chain of straight pieces.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ground {
    /// Horizontal distances of the points \[m\].
    pub(super) x: Vec<f64>,
    /// Elevations of the points \[m\], to the millimetre.
    pub(super) z: Vec<f64>,
    /// The pieces between them.
    pub(super) pieces: Vec<Piece>,
}

impl Ground {
    /// From points, of which the elevations are rounded to the millimetre, as
    /// the event's file gives them.
    pub(super) fn from_points(x: Vec<f64>, z: &[f64]) -> Self {
        let z: Vec<f64> = z.iter().map(|z| (z * 1e3).round() / 1e3).collect();
        let mut start = 0.0;
        let pieces = x
            .windows(2)
            .zip(z.windows(2))
            .map(|(x, z)| {
                let (run, drop) = (x[1] - x[0], z[0] - z[1]);
                let end = start + run.hypot(drop);
                let piece = Piece { start, end, angle: drop.atan2(run) };
                start = end;
                piece
            })
            .collect();
        Self { x, z, pieces }
    }

    /// A random track of a shape: 200 to 1500 m long, points every 5 to 20 m,
    /// 25 to 40 degrees at its top, flattening out unless it is an incline.
    pub(super) fn draw(shape: Shape, rng: &mut Rng) -> Self {
        let length = rng.random_range(200.0..1500.0);
        let spacing = f64::from(rng.random_range(5..=20));
        let count = (length / spacing) as usize;
        let profile = profile(shape, length, rng);
        let x: Vec<f64> = (0..=count).map(|i| i as f64 * spacing).collect();
        let mut z = vec![2000.0];
        let mut rough = 0.0;
        for pair in x.windows(2) {
            if shape == Shape::Rough {
                // Neighbouring pieces are alike; far ones are not.
                rough = 0.6 * rough + rng.random_range(-1.6..1.6);
            }
            let degrees = profile(0.5 * (pair[0] + pair[1])) + rough;
            let drop = spacing * degrees.to_radians().tan();
            z.push(z[z.len() - 1] - drop);
        }
        Self::from_points(x, &z)
    }

    /// The whole length along the slope \[m\].
    pub(super) fn length(&self) -> f64 {
        self.pieces.last().map_or(0.0, |p| p.end)
    }

    /// The distance along the slope at a horizontal distance \[m\].
    pub(super) fn along(&self, x: f64) -> f64 {
        let i = self.x[1..self.x.len() - 1].partition_point(|p| *p <= x);
        let piece = &self.pieces[i];
        piece.start + (x - self.x[i]) / piece.angle.cos()
    }

    /// The horizontal distance at a distance along the slope \[m\].
    pub(super) fn across(&self, s: f64) -> f64 {
        let inner = &self.pieces[..self.pieces.len() - 1];
        let i = inner.partition_point(|piece| piece.end <= s);
        let piece = &self.pieces[i];
        self.x[i] + (s - piece.start) * piece.angle.cos()
    }

    /// As it comes out of a survey that measures distances along the slope
    /// rightly, and angles off by so many radians: turned about its top. Files
    /// give horizontal distances to the centimetre.
    pub(super) fn tilted(&self, by: f64) -> Self {
        let (mut x, mut z) = (vec![self.x[0]], vec![self.z[0]]);
        for (i, piece) in self.pieces.iter().enumerate() {
            let angle = piece.angle + by;
            let run = (piece.end - piece.start) * angle.cos();
            x.push(((x[i] + run) * 1e2).round() / 1e2);
            z.push(z[i] - (x[i + 1] - x[i]) * angle.tan());
        }
        Self::from_points(x, &z)
    }

    /// -d theta/ds \[1/m\] at `s`: the slope of the least-squares line through
    /// the angles over `half` metres either side. The first and the last piece
    /// go on beyond the ends.
    pub(super) fn curvature(&self, s: f64, half: f64) -> f64 {
        let last = self.pieces.len() - 1;
        let moment: f64 = self
            .pieces
            .iter()
            .enumerate()
            .map(|(i, p)| {
                let from = if i == 0 { f64::NEG_INFINITY } else { p.start };
                let to = if i == last { f64::INFINITY } else { p.end };
                let (a, b) = (from.max(s - half) - s, to.min(s + half) - s);
                if b > a { 0.5 * p.angle * (b * b - a * a) } else { 0.0 }
            })
            .sum();
        // The integral of x2 from -half to half is 2/3 half3.
        -1.5 * moment / half.powi(3)
    }
}

type Profile = Box<dyn Fn(f64) -> f64>;

/// The slope angle \[degrees\] as a function of the horizontal distance.
fn profile(shape: Shape, length: f64, rng: &mut Rng) -> Profile {
    let top: f64 = rng.random_range(25.0..40.0);
    let foot: f64 = rng.random_range(5.0..20.0);
    match shape {
        Shape::Incline => Box::new(move |_| top.min(35.0)),
        Shape::Parabola | Shape::Rough => parabola(top, foot, length),
        Shape::Bench => bench(top, foot, length, rng),
        Shape::Sigmoid => {
            let crest = rng.random_range(0.2..0.4) * length;
            let bulge = rng.random_range(3.0..8.0);
            let below = parabola(top, foot, length);
            Box::new(move |x| {
                // The steepest place lies below the crest.
                let away = (x - crest) / (0.15 * length);
                below(x) + bulge * away * (-0.5 * away * away).exp()
            })
        }
        Shape::Bends => {
            let swing = rng.random_range(2.5..5.0);
            let wave = rng.random_range(90.0..250.0);
            let phase = rng.random_range(0.0..TAU);
            let below = parabola(top, foot, length);
            Box::new(move |x| {
                below(x) + swing * (TAU * x / wave + phase).sin()
            })
        }
    }
}

/// A parabola's slope, that is its tangent, falls linearly.
fn parabola(top: f64, foot: f64, length: f64) -> Profile {
    let (top, foot) = (top.to_radians().tan(), foot.to_radians().tan());
    Box::new(move |x| (top + (foot - top) * x / length).atan().to_degrees())
}

fn bench(top: f64, foot: f64, length: f64, rng: &mut Rng) -> Profile {
    let from = rng.random_range(0.25..0.45) * length;
    let to = from + rng.random_range(0.1..0.2) * length;
    let runout = rng.random_range(0.75..0.9) * length;
    let flat = rng.random_range(8.0..18.0);
    let below = rng.random_range(22.0..32.0);
    Box::new(move |x| match x {
        x if x < from => top,
        x if x < to => flat,
        x if x < runout => below,
        _ => foot,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    #[test]
    fn tracks_are_as_stated() {
        for (i, shape) in Shape::ALL.into_iter().enumerate() {
            for k in 0..50 {
                let seed = Seed::new(k).child(i as u64);
                let ground = Ground::draw(shape, &mut seed.rng());
                let width = ground.x[ground.x.len() - 1];
                assert!((180.0..=1500.0).contains(&width));
                let gap = ground.x[1] - ground.x[0];
                assert!((5.0..=20.0).contains(&gap));
                let top = ground.pieces[0].angle.to_degrees();
                assert!((20.0..=45.0).contains(&top), "{shape:?} {top}");
            }
        }
    }

    #[test]
    fn distances_go_along_the_slope() {
        let x = vec![0.0, 30.0, 70.0, 80.0];
        let ground = Ground::from_points(x, &[100.0, 60.0, 60.0, 60.0]);
        assert!((ground.along(15.0) - 25.0).abs() < 1e-9);
        assert!((ground.along(40.0) - 60.0).abs() < 1e-9);
        assert_eq!(ground.length(), 100.0);
        let tilted = ground.tilted(0.1);
        let change = tilted.pieces[0].angle - ground.pieces[0].angle;
        assert!((change - 0.1).abs() < 1e-4);
        // Turned, not sheared: lengths stay, but for the centimetre.
        assert!((tilted.length() - ground.length()).abs() < 0.03);
        for s in [25.0, 60.0, 95.0] {
            assert!((ground.along(ground.across(s)) - s).abs() < 1e-9);
        }
    }

    #[test]
    fn a_circle_is_curved_everywhere_alike() {
        let x: Vec<f64> = (0..60).map(|i| 3.0 * f64::from(i)).collect();
        let arc = |x: &f64| -(300.0_f64.powi(2) - (x - 200.0).powi(2)).sqrt();
        let z: Vec<f64> = x.iter().map(arc).collect();
        let ground = Ground::from_points(x, &z);
        for s in [40.0, 80.0, 120.0] {
            let kappa = ground.curvature(s, 10.0);
            assert!((kappa * 300.0 - 1.0).abs() < 0.1, "{kappa}");
        }
    }
}
