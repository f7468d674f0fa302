//! The paper's study computed again, against an exact quadrature that others
//! made of the same experiment.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use couloir::infer::Quiet;
use couloir::reproduce::{page, reproduce, reproduction_json, words};

#[test]
fn a_small_study_is_whole() {
    let found = reproduce(2, 1, &Quiet).unwrap();
    let json = reproduction_json(&found);
    assert_eq!(json["schema"], 1);
    for prior in ["wide", "printed"] {
        let study = &json["priors"][prior];
        assert_eq!(study["log10_bf"].as_array().unwrap().len(), 2);
        for (model, names) in
            [("M0", &["mu", "xi", "sigma2"][..]), ("M1", &["phi"][..])]
        {
            for name in names {
                let share = study["coverage"][model][name].as_f64().unwrap();
                assert!((0.0..=100.0).contains(&share));
                let modes = study["map"][model][name].as_array().unwrap();
                assert_eq!(modes.len(), 2);
            }
        }
    }
    let html = page(&found);
    assert_eq!(html.matches("<svg").count(), 5);
    assert!(html.contains("Lautaret-like"));
    assert!(words(&found).iter().all(|s| !s.contains("NaN")));
}

#[test]
fn a_study_of_nothing_is_refused() {
    assert!(reproduce(0, 1, &Quiet).unwrap_err().is_input());
}

/// The prior's name, coverage under M0 and M1, and the Bayes factors.
///
/// Per cent of 400 series, by quadrature, and log10 B10: median, share above
/// 0, share above 2. Parameters in our order: mu, xi, sigma2 and mu, xi, phi,
/// sigma2.
type Figures = (&'static str, [f64; 3], [f64; 4], [f64; 3]);
const EXACT: [Figures; 2] = [
    ("wide", [64., 60., 80.], [99., 94., 92., 94.], [0.89, 81., 19.]),
    ("printed", [71., 57., 78.], [96., 12., 92., 93.], [1.38, 88., 35.]),
];

/// The standard error of the difference of a share of 100 and one of 400
/// series, of which `expected` per cent are expected.
fn error(expected: f64) -> f64 {
    let share: f64 = (expected / 100.0).clamp(0.02, 0.98);
    100.0 * (share * (1.0 - share) * (1.0 / 100.0 + 1.0 / 400.0)).sqrt()
}

/// Everything within three combined standard errors.
#[test]
#[ignore = "slow: `cargo slow`"]
fn coverage_and_bayes_factors_are_those_of_the_quadrature() {
    let found = reproduce(100, 1, &Quiet).unwrap();
    for (study, (name, m0, m1, bf)) in found.priors.iter().zip(EXACT) {
        assert_eq!(study.name, name);
        for (model, expected) in study.models.iter().zip([&m0[..], &m1[..]]) {
            let counts = model.covered.iter().zip(expected);
            for ((count, expected), parameter) in counts.zip(&model.names) {
                let apart = *count as f64 - expected;
                assert!(
                    apart.abs() < 3.0 * error(*expected),
                    "{name} {parameter}: {count} against {expected}"
                );
            }
        }
        let mut seen = study.log10_bf();
        seen.sort_by(f64::total_cmp);
        let above = |t: f64| seen.iter().filter(|x| **x > t).count() as f64;
        assert!((above(0.0) - bf[1]).abs() < 3.0 * error(bf[1]), "{name}");
        assert!((above(2.0) - bf[2]).abs() < 3.0 * error(bf[2]), "{name}");
        // The median of n values of spread s has the error 1.25 s/sqrt(n).
        let spread = (seen[83] - seen[15]) / 2.0;
        let median = 0.5 * (seen[49] + seen[50]);
        let error = 1.25 * spread * (0.01_f64 + 0.0025).sqrt();
        assert!((median - bf[0]).abs() < 3.0 * error, "{name}: {median}");
    }
}
