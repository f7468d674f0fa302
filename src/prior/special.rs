//! The special functions that several distributions share.

use std::f64::consts::FRAC_1_SQRT_2;

use statrs::function::erf::erfc;
use statrs::function::gamma;

use crate::scalar::{Kind, Real};

/// ln sqrt(2 pi).
pub(crate) const LN_SQRT_2PI: f64 = 0.918_938_533_204_672_8;

/// ln of the gamma function for x > 0; its derivative, digamma, is worked
/// out only for an `x` that has derivatives.
#[inline]
pub(super) fn ln_gamma<K: Kind>(x: Real<K>) -> Real<K> {
    let value = gamma::ln_gamma(x.value());
    if x.is_constant() {
        return Real::new(value);
    }
    x.chain(value, gamma::digamma(x.value()))
}

/// ln(1 + q^2) without overflow.
#[inline]
pub(super) fn ln_1p_squared<K: Kind>(q: Real<K>) -> Real<K> {
    let v = q.value();
    if v.abs() < 1e8 {
        q.chain((v * v).ln_1p(), 2.0 * v / (1.0 + v * v))
    } else {
        // 1 is lost beside q^2.
        q.chain(2.0 * v.abs().ln(), 2.0 / v)
    }
}

/// ln of the probability of a standard normal number below `z`.
pub(super) fn ln_normal_below<K: Kind>(z: Real<K>) -> Real<K> {
    let v = z.value();
    let value = if v > 0.0 {
        (-0.5 * erfc(v * FRAC_1_SQRT_2)).ln_1p()
    } else if v > -20.0 {
        (0.5 * erfc(-v * FRAC_1_SQRT_2)).ln()
    } else {
        ln_normal_tail(v)
    };
    let slope = match v.is_finite() {
        true => (-0.5 * v * v - LN_SQRT_2PI - value).exp(),
        false => 0.0,
    };
    z.chain(value, slope)
}

/// The same far below 0, by 1 - 1/z^2 + 3/z^4 - 15/z^6 + ... (Abramowitz and
/// Stegun 1964, 26.2.12); the first term left out is below 1e-16 at -20.
fn ln_normal_tail(z: f64) -> f64 {
    let inverse = 1.0 / (z * z);
    let mut sum = 1.0;
    for odd in [15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        sum = 1.0 - odd * inverse * sum;
    }
    -0.5 * z * z - (-z).ln() - LN_SQRT_2PI + sum.ln()
}

/// The standard normal quantile for 0 < p < 1.
pub(super) fn normal_quantile(p: f64) -> f64 {
    use statrs::distribution::{ContinuousCDF, Normal};
    Normal::standard().inverse_cdf(p)
}

/// Where in `low..high` an increasing function vanishes, by Newton's steps
/// from `start` and bisection where these leave what is left of the interval;
/// `f` gives value and slope, minus infinity being a value too.
///
/// For the logarithm of a log-concave distribution function the steps from
/// the far end of a tail never overshoot, so that bisection only helps where
/// f underflows.
pub(super) fn root(
    (mut low, mut high): (f64, f64),
    start: f64,
    f: impl Fn(f64) -> (f64, f64),
) -> f64 {
    let mut u = start;
    for _ in 0..200 {
        let (value, slope) = f(u);
        let newton = u - value / slope;
        // Round-off of u and, as f is a logarithm, of f.
        let round_off = 1e-15 * (u.abs() * slope + 1.0);
        if newton.is_finite() && value.abs() <= round_off {
            return newton;
        }
        if value > 0.0 {
            high = high.min(u);
        } else {
            low = low.max(u);
        }
        u = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
    }
    u
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Grad;

    #[test]
    fn ln_gamma_knows_factorials_and_their_slope() {
        let y = ln_gamma(Real::<Grad<1>>::variable(5.0, 0));
        assert!((y.value() - 24.0_f64.ln()).abs() < 1e-14);
        // digamma(5) = 1 + 1/2 + 1/3 + 1/4 - Euler's constant.
        let digamma = 25.0 / 12.0 - 0.577_215_664_901_532_9;
        assert!((y.partial(0) - digamma).abs() < 1e-14);
    }

    #[test]
    fn ln_1p_squared_is_smooth_where_its_forms_meet() {
        let f = |q| ln_1p_squared(Real::<Grad<1>>::variable(q, 0));
        let (below, above) = (f(-1e8 * (1.0 - 1e-15)), f(-1e8));
        assert!((below.value() - above.value()).abs() < 1e-13);
        assert!((below.partial(0) / above.partial(0) - 1.0).abs() < 1e-14);
        assert!(
            (f(1e300).value() / (600.0 * 10.0_f64.ln()) - 1.0).abs() < 1e-15
        );
    }

    #[test]
    fn far_tails_of_the_normal_keep_their_digits() {
        // By mpmath with 40 digits.
        for (z, known) in [
            (-20.5, -214.066_728_963_263_8),
            (-25.0, -316.639_408_008_020_26),
            (-40.0, -804.608_442_013_753_8),
        ] {
            let f = |z| ln_normal_below(Real::<Grad<1>>::variable(z, 0));
            let found = f(z);
            assert!((found.value() / known - 1.0).abs() < 1e-15, "{z}");
            let slope = (f(z + 1e-5) - f(z - 1e-5)).value() / 2e-5;
            // A difference of numbers of some hundreds: their round-off.
            assert!((found.partial(0) - slope).abs() < 1e-7, "{z}");
        }
    }

    #[test]
    fn root_bisects_where_newton_fails() {
        // ln of a distribution function that underflows below -30.
        let f = |u: f64| (if u < -30.0 { f64::NEG_INFINITY } else { u }, 1.0);
        assert!(root((-1e3, 1e3), -1e3, f).abs() < 1e-14);
    }
}
