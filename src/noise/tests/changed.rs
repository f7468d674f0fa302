//! Noises with a change made to them, against their densities by hand.

use super::*;

fn altered<'a, N: ?Sized>(
    base: &'a N,
    [phi, tail, spread]: [f64; 3],
    covariate: &'a [Number],
) -> Altered<'a, Plain, N> {
    let [phi, tail, spread] = [phi, tail, spread].map(Real::new);
    Altered { base, change: Alteration { phi, tail, spread }, covariate }
}

fn gaps() -> Grid {
    Grid::new([0, 1, 2, 4, 5, 8, 9, 10, 11].map(f64::from).to_vec(), None)
}

fn covariate(count: usize) -> Vec<Number> {
    (0..count).map(|i| Number::new((0.9 * i as f64).cos())).collect()
}

/// ln of the density of r_i = u_i exp(spread x_i), where over d steps
/// u moves to phi^d u + e, with e Student of 1/tail degrees of freedom and
/// squared scale sigma2 (1 - phi^(2 d))/(1 - phi^2), all of it at the start.
fn by_hand(
    [phi, tail, spread]: [f64; 3],
    sigma2: f64,
    at: &Grid,
    covariate: &[Number],
    r: &[f64],
) -> f64 {
    let (mut total, mut before) = (0.0, 0.0);
    for i in 0..r.len() {
        let log_spread = spread * covariate[i].value();
        let u = r[i] / log_spread.exp();
        let a = match i {
            0 => 0.0,
            _ => phi.powf((at.times()[i] - at.times()[i - 1]) / at.step()),
        };
        let scale = (sigma2 * (1.0 - a * a) / (1.0 - phi * phi)).sqrt();
        let law = StudentsT::new(0.0, scale, 1.0 / tail).unwrap();
        total += law.ln_pdf(u - a * before) - log_spread;
        before = u;
    }
    total
}

#[test]
fn the_three_alterations_together_are_those_by_hand() {
    let base = Iid { sigma2: Number::new(0.7) };
    for at in [gaps(), uneven(false)] {
        let x = covariate(at.len());
        let r: Vec<f64> =
            (0..at.len()).map(|i| (1.7 * i as f64).sin()).collect();
        for change in [[0.6, 0.2, 0.8], [0.95, 0.4, -1.3]] {
            let noise = altered(&base, change, &x);
            let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
            let expected = by_hand(change, 0.7, &at, &x, &r);
            close(found.value(), expected, 1e-12);
        }
    }
}

#[test]
fn draws_of_altered_noises_have_standard_normal_innovations() {
    let base = Iid { sigma2: Number::new(0.7) };
    let mut rng = Seed::new(9).rng();
    for at in [gaps(), uneven(false)] {
        let x = covariate(at.len());
        for tail in [0.0, 0.3] {
            let noise = altered(&base, [0.7, tail, 0.8], &x);
            let mut squares = vec![0.0; at.len()];
            let (mut products, draws) = (0.0, 10_000);
            for _ in 0..draws {
                let r = lifted(&noise.draw(&at, &mut rng).unwrap());
                let z = noise.innovations(&at, &r).unwrap();
                squares.iter_mut().zip(&z).for_each(|(s, z)| *s += z * z);
                products += z.windows(2).map(|w| w[0] * w[1]).sum::<f64>();
            }
            let n = f64::from(draws);
            for square in squares {
                assert!((square / n - 1.0).abs() < 4.5 * (2.0 / n).sqrt());
            }
            let pairs = n * (at.len() - 1) as f64;
            assert!((products / pairs).abs() < 4.5 / pairs.sqrt());
        }
    }
}

#[test]
fn without_a_process_between_steps_there_is_no_correlation() {
    // The distances from one value to the next: half a step and one.
    let at = Grid::new(vec![0.0, 1.0, 1.5, 2.5, 4.123], None);
    assert_eq!((at.spacing(), at.step()), (&Spacing::Uneven, 1.0));
    let base = Iid { sigma2: Number::new(0.7) };
    let r = [0.4, -1.2, 0.1, 2.3, 1.9];
    let normal =
        |x: f64, v: f64| StatrsNormal::new(0.0, v.sqrt()).unwrap().ln_pdf(x);
    for phi in [-0.5, 0.0] {
        let expected = normal(r[0], 0.7 / (1.0 - phi * phi))
            + normal(r[1] - phi * r[0], 0.7)
            + normal(r[2], 0.7)
            + normal(r[3] - phi * r[2], 0.7)
            + normal(r[4], 0.7);
        let noise = altered(&base, [phi, 0.0, 0.0], &[]);
        let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
        close(found.value(), expected, 1e-13);
    }
    // The slope of phi^0.5 is infinite at 0.
    let phi = Real::<Grad<1>>::variable(0.0, 0);
    let change = Alteration { phi, ..Alteration::default() };
    let base = Iid { sigma2: Real::new(0.7) };
    let noise = Altered { base: &base, change, covariate: &[] };
    let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
    assert!(found.is_finite());
    // Of -(r_1 - phi r_0)^2 / (2 sigma2) and the same of r_3 and r_2.
    let slope = (r[1] * r[0] + r[3] * r[2]) / 0.7;
    close(found.partial(0), slope, 1e-13);
}

#[test]
fn an_alteration_of_nothing_is_none() {
    let change = |phi: f64, tail: f64, spread: f64| {
        let [phi, tail, spread] = [phi, tail, spread].map(Number::new);
        Alteration { phi, tail, spread }
    };
    assert!(Alteration::<Plain>::default().is_none());
    assert!(!change(0.1, 0.0, 0.0).is_none());
    assert!(!change(0.0, 0.1, 0.0).is_none());
    assert!(!change(0.0, 0.0, 0.1).is_none());
    assert!(!change(0.1, 0.1, 0.1).is_none());
}

/// Errors of a tenth of the speed, of a noise with all there is to pass on.
#[derive(Debug)]
struct Proportional(Ar<Number>);

impl Noise<Plain> for Proportional {
    fn check(&self, at: &Grid) -> crate::Result<()> {
        self.0.check(at)
    }

    fn walk(
        &self,
        at: &Grid,
        r: &[Number],
        visit: &mut dyn FnMut(Conditional<Plain>),
    ) -> Result<(), Stop> {
        self.0.walk(at, r, visit)
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        self.0.draw(at, rng)
    }

    fn width(&self, predicted: Number) -> Option<Number> {
        Some(0.1 * predicted)
    }

    fn standardise(&self, deviate: f64) -> f64 {
        3.0 * deviate
    }

    fn stationary(&self) -> Option<Stationary> {
        self.0.stationary()
    }
}

#[test]
fn what_an_alteration_does_not_change_is_passed_on() {
    let base = Proportional(ar(&[0.6, 0.2], 0.7));
    let noise = altered(&base, [0.0, 0.0, 0.0], &[]);
    assert!(noise.check(&gaps()).is_ok());
    assert!(noise.check(&uneven(false)).is_err());
    assert_eq!(noise.width(Number::new(5.0)), Some(Number::new(0.5)));
    assert_eq!(noise.standardise(0.4), 3.0 * 0.4);
    let sizes = noise.stationary().unwrap();
    let variance: f64 = 0.7 / ((1.0 - 0.36) * (1.0 - 0.04));
    close(sizes.error_sd, variance.sqrt(), 1e-14);
    close(sizes.innovation_sd, 0.7_f64.sqrt(), 1e-14);
    let iid = Iid { sigma2: Number::new(0.7) };
    assert_eq!(iid.width(Number::new(5.0)), None);
    assert_eq!(Noise::<Plain>::stationary(&iid), None);
}

#[test]
fn wide_errors_have_the_density_by_hand() {
    let at = gaps();
    let widths: Vec<Number> =
        (1..=at.len()).map(|i| Number::new(0.3 * i as f64)).collect();
    let base = Iid { sigma2: Number::new(0.7) };
    let noise = Wide::new(&base, &widths, &at).unwrap();
    let r: Vec<f64> = (0..at.len()).map(|i| (1.7 * i as f64).sin()).collect();
    let law = |w: &Number| {
        StatrsNormal::new(0.0, w.value() * 0.7_f64.sqrt()).unwrap()
    };
    let expected: f64 =
        widths.iter().zip(&r).map(|(w, r)| law(w).ln_pdf(*r)).sum();
    let found = noise.log_likelihood(&at, &lifted(&r)).unwrap();
    close(found.value(), expected, 1e-13);
    let innovations = noise.innovations(&at, &lifted(&r)).unwrap();
    for ((z, r), w) in innovations.iter().zip(&r).zip(&widths) {
        close(*z, r / (w.value() * 0.7_f64.sqrt()), 1e-14);
    }
    let (mut squares, draws) = (vec![0.0; at.len()], 10_000);
    let mut rng = Seed::new(10).rng();
    for _ in 0..draws {
        let r = noise.draw(&at, &mut rng).unwrap();
        squares.iter_mut().zip(&r).for_each(|(s, r)| *s += r * r);
    }
    let n = f64::from(draws);
    for (square, w) in squares.iter().zip(&widths) {
        let ratio = square / n / (0.7 * w.value().powi(2));
        assert!((ratio - 1.0).abs() < 4.5 * (2.0 / n).sqrt());
    }
}

#[test]
fn a_width_is_positive_and_stands_alone() {
    let base = Proportional(ar(&[0.6, 0.2], 0.7));
    let at = gaps();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut widths = vec![Number::new(1.0); at.len()];
        widths[3] = Number::new(bad);
        let rejected = Wide::new(&base, &widths, &at);
        assert!(matches!(rejected, Err(Stop::Reject(_))), "{bad}");
    }
    let widths = vec![Number::new(1.0); at.len()];
    let known = Grid::new(at.times().to_vec(), Some(vec![0.1; at.len()]));
    assert!(matches!(Wide::new(&base, &widths, &known), Err(Stop::Fail(_))));
    let noise = Wide::new(&base, &widths, &at).unwrap();
    assert!(noise.check(&at).is_ok());
    assert!(noise.check(&uneven(false)).is_err());
    assert_eq!(noise.standardise(0.4), 3.0 * 0.4);
}
