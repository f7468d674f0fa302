//! Supports: their ends, and the way to the real line.

use crate::prior::{AnyPrior, Support};
use crate::scalar::{Plain, Real};

#[test]
fn the_ends_are_outside() {
    let (low, high) = (Real::<Plain>::new(-2.0), Real::new(3.0));
    let (nan, infinite) = (f64::NAN, f64::INFINITY);
    for (support, inside, outside) in [
        (Support::Line, [-1e300, 1e300], [nan, infinite]),
        (Support::Above(low), [-1.999, 1e300], [-2.0, infinite]),
        (Support::Below(high), [-1e300, 2.999], [3.0, -infinite]),
        (Support::Between(low, high), [-1.999, 2.999], [-2.0, 3.0]),
    ] {
        for x in inside {
            assert!(support.contains(x), "{support:?} {x}");
        }
        for x in outside {
            assert!(!support.contains(x), "{support:?} {x}");
            assert!(!support.to_line(x).is_finite(), "{support:?} {x}");
        }
    }
}

#[test]
fn the_nearest_number_inside_can_be_divided_by() {
    let (low, high) = (Real::new(0.0), Real::new(2.0));
    let positive = Support::<Plain>::Above(low);
    assert_eq!(positive.nearest(-1.0), f64::MIN_POSITIVE);
    assert_eq!(positive.nearest(0.5), 0.5);
    let between = Support::<Plain>::Between(low, high);
    assert_eq!(between.nearest(7.0), 2.0_f64.next_down());
    let above_one = Support::<Plain>::Above(Real::new(1.0));
    assert_eq!(above_one.nearest(1.0), 1.0_f64.next_up());
}

#[test]
fn a_prior_finds_the_place_of_a_value_and_back() {
    let positive = AnyPrior::LogNormal(0.0, 1.0);
    assert_eq!(positive.line_of(5.0), 5.0_f64.ln());
    assert_eq!(positive.value_at(2.0), 2.0_f64.exp());
    assert!(!positive.line_of(-1.0).is_finite());
}
