//! The motion of a mass point down a track, by Runge and Kutta's method of
//! order 4 in time.
//!
//! ds/dt = u, du/dt = g sin(theta) - r. The forces jump at the points of the
//! track and at the edges of an effect; a step ends on each of them, since a
//! step across a jump is of order 1 only.

use super::effects::Effect;
use super::ground::Ground;
use super::moments::{Moment, Run, Start};

/// The acceleration of gravity \[m/s2\].
pub(super) const G: f64 = 9.81;

/// The time step \[s\]; halving it changes no speed by 1e-4 m/s.
pub(super) const STEP: f64 = 4e-3;

/// The friction that the event's file states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Law {
    /// r = mu g cos(theta).
    Coulomb {
        /// The friction coefficient.
        mu: f64,
    },
    /// r = mu g cos(theta) + g u2/(xi h).
    Voellmy {
        /// The friction coefficient.
        mu: f64,
        /// The turbulence coefficient \[m/s2\].
        xi: f64,
        /// The flow depth \[m\].
        depth: f64,
    },
}

impl Law {
    /// The friction coefficient.
    pub(super) fn mu(&self) -> f64 {
        match *self {
            Self::Coulomb { mu } | Self::Voellmy { mu, .. } => mu,
        }
    }

    /// What its resistance \[m/s2\] gains with u2 \[1/m\].
    fn drag(&self) -> f64 {
        match *self {
            Self::Coulomb { .. } => 0.0,
            Self::Voellmy { xi, depth, .. } => G / (xi * depth),
        }
    }
}

/// The motion up to a time, to the stop or to the end of the ground.
pub(super) fn slide(
    ground: &Ground,
    law: &Law,
    effect: &dyn Effect,
    start: Start,
    until: f64,
    step: f64,
) -> Run {
    let mut slider = Slider::new(ground, law, effect, start, until);
    let mut run = Run { least_mu: law.mu(), ..Run::default() };
    slider.note(&mut run);
    if start.speed == 0.0 && slider.pull(start.place, 0.0, 0.0) <= 0.0 {
        run.rest = Some(0.0);
    }
    while run.rest.is_none() && slider.inside() {
        if slider.advance(step) {
            run.rest = Some(slider.t);
        }
        slider.note(&mut run);
    }
    if run.t.len() == 1 {
        slider.t += step;
        slider.note(&mut run);
    }
    run
}

/// The state with the borders that it lies between.
struct Slider<'a> {
    ground: &'a Ground,
    law: &'a Law,
    effect: &'a dyn Effect,
    places: Vec<f64>,
    times: Vec<f64>,
    /// The border before the state in each list.
    at: (usize, usize),
    piece: usize,
    s: f64,
    u: f64,
    t: f64,
}

impl<'a> Slider<'a> {
    fn new(
        ground: &'a Ground,
        law: &'a Law,
        effect: &'a dyn Effect,
        start: Start,
        until: f64,
    ) -> Self {
        let (edges, moments) = effect.borders();
        let mut places: Vec<f64> =
            ground.pieces.iter().map(|p| p.end).collect();
        let end = ground.length();
        places.push(start.place);
        places.extend(edges.into_iter().filter(|s| *s < end));
        places.retain(|s| *s >= start.place);
        sort(&mut places);
        let mut times = vec![0.0, until];
        let within = |t: &f64| *t > 0.0 && *t < until;
        times.extend(moments.into_iter().filter(within));
        sort(&mut times);
        let (s, u) = (start.place, start.speed);
        let mut slider = Self {
            ground,
            law,
            effect,
            places,
            times,
            at: (0, 0),
            piece: 0,
            s,
            u,
            t: 0.0,
        };
        slider.find_piece();
        slider
    }

    fn inside(&self) -> bool {
        self.at.0 + 1 < self.places.len() && self.at.1 + 1 < self.times.len()
    }

    fn find_piece(&mut self) {
        let place = self.middle().0;
        let before = |p: &super::ground::Piece| p.end <= place;
        let all = &self.ground.pieces;
        self.piece = all.partition_point(before).min(all.len() - 1);
    }

    /// A place and a time between the borders that hold the state.
    fn middle(&self) -> (f64, f64) {
        let mid = |all: &[f64], i: usize| {
            let next = all.get(i + 1).unwrap_or(&all[i]);
            0.5 * (all[i] + next)
        };
        (mid(&self.places, self.at.0), mid(&self.times, self.at.1))
    }

    fn moment(&self, s: f64, u: f64, t: f64) -> Moment {
        let (place, time) = self.middle();
        Moment { s, u, t, place, time }
    }

    /// du/dt \[m/s2\].
    fn pull(&self, s: f64, u: f64, t: f64) -> f64 {
        let moment = self.moment(s, u, t);
        let (sin, cos) = self.ground.pieces[self.piece].angle.sin_cos();
        let load = (G * cos + self.effect.load(&moment)).max(0.0);
        let mu = self.effect.mu(self.law.mu(), &moment);
        let rest = self.law.drag() * u * u + self.effect.brake(&moment);
        G * sin - mu * load - rest
    }

    /// Place and speed after a time step, without regard to borders.
    fn step(&self, h: f64) -> (f64, f64) {
        let (s, u, t) = (self.s, self.u, self.t);
        let half = 0.5 * h;
        let a1 = self.pull(s, u, t);
        let u2 = u + half * a1;
        let a2 = self.pull(s + half * u, u2, t + half);
        let u3 = u + half * a2;
        let a3 = self.pull(s + half * u2, u3, t + half);
        let u4 = u + h * a3;
        let a4 = self.pull(s + h * u3, u4, t + h);
        let mean_speed = (u + 2.0 * (u2 + u3) + u4) / 6.0;
        (s + h * mean_speed, u + h * (a1 + 2.0 * (a2 + a3) + a4) / 6.0)
    }

    /// The time step after which `of` the state is 0, which it passes upwards
    /// within `h`: by false position, the end that stays put halved in weight
    /// (the Illinois rule). The result is not before the zero.
    fn root(&self, h: f64, of: impl Fn((f64, f64)) -> f64) -> f64 {
        let (mut low, mut below) = (0.0, of((self.s, self.u)));
        let (mut high, mut above) = (h, of(self.step(h)));
        let mut last = 0.0;
        for _ in 0..100 {
            if above < 1e-12 || high - low < 1e-15 {
                break;
            }
            let guess = (low * above - high * below) / (above - below);
            let value = of(self.step(guess));
            if value >= 0.0 {
                (high, above) = (guess, value);
                below *= if last > 0.0 { 0.5 } else { 1.0 };
                last = 1.0;
            } else {
                (low, below) = (guess, value);
                above *= if last < 0.0 { 0.5 } else { 1.0 };
                last = -1.0;
            }
        }
        high
    }

    /// One step, to a border at most; whether the mass came to rest.
    fn advance(&mut self, step: f64) -> bool {
        let next = self.places[self.at.0 + 1];
        let end = self.times[self.at.1 + 1];
        let mut h = step.min(end - self.t);
        let stops = self.step(h).1 <= 0.0;
        if stops {
            h = self.root(h, |(_, u)| -u);
        }
        let crosses = self.step(h).0 >= next;
        if crosses {
            h = self.root(h, |(s, _)| s - next);
        }
        (self.s, self.u) = self.step(h);
        self.t += h;
        if crosses {
            self.s = next;
            self.at.0 += 1;
            self.find_piece();
        } else if !stops && self.t >= end - 1e-12 {
            self.t = end;
            self.at.1 += 1;
        }
        // A deposit sets: what has come to rest stays.
        stops && !crosses
    }

    fn note(&self, run: &mut Run) {
        let moment = self.moment(self.s, self.u, self.t);
        let mu = self.effect.mu(self.law.mu(), &moment);
        run.least_mu = run.least_mu.min(mu);
        run.t.push(self.t);
        run.s.push(self.s);
        run.u.push(self.u.max(0.0));
    }
}

fn sort(borders: &mut Vec<f64>) {
    borders.sort_by(f64::total_cmp);
    borders.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::challenge::effects;
    use crate::challenge::ground::Shape;
    use crate::seed::Seed;

    fn incline(degrees: f64) -> Ground {
        let x: Vec<f64> = (0..5).map(|i| 250.0 * f64::from(i)).collect();
        let tan = degrees.to_radians().tan();
        let z: Vec<f64> = x.iter().map(|x| -tan * x).collect();
        Ground::from_points(x, &z)
    }

    const REST: Start = Start { place: 0.0, speed: 0.0 };

    #[test]
    fn a_constant_force_gives_a_straight_line() {
        let ground = incline(30.0);
        let law = Law::Coulomb { mu: 0.3 };
        let run = slide(&ground, &law, &effects::Nothing, REST, 10.0, STEP);
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let a = G * (sin - 0.3 * cos);
        for t in [0.5, 3.337, 9.999] {
            // Elevations are rounded to the millimetre.
            assert!((run.speed(t) - a * t).abs() < 1e-3);
            assert!((run.place(t) - 0.5 * a * t * t).abs() < 5e-3);
            let back = run.when(run.place(t)).unwrap();
            assert!((back - t).abs() < 1e-4);
        }
    }

    #[test]
    fn drag_gives_a_hyperbolic_tangent() {
        let ground = incline(35.0);
        let law = Law::Voellmy { mu: 0.2, xi: 800.0, depth: 1.5 };
        let run = slide(&ground, &law, &effects::Nothing, REST, 30.0, STEP);
        let (sin, cos) = 35.0_f64.to_radians().sin_cos();
        let a = G * (sin - 0.2 * cos);
        let last = (a * 800.0 * 1.5 / G).sqrt();
        for t in [1.0, 5.0, 20.0] {
            let exact = last * (a * t / last).tanh();
            assert!((run.speed(t) - exact).abs() < 2e-3);
        }
    }

    #[test]
    fn friction_stops_the_mass() {
        let ground = incline(10.0);
        let law = Law::Coulomb { mu: 0.5 };
        let start = Start { place: 50.0, speed: 20.0 };
        let run = slide(&ground, &law, &effects::Nothing, start, 30.0, STEP);
        let (sin, cos) = 10.0_f64.to_radians().sin_cos();
        let a = G * (0.5 * cos - sin);
        let rest = run.rest.unwrap();
        assert!((rest - 20.0 / a).abs() < 1e-3);
        assert!((run.place(40.0) - 50.0 - 200.0 / a).abs() < 1e-2);
        assert_eq!(run.speed(rest + 1.0), 0.0);
        let held = slide(&ground, &law, &effects::Nothing, REST, 5.0, STEP);
        assert_eq!((held.rest, held.speed(2.0)), (Some(0.0), 0.0));
    }

    #[test]
    fn half_the_step_gives_the_same_speeds() {
        for (i, shape) in Shape::ALL.into_iter().enumerate() {
            let mut rng = Seed::new(5).child(i as u64).rng();
            let ground = Ground::draw(shape, &mut rng);
            let law = Law::Voellmy { mu: 0.25, xi: 1000.0, depth: 2.0 };
            let run_with =
                |h| slide(&ground, &law, &effects::Nothing, REST, 30.0, h);
            let (whole, half) = (run_with(STEP), run_with(0.5 * STEP));
            for k in 1..60 {
                let t = 0.5 * f64::from(k);
                let change = whole.speed(t) - half.speed(t);
                assert!(change.abs() < 1e-4, "{shape:?} {t} {change}");
            }
        }
    }
}
