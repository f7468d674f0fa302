//! A likelihood on one line, without a warning; references to numbers, of
//! unknowns and of data.
#![deny(warnings)]
use couloir::model;

model! {
    struct OneLine { many: Vec<f64>, at: Vec<f64> }

    mean ~ Normal(0.0, 1.0);
    slope[2] ~ Normal(0.0, 1.0);
    let ahead = slope.iter().zip(&[1.0, 2.0]).map(|(s, shift)| 2.0 * s - shift);
    let steeper = ahead.sum::<couloir::Real<_>>();
    likelihood { for (y, x) in many.iter().zip(at) { y ~ Normal(mean + steeper * x, 1.0); } }
}

#[test]
fn a_likelihood_on_one_line() {
    let _ = OneLine::new;
}
