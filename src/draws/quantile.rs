//! Quantiles of draws.

/// The quantile at probability `p` of numbers in rising order, between
/// neighbours by linear interpolation (type 7 of Hyndman & Fan 1996).
///
/// NaN for no numbers, a `p` outside 0 to 1, or where a NaN sorted last.
///
/// ```
/// use couloir::draws::quantile;
/// assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.75), 3.0);
/// assert!(quantile(&[], 0.5).is_nan());
/// ```
pub fn quantile(sorted: &[f64], p: f64) -> f64 {
    let (Some(last), true) = (sorted.last(), (0.0..=1.0).contains(&p)) else {
        return f64::NAN;
    };
    if last.is_nan() {
        return f64::NAN;
    }
    let position = p * (sorted.len() - 1) as f64;
    let below = sorted[position.floor() as usize];
    let above = sorted[position.ceil() as usize];
    match position.fract() {
        _ if below == above => below,
        0.0 => below,
        fraction => below + fraction * (above - below),
    }
}

/// The median of values in any order.
pub(crate) fn median(values: &[f64]) -> f64 {
    quantile(&sorted(values.to_vec()), 0.5)
}

/// Numbers in rising order, NaN last whatever its sign.
pub(super) fn sorted(mut numbers: Vec<f64>) -> Vec<f64> {
    for x in numbers.iter_mut().filter(|x| x.is_nan()) {
        *x = f64::NAN;
    }
    numbers.sort_unstable_by(f64::total_cmp);
    numbers
}
