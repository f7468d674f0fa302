//! Distributions made of others: by reference, mixed, and cut off.

use crate::prior::{
    AnyPrior, Beta, Cauchy, Distribution, Exponential, Flat, Gamma,
    HalfCauchy, HalfNormal, InverseGamma, LogNormal, Mixture, Normal, Prior,
    StudentT, Truncated, Uniform,
};
use crate::scalar::{Plain, Real};
use crate::seed::Seed;

/// What a distribution says of itself at some numbers.
fn said<D: Prior<Plain>>(of: D) -> (Vec<Option<f64>>, bool) {
    let mut all: Vec<Option<f64>> =
        [0.0, 0.3, 0.9, 1.0].map(|p| of.quantile(p)).to_vec();
    all.push(of.draw(&mut Seed::new(4).rng()));
    all.push(Some(of.log_density(Real::new(0.8)).value()));
    all.push(Some(of.support().ends().0));
    (all, of.is_proper())
}

#[test]
fn a_reference_says_what_it_refers_to_says() {
    let uniform = Uniform::<Plain>::new(0.5, 3.0);
    let known = said(uniform);
    assert_eq!(said::<&Uniform<Plain>>(&uniform), known);
    assert!(known.1 && known.0.iter().all(Option::is_some));
    let flat = Flat::<Plain>::new();
    assert_eq!(said::<&Flat<Plain>>(&flat), said(flat));
    assert!(!said(flat).1);
}

#[test]
fn every_family_but_flat_is_proper() {
    for prior in super::cases() {
        assert!(<AnyPrior as Prior<Plain>>::is_proper(&prior), "{prior}");
        assert!(prior.is_proper(), "{prior}");
    }
    let normal = Normal::<Plain>::new(0.0, 1.0);
    let all = [
        normal.is_proper(),
        Truncated::new(normal, 0.0, 1.0).is_proper(),
        LogNormal::<Plain>::new(0.0, 1.0).is_proper(),
        Gamma::<Plain>::new(2.0, 1.0).is_proper(),
        InverseGamma::<Plain>::new(2.0, 1.0).is_proper(),
        Exponential::<Plain>::new(1.0).is_proper(),
        Uniform::<Plain>::new(0.0, 1.0).is_proper(),
        Beta::<Plain>::new(2.0, 1.0).is_proper(),
        HalfNormal::<Plain>::new(1.0).is_proper(),
        HalfCauchy::<Plain>::new(1.0).is_proper(),
        Cauchy::<Plain>::new(0.0, 1.0).is_proper(),
        StudentT::<Plain>::new(3.0, 0.0, 1.0).is_proper(),
    ];
    assert_eq!(all, [true; 12]);
}

#[test]
fn a_mixture_knows_its_ends_and_is_as_proper_as_its_parts() {
    let uniforms = [Uniform::<Plain>::new(0.0, 1.0), Uniform::new(5.0, 9.0)];
    let mixed = Mixture::<Plain, _>::new([0.5, 0.5], uniforms);
    assert!(mixed.is_proper());
    let quantiles = [0.0, 0.5, 1.0].map(|p| mixed.quantile(p));
    assert_eq!(quantiles, [Some(0.0), None, Some(9.0)]);
    let parts = (Normal::<Plain>::new(0.0, 1.0), Flat::new());
    assert!(!Mixture::<Plain, _>::new([0.5, 0.5], parts).is_proper());
}

#[test]
fn what_is_cut_off_has_no_density_beyond_its_ends() {
    let cut = Truncated::new(Normal::<Plain>::new(0.0, 1.0), -1.0, 2.0);
    let log = |x| cut.log_density(Real::new(x)).value();
    for x in [-1.5, -1.0, 2.0, 2.5] {
        assert_eq!(log(x), f64::NEG_INFINITY, "{x}");
    }
    assert!(log(-0.99).is_finite() && log(1.99).is_finite());
    assert_eq!(cut.support().ends(), (-1.0, 2.0));
}
