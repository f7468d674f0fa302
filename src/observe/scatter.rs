//! How uncertain a distance is that recorded speeds add up to.
//!
//! The scatter is read off second differences v(i-h) - 2 v(i) + v(i+h), which
//! a smooth motion hardly has. For errors with the autocorrelation phi^k and
//! the variance s2 their mean square at the lag h is
//!
//! ```text
//! D_h = 2 s2 (1 - phi^h)(3 - phi^h),
//! ```
//!
//! so that D_h/D_1 tells phi, and D_1 then s2. The sum over a duration T in
//! steps dt has the variance s2 T dt (1 + phi)/(1 - phi).

use super::series::{Quantity, Series};

/// The greatest autocorrelation considered: beyond it errors look as the
/// motion does. It is less where there are few values, which do not tell one
/// above 1 - 8/n: of 21 a quarter would be taken for 0.95 without any.
const HIGHEST_PHI: f64 = 0.95;
const NEEDED: f64 = 8.0;

/// The longest lag: over a longer one the motion bends too.
const LONGEST_LAG: usize = 8;

/// The standard error of the distance that a series of speeds adds up to
/// \[m\]; 0 for other quantities, and below five values.
pub(super) fn reach_error(series: &Series) -> f64 {
    let (times, values) = (series.times(), series.values());
    let duration = times.last().copied().unwrap_or(0.0);
    if series.quantity() != Quantity::Velocity || values.len() < 5 {
        return 0.0;
    }
    let lag = (values.len() / 8).clamp(1, LONGEST_LAG);
    let (near, far) = (bends(values, 1), bends(values, lag));
    if near <= 0.0 {
        return 0.0;
    }
    let highest = (1.0 - NEEDED / values.len() as f64).min(HIGHEST_PHI);
    let phi = correlation(far / near, lag, highest.max(0.0));
    let variance = near / (2.0 * (1.0 - phi) * (3.0 - phi));
    let step = duration / values.len() as f64;
    (variance * duration * step * (1.0 + phi) / (1.0 - phi)).sqrt()
}

/// The mean square of the second differences at a lag.
fn bends(values: &[f64], lag: usize) -> f64 {
    let triples = values.windows(2 * lag + 1);
    let count = triples.len().max(1) as f64;
    triples.map(|v| (v[0] - 2.0 * v[lag] + v[2 * lag]).powi(2)).sum::<f64>()
        / count
}

/// phi of the ratio D_h/D_1, which rises with it; errors that alternate
/// count as uncorrelated.
fn correlation(ratio: f64, lag: usize, highest: f64) -> f64 {
    let bend = |phi: f64| (1.0 - phi) * (3.0 - phi);
    let of = |phi: f64| bend(phi.powi(lag as i32)) / bend(phi);
    let (mut low, mut high) = (0.0, highest);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if of(middle) < ratio { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::draws::median;
    use crate::observe::Event;
    use crate::observe::series::path_length;
    use crate::physics::Track;
    use crate::seed::Seed;

    /// 20 m/s for 25 s, and errors of 2 m/s: 500 m, give or take 10.
    #[test]
    fn what_scatter_explains_is_not_refused() {
        let times: Vec<f64> = (1..=25).map(f64::from).collect();
        let speeds = (0..25).map(|i| {
            let odd = f64::from(i * 7 % 5) - 2.0;
            20.0 + 1.4 * odd
        });
        let series = Series::velocity(times, speeds.collect()).unwrap();
        let reach = path_length(0.0, series.times(), series.values());
        let on = |length: f64| {
            let track =
                Track::incline(20.0, length * 20_f64.to_radians().cos());
            Event::on(track.unwrap()).velocity(series.clone()).build()
        };
        assert!(on(reach - 5.0).is_ok());
        let error = on(reach - 200.0).unwrap_err().to_string();
        assert!(error.contains("may be its scatter"), "{error}");
    }

    /// The spread of the summed distance over 400 recordings of one motion,
    /// and the median of what each says of it.
    fn known_and_said(phi: f64) -> (f64, f64) {
        let times: Vec<f64> = (1..=150).map(|i| 0.2 * f64::from(i)).collect();
        let mut said = Vec::new();
        let reach: Vec<f64> = (0..400)
            .map(|seed| {
                let mut rng = Seed::new(seed).rng();
                let mut z = || -> f64 { StandardNormal.sample(&mut rng) };
                let mut error = z() / (1.0 - phi * phi).sqrt();
                let seen = times.iter().map(|t| {
                    error = phi * error + z();
                    25.0 - (t - 15.0).powi(2) / 9.0 + error
                });
                let seen: Vec<f64> = seen.collect();
                let reach = path_length(0.0, &times, &seen);
                let series = Series::velocity(times.clone(), seen).unwrap();
                said.push(reach_error(&series));
                reach
            })
            .collect();
        let mean = reach.iter().sum::<f64>() / 400.0;
        let square = reach.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        ((square / 399.0).sqrt(), median(&said))
    }

    #[test]
    fn the_error_of_a_sum_is_that_of_repeated_recordings() {
        for phi in [0.0, 0.5, 0.8] {
            let (known, said) = known_and_said(phi);
            let ratio = said / known;
            // The spread is known to 4 %; the estimate was within 15 % of it
            // in another program's 200 recordings of the same kind.
            assert!((0.75..1.3).contains(&ratio), "{phi}: {said} {known}");
        }
    }

    #[test]
    fn a_smooth_motion_has_none() {
        let times: Vec<f64> = (1..=50).map(f64::from).collect();
        let speeds = times.iter().map(|t| 2.0 * t).collect();
        let series = Series::velocity(times, speeds).unwrap();
        assert!(reach_error(&series) < 1e-9);
    }
}
