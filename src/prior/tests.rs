//! Every distribution against statrs, quadrature, differences, draws and
//! reference values of mpmath.

#![allow(clippy::unwrap_used)]

mod joint;
mod line;
mod parts;

use proptest::prelude::*;
use statrs::distribution::{self as independent, Continuous, ContinuousCDF};

use super::*;
use crate::scalar::{Grad, Plain};
use crate::seed::Seed;
use AnyPrior as P;

/// Directions 0 to 2 are the arguments, 3 is x.
type D = Real<Grad<4>>;

/// Every proper family, tame and less so.
fn cases() -> Vec<AnyPrior> {
    vec![
        P::Normal(1.0, 2.0),
        P::Normal(-3e2, 1e-2),
        P::LogNormal(-2.0, 0.5),
        P::LogNormal(3.0, 4.0),
        P::Gamma(9.0, 0.03),
        P::Gamma(1.0, 2.0),
        P::Gamma(0.5, 1e-8),
        P::Gamma(0.1, 7.0),
        P::Gamma(2e3, 1e6),
        P::InverseGamma(2.0, 1.0),
        P::InverseGamma(0.3, 5.0),
        P::InverseGamma(60.0, 1e-9),
        P::Exponential(0.2),
        P::Uniform(-1.0, 3.0),
        P::Uniform(0.05, 0.8),
        P::Beta(2.0, 5.0),
        P::Beta(1.0, 1.0),
        P::Beta(0.5, 3.0),
        P::Beta(300.0, 200.0),
        P::Beta(0.3, 0.6),
        P::HalfNormal(2.0),
        P::HalfCauchy(5.0),
        P::Cauchy(-2.0, 0.5),
        P::StudentT(3.0, 1.0, 2.0),
        P::StudentT(1.3, 0.0, 1e-3),
        P::StudentT(80.0, -5.0, 10.0),
    ]
}

/// ln density and distribution function at x by statrs.
fn by_statrs(prior: &AnyPrior, x: f64) -> (f64, f64) {
    fn both<D>(d: D, x: f64) -> (f64, f64)
    where
        D: Continuous<f64, f64> + ContinuousCDF<f64, f64> + Copy,
    {
        (d.ln_pdf(x), d.cdf(x))
    }
    let half = |(l, c): (f64, f64)| (l + 2.0_f64.ln(), 2.0 * c - 1.0);
    use independent as i;
    match *prior {
        P::Normal(m, s) => both(i::Normal::new(m, s).unwrap(), x),
        P::LogNormal(m, s) => both(i::LogNormal::new(m, s).unwrap(), x),
        P::Gamma(a, s) => both(i::Gamma::new(a, 1.0 / s).unwrap(), x),
        P::InverseGamma(a, s) => {
            // statrs's own ln_pdf is the logarithm of an overflowing product.
            let gamma = i::Gamma::new(a, s).unwrap();
            let cdf = i::InverseGamma::new(a, s).unwrap().cdf(x);
            (gamma.ln_pdf(1.0 / x) - 2.0 * x.ln(), cdf)
        }
        P::Exponential(m) => both(i::Exp::new(1.0 / m).unwrap(), x),
        P::Uniform(l, h) => both(i::Uniform::new(l, h).unwrap(), x),
        P::Beta(a, b) => both(i::Beta::new(a, b).unwrap(), x),
        P::HalfNormal(s) => half(both(i::Normal::new(0.0, s).unwrap(), x)),
        P::HalfCauchy(s) => half(both(i::Cauchy::new(0.0, s).unwrap(), x)),
        P::Cauchy(m, s) => both(i::Cauchy::new(m, s).unwrap(), x),
        P::StudentT(n, m, s) => both(i::StudentsT::new(m, s, n).unwrap(), x),
        P::Flat() => (0.0, f64::NAN),
    }
}

fn log_density(prior: &AnyPrior, x: f64) -> f64 {
    prior.log_density(Real::<Plain>::new(x)).value()
}

/// The log density with its derivatives in arguments and x.
fn with_slopes(prior: &AnyPrior, x: f64) -> D {
    let v = |value, i| D::variable(value, i);
    let x = v(x, 3);
    match *prior {
        P::Normal(a, b) => Normal::new(v(a, 0), v(b, 1)).log_density(x),
        P::LogNormal(a, b) => LogNormal::new(v(a, 0), v(b, 1)).log_density(x),
        P::Gamma(a, b) => Gamma::new(v(a, 0), v(b, 1)).log_density(x),
        P::InverseGamma(a, b) => {
            InverseGamma::new(v(a, 0), v(b, 1)).log_density(x)
        }
        P::Exponential(a) => Exponential::new(v(a, 0)).log_density(x),
        P::Uniform(a, b) => Uniform::new(v(a, 0), v(b, 1)).log_density(x),
        P::Beta(a, b) => Beta::new(v(a, 0), v(b, 1)).log_density(x),
        P::HalfNormal(a) => HalfNormal::new(v(a, 0)).log_density(x),
        P::HalfCauchy(a) => HalfCauchy::new(v(a, 0)).log_density(x),
        P::Cauchy(a, b) => Cauchy::new(v(a, 0), v(b, 1)).log_density(x),
        P::StudentT(a, b, c) => {
            StudentT::new(v(a, 0), v(b, 1), v(c, 2)).log_density(x)
        }
        P::Flat() => Flat::new().log_density(x),
    }
}

/// The same family with one argument changed.
fn changed(prior: &AnyPrior, index: usize, value: f64) -> AnyPrior {
    let mut arguments = prior.arguments();
    arguments[index] = value;
    let texts: Vec<_> = arguments.iter().map(f64::to_string).collect();
    AnyPrior::parse(&format!("{}({})", prior.name(), texts.join(", ")))
        .unwrap()
}

/// Central difference of sixth order.
fn difference(f: impl Fn(f64) -> f64, x: f64, h: f64) -> f64 {
    let pair = |k: f64| f(x + k * h) - f(x - k * h);
    (45.0 * pair(1.0) - 9.0 * pair(2.0) + pair(3.0)) / (60.0 * h)
}

/// Probabilities to both sides of the middle and far into the tails.
fn probabilities() -> Vec<f64> {
    let left = [1e-6, 1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.25, 0.4, 0.5];
    let right = left.iter().rev().skip(1).map(|p| 1.0 - p);
    left.iter().copied().chain(right).collect()
}

#[test]
fn log_densities_are_those_of_statrs() {
    for prior in cases() {
        for p in probabilities() {
            let x = prior.quantile(p).unwrap();
            let (ours, theirs) =
                (log_density(&prior, x), by_statrs(&prior, x).0);
            // statrs's terms for shape 2000 are of the order 3e4.
            let tolerance = 1e-10 * (1.0 + ours.abs());
            assert!(
                (ours - theirs).abs() < tolerance,
                "{prior} at {x}: {ours} for {theirs}"
            );
        }
    }
}

#[test]
fn quantiles_invert_the_distribution_functions_of_statrs() {
    for prior in cases() {
        for p in probabilities() {
            let x = prior.quantile(p).unwrap();
            let back = by_statrs(&prior, x).1;
            // Where neighbouring numbers are further apart than that in p.
            let spacing = log_density(&prior, x).exp() * (x.next_up() - x);
            assert!(
                (back - p).abs() < 1e-10 + spacing,
                "{prior}: {back} for {p} at {x}"
            );
        }
    }
}

#[test]
fn quantiles_agree_with_reference_values() {
    // By mpmath with 40 digits, and the usual tables.
    let table = [
        (P::Gamma(0.5, 1.0), 1e-10, 7.853_981_633_974_483e-21),
        (P::Gamma(0.01, 1.0), 0.3, 2.917_417_191_745_872e-53),
        (P::Gamma(9.0, 1.0), 0.999999, 30.957_113_358_089_653),
        (P::Gamma(1e4, 1.0), 0.001, 9_693.824_385_823_726),
        (P::Beta(2.0, 5.0), 1e-6, 2.582_878_293_540_636e-4),
        (P::Beta(0.01, 3.0), 0.3, (-121.891_067_669_014_3_f64).exp()),
        (P::StudentT(0.5, 0.0, 1.0), 0.01, -1_028.491_010_471_621_9),
        (P::StudentT(9e3, 0.0, 1.0), 0.001, -3.091_138_119_225_445),
        (P::StudentT(2e4, 0.0, 1.0), 0.001, -3.090_639_861_854_331),
        (P::StudentT(1e300, 0.0, 1.0), 0.975, 1.959_963_984_540_054),
        (P::Cauchy(0.0, 1.0), 1e-20, -3.183_098_861_837_907e19),
        (P::HalfNormal(1.0), 1e-20, 1.253_314_137_315_500_3e-20),
    ];
    for (prior, p, expected) in table {
        let x = prior.quantile(p).unwrap();
        assert!((x / expected - 1.0).abs() < 1e-11, "{prior} at {p}: {x}");
    }
}

#[test]
fn densities_agree_with_reference_values_at_extremes() {
    // By mpmath with 40 digits.
    let table = [
        (P::StudentT(49.9, 0.0, 1.0), 1.5, -2.046_374_115_707_706_5),
        (P::StudentT(50.0, 0.0, 1.0), 1.5, -2.046_368_778_158_891),
        (P::StudentT(1e6, 0.0, 1.0), 2.0, -2.918_936_783_211_339_4),
        (P::StudentT(1e12, 0.0, 1.0), -3.0, -5.418_938_533_189_173),
        (P::StudentT(3.0, 0.0, 1.0), 1e200, -1_840.871_738_667_523_8),
        (P::Beta(1e-3, 2.0), 1e-300, 683.177_996_591_666_4),
    ];
    for (prior, x, expected) in table {
        let found = log_density(&prior, x);
        assert!(
            (found / expected - 1.0).abs() < 1e-13,
            "{prior} at {x}: {found}"
        );
        assert!(with_slopes(&prior, x).is_finite());
    }
}

#[test]
fn large_arguments_still_have_quantiles() {
    let near = |prior: AnyPrior, p, expected: f64, tolerance: f64| {
        let x = prior.quantile(p).unwrap();
        assert!(
            (x / expected - 1.0).abs() < tolerance,
            "{prior}: {x} for {expected}"
        );
    };
    let z = 2.326_347_874_040_841;
    // By mpmath with 30 digits, for both forms at shape 1e7.
    near(
        P::Gamma(1e7 * (1.0 + 1e-15), 1.0),
        0.99,
        10_007_358.028_510_87,
        1e-11,
    );
    near(P::Gamma(1e12, 1e-12), 0.99, 1.0 + z * 1e-6, 1e-11);
    near(P::Beta(1e6, 1e6), 0.5, 0.5, 1e-11);
    near(P::Beta(1e6, 1e6), 0.99, 0.500_822_487_724_975_3, 1e-11);
    near(P::Gamma(1e7, 1.0), 0.99, 10_007_358.028_510_87, 1e-11);
    // Beta(n, 1) has the quantile p^(1/n).
    near(P::Beta(1e9, 1.0), 0.99, 1.0 + 0.99_f64.ln() / 1e9, 1e-15);
}

#[test]
fn densities_integrate_to_the_difference_of_probabilities() {
    for prior in cases() {
        for pair in probabilities().windows(2) {
            let (a, b) = (prior.quantile(pair[0]), prior.quantile(pair[1]));
            let mass = integral(&prior, a.unwrap(), b.unwrap());
            let expected = pair[1] - pair[0];
            assert!(
                (mass - expected).abs() < 1e-8,
                "{prior}: {mass} between {pair:?}"
            );
        }
    }
}

/// The density's integral by Simpson's rule, in a coordinate where tails are
/// short: that of the support, or arsinh of the deviate on the line.
fn integral(prior: &AnyPrior, a: f64, b: f64) -> f64 {
    let support: Support<Plain> = prior.support();
    let middle = prior.quantile(0.5).unwrap();
    let scale = prior.quantile(0.75).unwrap() - middle;
    let to = |x: f64| match support {
        Support::Line => ((x - middle) / scale).asinh(),
        _ => support.to_line(x),
    };
    let f = |z: f64| match support {
        Support::Line => {
            let log = log_density(prior, middle + scale * z.sinh());
            log.exp() * scale * z.cosh()
        }
        _ => {
            let (x, jacobian) = support.from_line(Real::new(z));
            (prior.log_density(x) + jacobian).exp().value()
        }
    };
    let (low, n) = (to(a), 400);
    let h = (to(b) - low) / f64::from(n);
    let sum: f64 = (0..=n)
        .map(|i| {
            let weight = match i {
                _ if i == 0 || i == n => 1.0,
                _ if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * f(low + h * f64::from(i))
        })
        .sum();
    sum * h / 3.0
}

#[test]
fn slopes_agree_with_differences() {
    for prior in cases() {
        for p in [0.01, 0.3, 0.6, 0.97] {
            let x = prior.quantile(p).unwrap();
            let y = with_slopes(&prior, x);
            assert!((y.value() - log_density(&prior, x)).abs() < 1e-13);
            let width =
                prior.quantile(0.6).unwrap() - prior.quantile(0.4).unwrap();
            let near = |slope: f64, expected: f64, unit: f64, what: &str| {
                assert!(
                    ((slope - expected) * unit).abs()
                        < 1e-7 * (1.0 + (expected * unit).abs()),
                    "{prior}, {what} at {x}: {slope} for {expected}"
                );
            };
            let ends = Prior::<Plain>::support(&prior).ends();
            let room = width.min(x - ends.0).min(ends.1 - x);
            let by_x = difference(|x| log_density(&prior, x), x, 0.01 * room);
            near(y.partial(3), by_x, width, "x");
            for (i, v) in prior.arguments().into_iter().enumerate() {
                let h = match prior {
                    P::Normal(..) | P::Cauchy(..) if i == 0 => 0.05 * width,
                    P::StudentT(..) if i == 1 => 0.05 * width,
                    P::Uniform(..) => 1e-3,
                    _ if v == 0.0 => 0.01,
                    _ => 0.01 * v.abs(),
                };
                let f = |v| log_density(&changed(&prior, i, v), x);
                near(y.partial(i), difference(f, v, h), h, "argument");
            }
        }
    }
}

#[test]
fn draws_follow_the_distribution_functions() {
    for (i, prior) in cases().into_iter().enumerate() {
        let mut rng = Seed::new(7).child(i as u64).rng();
        let n = 20_000_u32;
        let mut draws: Vec<f64> =
            (0..n).map(|_| prior.draw(&mut rng).unwrap()).collect();
        draws.sort_by(f64::total_cmp);
        let n = f64::from(n);
        let statistic = (0_u32..)
            .zip(&draws)
            .map(|(k, &x)| {
                let p = by_statrs(&prior, x).1;
                let k = f64::from(k);
                (p - k / n).abs().max((p - (k + 1.0) / n).abs())
            })
            .fold(0.0, f64::max);
        // Kolmogorov's law is above 1.95 once in a thousand; there are 26.
        assert!(statistic * n.sqrt() < 1.95, "{prior}: {statistic}");
    }
}

#[test]
fn draws_and_quantiles_stay_strictly_inside() {
    let extremes = [
        P::Gamma(1e-3, 1.0),
        P::Gamma(1e-300, 1e300),
        P::InverseGamma(1e-3, 1.0),
        P::Beta(1e-3, 1e-3),
        P::Beta(1e-300, 1e300),
        P::LogNormal(800.0, 1e4),
        P::StudentT(1e-3, 0.0, 1.0),
        P::StudentT(1e-300, 1e300, 1e300),
        P::Cauchy(0.0, 1e308),
        P::Normal(1e308, 1e308),
        P::HalfCauchy(1e-308),
        P::Exponential(1e-310),
        P::Uniform(1.0, 1.0 + 4e-16),
    ];
    for prior in cases().into_iter().chain(extremes) {
        let support: Support<Plain> = prior.support();
        let mut rng = Seed::new(3).rng();
        for _ in 0..1000 {
            let x = prior.draw(&mut rng).unwrap();
            assert!(support.contains(x), "{prior} drew {x}");
        }
        for p in probabilities().into_iter().chain([1e-300, 1.0 - 1e-16]) {
            let x = prior.quantile(p).unwrap();
            assert!(support.contains(x), "{prior} at {p}: {x}");
        }
        let (low, high) = support.ends();
        assert_eq!(prior.quantile(0.0), Some(low));
        assert_eq!(prior.quantile(1.0), Some(high));
        for p in [-1e-300, 1.0 + 1e-15, f64::NAN, f64::INFINITY] {
            assert_eq!(prior.quantile(p), None);
        }
    }
}

#[test]
fn outside_the_support_the_density_is_zero() {
    for prior in cases() {
        let (low, high) = Prior::<Plain>::support(&prior).ends();
        for x in [low, high, low - 1.0, high + 1.0, f64::NAN] {
            let y = with_slopes(&prior, x);
            assert_eq!(y.value(), f64::NEG_INFINITY, "{prior} at {x}");
            assert!((0..4).all(|i| y.partial(i) == 0.0));
        }
    }
}

#[test]
fn impossible_arguments_are_impossible_in_every_way() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0];
    let mut rng = Seed::new(1).rng();
    for prior in cases() {
        for index in 0..prior.arguments().len() {
            for value in bad {
                let mut values = prior.arguments();
                values[index] = value;
                let text = format!("{}{values:?}", prior.name())
                    .replace('[', "(")
                    .replace(']', ")");
                let built = any::tests::build(prior.name(), &values);
                let possible = AnyPrior::parse(&text).is_ok();
                let x = prior.quantile(0.5).unwrap().max(0.5);
                let x = if prior.name() == "Uniform" { 0.6 } else { x };
                let log = log_density(&built, x);
                assert!(!log.is_nan(), "{text} at {x}");
                assert_eq!(
                    log > f64::NEG_INFINITY,
                    possible && Prior::<Plain>::support(&built).contains(x),
                    "{text} at {x}"
                );
                assert_eq!(built.quantile(0.5).is_some(), possible);
                assert_eq!(built.draw(&mut rng).is_some(), possible);
            }
        }
    }
}

#[test]
fn flat_is_flat_and_improper() {
    let flat = AnyPrior::parse(" Flat( ) ").unwrap();
    assert!(!flat.is_proper());
    assert_eq!(with_slopes(&flat, 1e300).value(), 0.0);
    assert_eq!(log_density(&flat, f64::NAN), f64::NEG_INFINITY);
    assert_eq!(flat.quantile(0.5), None);
    assert_eq!(flat.draw(&mut Seed::new(1).rng()), None);
    assert_eq!(flat.to_string(), "Flat()");
}

#[test]
fn the_way_to_the_line_and_back() {
    let supports: [Support<Plain>; 6] = [
        Support::Line,
        Support::Above(0.0.into()),
        Support::Above(Real::new(-2.0)),
        Support::Below(0.0.into()),
        Support::Below(Real::new(3.0)),
        Support::Between(Real::new(-1.0), Real::new(0.5)),
    ];
    for support in supports {
        for z in [-9.0, -2.0, -0.01, 0.0, 0.7, 8.0] {
            let (x, jacobian) = support.from_line(Real::new(z));
            assert!(support.contains(x.value()));
            assert!((support.to_line(x.value()) - z).abs() < 1e-11);
            let forward = |z| support.from_line(Real::new(z)).0.value();
            let slope = difference(forward, z, 0.01);
            assert!(
                (jacobian.value() - slope.ln()).abs() < 1e-8,
                "{support:?} at {z}"
            );
        }
    }
}

#[test]
fn the_way_from_the_line_has_slopes_far_out() {
    let v = D::variable;
    let support = Support::Between(v(1.0, 0), v(4.0, 1));
    for z in [-800.0, -400.0, -1.5, 0.0, 1.5, 400.0, 800.0] {
        let (x, jacobian) = support.from_line(v(z, 3));
        assert!(x.is_finite() && jacobian.is_finite(), "at {z}");
        let s = 1.0 / (1.0 + f64::exp(-z));
        assert!((x.partial(0) - (1.0 - s)).abs() < 1e-15);
        assert!((x.partial(1) - s).abs() < 1e-15);
        assert!((x.partial(3) - 3.0 * s * (1.0 - s)).abs() < 1e-15);
        assert!((jacobian.partial(3) - (1.0 - 2.0 * s)).abs() < 1e-15);
        assert!((jacobian.partial(1) - 1.0 / 3.0).abs() < 1e-15);
    }
}

fn message(text: &str) -> String {
    let error = AnyPrior::parse(text).unwrap_err();
    assert!(error.is_input());
    error.to_string()
}

#[test]
fn parse_errors_name_the_mend() {
    assert_eq!(
        message("Gamma(-1, 2)"),
        "prior \"Gamma(-1, 2)\": shape of Gamma(shape, scale) is -1, \
         expected a finite number above 0"
    );
    assert_eq!(
        message("Uniform(2, 1)"),
        "prior \"Uniform(2, 1)\": high of Uniform(low, high) is 1, expected \
         a finite number above low = 2"
    );
    assert_eq!(
        message("Gamma(9)"),
        "prior \"Gamma(9)\": found 1 argument, expected 2: write it as \
         Gamma(shape, scale)"
    );
    assert_eq!(
        message("gamma(9, 1)"),
        "prior \"gamma(9, 1)\": there is no distribution \"gamma\"; did you \
         mean \"Gamma\"? The distributions are Normal, LogNormal, Gamma, \
         InverseGamma, Exponential, Uniform, Beta, HalfNormal, HalfCauchy, \
         Cauchy, StudentT, Flat"
    );
    assert!(message("Studentt(3, 0, 1)").contains("\"StudentT\"?"));
    assert!(message("Lognormal(0, 1)").contains("\"LogNormal\"?"));
    assert!(message("Normal(0, 0)").contains("sd of Normal(mean, sd) is 0"));
    assert!(message("Normal(NaN, 1)").contains("mean of"));
    assert!(message("Normal(0, inf)").contains("is inf, expected"));
    assert!(message("Beta(2, 1e308)").contains("a size from 1e-15 to 1e15"));
    assert!(message("Gamma(1e-300, 1)").contains("is 1e-300, expected 0, or"));
    assert!(message("Normal(0, x)").contains("is \"x\", expected a number"));
    assert!(message("Normal(0,)").contains("is \"\", expected a number"));
    assert!(message("Normal()").contains("found 0 arguments, expected 2"));
    assert!(message("Flat(1)").contains("found 1 argument, expected 0"));
    assert!(message("Normal 0, 1").contains("in parentheses"));
    assert!(message("").contains("in parentheses"));
}

#[test]
fn names_and_arguments_are_those_of_the_list() {
    for prior in cases() {
        let entry = (prior.name(), prior.arguments().len());
        assert!(NAMES.contains(&entry));
    }
    assert_eq!(NAMES.first(), Some(&("Normal", 2)));
    assert_eq!(NAMES.last(), Some(&("Flat", 0)));
}

proptest! {
    #[test]
    fn texts_come_back(
        size in -14.99_f64..14.99,
        scale in 1e-12_f64..1e12,
    ) {
        let shape = 10.0_f64.powf(size);
        let prior = P::Gamma(shape, scale);
        prop_assert_eq!(AnyPrior::parse(&prior.to_string()), Ok(prior));
    }

    #[test]
    fn no_text_panics(text in "\\PC*", arguments in "[-0-9eEinfNa,. ]*") {
        let _ = AnyPrior::parse(&text);
        let _ = AnyPrior::parse(&format!("Normal({arguments})"));
    }
}
