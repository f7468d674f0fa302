//! What a noise of a user's own has without saying it, and what one says of
//! its errors.

use super::informing::{Carried, informed, moved};
use super::*;

/// A noise that says no more than it has to.
struct Least<N>(N);

impl<K: Kind, N: Noise<K>> Noise<K> for Least<N> {
    fn check(&self, at: &Grid) -> crate::Result<()> {
        self.0.check(at)
    }

    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        self.0.walk(at, residuals, visit)
    }

    fn draw(
        &self,
        at: &Grid,
        rng: &mut crate::seed::Rng,
    ) -> Result<Vec<f64>, Stop> {
        self.0.draw(at, rng)
    }
}

/// The noises that say more, on times where they say it.
fn outspoken() -> Vec<(Box<dyn Noise<Grad<4>>>, Grid)> {
    let v = Carried::variable;
    let phi = std::iter::once(v(0.6, 0)).collect();
    let autoregression = Ar { phi, sigma2: v(0.8, 1) };
    let iid = Iid { sigma2: v(0.8, 0) };
    let smooth = Matern32 { sd_matern: v(0.9, 0), time_matern: v(0.3, 1) };
    let rough = Ou { sd_ou: v(0.4, 1), time_ou: Real::new(2.0) };
    let white = White { sigma2: v(0.2, 2) };
    let sum = Sum::new(Sum::new(smooth, rough), white);
    let growing = Sum::new(sum, Growth { growth: v(0.7, 2) });
    let mut all: Vec<(Box<dyn Noise<Grad<4>>>, Grid)> = Vec::new();
    for at in grids().into_iter().chain([uneven(false), uneven(true)]) {
        all.push((Box::new(autoregression.clone()), at.clone()));
        all.push((Box::new(iid), at.clone()));
        all.push((Box::new(sum), at.clone()));
        all.push((Box::new(growing), at));
    }
    all
}

#[test]
fn a_noise_that_says_the_least_is_as_likely_and_tells_as_much() {
    for (noise, at) in outspoken() {
        let wave = (0..at.len()).map(|i| 0.7 * (i as f64).sin());
        let r = moved(&wave.collect::<Vec<f64>>());
        let least = Least(&*noise);
        let total = |noise: &dyn Noise<Grad<4>>| {
            noise.log_likelihood(&at, &r).unwrap()
        };
        let (sums, told) = informed(&*noise, &at, &r);
        let (its_sums, default) = informed(&least, &at, &r);
        for all in [total(&*noise), total(&least), default] {
            close(all.value(), told.value(), 1e-12);
            for i in 0..4 {
                let off = (all.partial(i) - told.partial(i)).abs();
                assert!(off < 1e-9 * (1.0 + told.partial(i).abs()), "{off}");
            }
        }
        let off = (sums.clone() - its_sums).amax();
        assert!(off < 1e-9 * sums.amax(), "{off}");
    }
}

#[test]
fn what_a_noise_has_not_said_is_the_usual() {
    let least = Least(ar(&[0.5], 1.0));
    let noise: &dyn Noise<Plain> = &least;
    assert!(noise.stationary().is_none());
    assert!(noise.width(Number::new(1.0)).is_none());
    assert_eq!(noise.standardise(-1.3), -1.3);
    assert!(is_noise("ou") && is_noise("tails") && !is_noise("drift"));
    let mut none = |_: &dyn Part<Plain>| {};
    let sum = parse("ou + white").unwrap();
    assert!(sum.part(&lifted::<Plain>(&[1.0; 3]), &mut none).is_err());
}

#[test]
fn an_autoregression_says_how_large_its_errors_are() {
    let Stationary { error_sd, innovation_sd } =
        ar(&[0.8], 0.36).stationary().unwrap();
    close(error_sd, 1.0, 1e-15);
    close(innovation_sd, 0.6, 1e-15);
}

#[test]
fn a_width_scales_errors_with_their_density() {
    let at = Grid::new((0..6).map(f64::from).collect(), None);
    let widths = lifted::<Plain>(&[0.5, 1.0, 2.0, 4.0, 0.1, 3.0]);
    let base = Student { dof: Number::new(3.0), scale: Number::new(0.7) };
    let wide = Wide::new(&base, &widths, &at).unwrap();
    let drawn = |noise: &dyn Noise<Plain>| {
        noise.draw(&at, &mut Seed::new(2).rng()).unwrap()
    };
    let (narrow, errors) = (drawn(&base), drawn(&wide));
    let mut logs = 0.0;
    for ((n, e), w) in narrow.iter().zip(&errors).zip(&widths) {
        close(*e, n * w.value(), 1e-15);
        logs += w.value().ln();
    }
    let log = |noise: &dyn Noise<Plain>, r: &[f64]| {
        noise.log_likelihood(&at, &lifted(r)).unwrap().value()
    };
    close(log(&wide, &errors), log(&base, &narrow) - logs, 1e-13);
    assert_eq!(wide.standardise(2.0), base.standardise(2.0));
    let none = ar(&[], 1.0);
    assert!(Wide::new(&none, &widths, &at).unwrap().check(&at).is_err());
    let zero = [Number::new(0.0)];
    let impossible = Wide::new(&base, &zero, &at);
    assert!(matches!(impossible, Err(Stop::Reject(_))));
}

#[test]
fn scores_have_the_probabilities_of_their_deviates() {
    use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
    let score = |d: f64, dof: f64| {
        let scale = Number::new(1.0);
        Student { dof: Number::new(dof), scale }.standardise(d)
    };
    for dof in [0.7, 3.0, 30.0, 1e3] {
        let law = StudentsT::new(0.0, 1.0, dof).unwrap();
        for d in [-30.0, -3.0, -0.2, 0.4, 6.0] {
            let z = score(d, dof);
            assert_eq!(z.signum(), d.signum());
            let ratio = Normal::standard().cdf(-z.abs()) / law.cdf(-d.abs());
            // statrs's normal quantile has about ten digits far out.
            assert!((ratio - 1.0).abs() < 1e-9, "{dof} {d} {ratio}");
        }
        assert_eq!(score(0.0, dof), 0.0);
    }
    // By its expansion, whose next term is of the order d^5/dof^2.
    for d in [-4.0, 0.3, 2.0] {
        let (below, above) = (score(d, 0.999e6), score(d, 1.001e6));
        assert!((below - above).abs() < 1e-7, "{below} {above}");
    }
    for (d, dof) in
        [(f64::NAN, 3.0), (1.0, 0.0), (1.0, 1e-310), (1.0, f64::NAN)]
    {
        assert!(score(d, dof).is_nan(), "{d} {dof}");
    }
    // The smallest probability that is a number.
    assert!(score(1e200, 3.0) > 30.0 && score(1e200, 3.0).is_finite());
}

fn smooth(sd: f64, time: f64) -> Matern32<Number> {
    Matern32 { sd_matern: Real::new(sd), time_matern: Real::new(time) }
}

fn rough(sd: f64, time: f64) -> Ou<Number> {
    Ou { sd_ou: Real::new(sd), time_ou: Real::new(time) }
}

fn white(sigma2: f64) -> White<Number> {
    White { sigma2: Real::new(sigma2) }
}

/// Whether residuals are rejected, by whichever way they come.
fn rejects(noise: &dyn Noise<Plain>, times: [f64; 3]) -> bool {
    let at = Grid::new(times.to_vec(), None);
    let r = lifted::<Plain>(&[0.3, -0.2, 0.1]);
    let logs =
        [noise.log_likelihood(&at, &r), noise.inform(&at, &r, &mut |_| {})];
    logs.iter().all(|log| matches!(log, Err(Stop::Reject(_))))
}

const EVEN: [f64; 3] = [0.0, 1.0, 2.0];
const TWICE: [f64; 3] = [0.0, 1.0, 1.0];

#[test]
fn blocks_that_are_no_process_are_rejected() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(rejects(&smooth(bad, 1.0), EVEN));
        assert!(rejects(&smooth(1.0, bad), EVEN));
        assert!(rejects(&rough(bad, 1.0), EVEN));
        assert!(rejects(&rough(1.0, bad), EVEN));
        assert!(rejects(&Sum::new(smooth(1.0, 1.0), white(bad)), EVEN));
        assert!(rejects(&Sum::new(ar(&[0.5], bad), white(1.0)), EVEN));
        let tails = Tails { nu: Number::new(bad) };
        assert!(rejects(&Sum::new(white(1.0), tails), EVEN));
    }
    assert!(rejects(&Sum::new(ar(&[1.5], 1.0), white(1.0)), EVEN));
    let growth = Growth { growth: Number::new(f64::INFINITY) };
    assert!(rejects(&Sum::new(white(1.0), growth), EVEN));
    // Of no errors of their own two values at one time are one.
    assert!(rejects(&rough(1.0, 1.0), TWICE));
}

#[test]
fn tails_far_below_none_are_rejected_at_once() {
    for nu in [-1e300, -1e12, -0.5, f64::NAN].map(Number::new) {
        assert!(rejects(&Sum::new(white(1.0), Tails { nu }), EVEN));
        let scale = Number::new(1.0);
        assert!(rejects(&Student { dof: nu, scale }, EVEN));
    }
}

#[test]
fn a_process_is_not_known_twice_at_one_time() {
    let at = Grid::new(TWICE.to_vec(), None);
    let fails = |noise: &dyn Noise<Plain>, words: &str| {
        let said = noise.check(&at).unwrap_err().to_string();
        assert!(said.contains(words), "{said}");
    };
    fails(&smooth(1.0, 1.0), "matern32");
    fails(&rough(1.0, 1.0), "ou");
    fails(&Sum::new(white(1.0), rough(1.0, 1.0)), "ou");
    let mut named = |noise: &dyn Noise<Plain>| fails(noise, "ou");
    let values = lifted::<Plain>(&[1.0, 1.0, 0.5]);
    parse("ou + white").unwrap().with(&values, &mut named).unwrap();
}

#[test]
fn without_memory_there_is_a_process_between_the_steps() {
    let at = uneven(false);
    let r = lifted::<Plain>(&vec![0.4; at.len()]);
    let log = |noise: &dyn Noise<Plain>| {
        noise.log_likelihood(&at, &r).unwrap().value()
    };
    let iid = Iid { sigma2: Number::new(0.7) };
    close(log(&ar(&[0.0], 0.7)), log(&iid), 1e-13);
}
