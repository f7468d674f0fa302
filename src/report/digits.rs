//! Numbers as a reader wants them: significant digits, never more than the
//! uncertainty supports.

/// What stands where a number is not available.
pub(crate) const NONE: &str = "n/a";

/// The decimal exponent of a number: 0 for 1.5, 2 for 480.
fn exponent(x: f64) -> i32 {
    if x == 0.0 || !x.is_finite() {
        return 0;
    }
    x.abs().log10().floor() as i32
}

/// The number with that many significant digits.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    fixed(x, digits as i32 - 1 - exponent(x), digits)
}

/// The number with at most that many significant digits, zeros at the end of
/// its decimals left out.
pub(crate) fn short(x: f64, digits: usize) -> String {
    let text = significant(x, digits);
    if !text.contains('.') || text.contains('e') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The number with as many decimals as give its standard deviation two
/// significant digits.
pub(crate) fn beside(x: f64, sd: f64) -> String {
    let comparable = x == 0.0 || sd.abs() > 1e-6 * x.abs();
    if !sd.is_finite() || sd == 0.0 || !comparable {
        return significant(x, 4);
    }
    fixed(x, 1 - exponent(sd), 3)
}

fn fixed(x: f64, decimals: i32, digits: usize) -> String {
    if !x.is_finite() {
        return NONE.to_owned();
    }
    if x != 0.0 && !(-4..7).contains(&exponent(x)) {
        return format!("{x:.*e}", digits.saturating_sub(1));
    }
    let text = format!("{x:.*}", decimals.clamp(0, 8) as usize);
    let zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    text.strip_prefix('-').filter(|_| zero).map_or(text.clone(), str::to_owned)
}

/// A p-value.
pub(crate) fn p_value(p: f64) -> String {
    match p {
        p if !p.is_finite() => NONE.to_owned(),
        p if p < 0.001 => "< 0.001".to_owned(),
        p if p < 0.01 => "< 0.01".to_owned(),
        p => format!("{p:.2}"),
    }
}

/// A count or an effective sample size.
pub(crate) fn whole(x: f64) -> String {
    if x.abs() >= 1e7 { significant(x, 3) } else { fixed(x, 0, 3) }
}

/// A count with thin spaces between groups of three digits.
#[cfg(feature = "pages")]
pub(crate) fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(c);
    }
    out
}

/// A share in per cent.
pub(crate) fn per_cent(share: f64) -> String {
    if !share.is_finite() {
        return NONE.to_owned();
    }
    format!("{:.0} %", 100.0 * share)
}

/// The 90 % interval of a share of which `hits` of `of` are known: Wilson's
/// (1927), which stays between 0 and 1.
#[cfg(feature = "cli")]
pub(crate) fn share_interval(hits: usize, of: usize) -> (f64, f64) {
    const Z: f64 = 1.645;
    let (n, share) = (of as f64, hits as f64 / of as f64);
    let middle = share + Z * Z / (2.0 * n);
    let spread = share * (1.0 - share) / n + (Z / (2.0 * n)).powi(2);
    let (half, whole) = (Z * spread.sqrt(), 1.0 + Z * Z / n);
    let end = |x: f64| (x / whole).clamp(0.0, 1.0);
    (end(middle - half), end(middle + half))
}

/// Round values between two bounds, some `count` of them and two if the
/// bounds allow it, with labels of equal precision.
pub(crate) fn ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let count = count.max(1);
    let mut tried = (count..count + 4).map(|n| ticks_of(low, high, n));
    let enough = tried.find(|marks| marks.len() > 1);
    enough.unwrap_or_else(|| ticks_of(low, high, count))
}

fn ticks_of(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let span = high - low;
    let step = round_step(span / count as f64);
    if !(step > 0.0 && step.is_finite() && low + 0.1 * step > low) {
        return vec![(low, significant(low, 4))];
    }
    let first = (low / step - 1e-9).ceil();
    (0..)
        .map(|i| (first + f64::from(i)) * step)
        .take_while(|v| *v <= high + 1e-9 * span)
        .map(|v| (v, tick_label(v, step, low.abs().max(high.abs()))))
        .collect()
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `raw`.
fn round_step(raw: f64) -> f64 {
    let unit = 10_f64.powi(exponent(raw));
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter();
    factor.map(|f| f * unit).find(|s| *s >= raw * 0.999).unwrap_or(raw)
}

fn tick_label(v: f64, step: f64, largest: f64) -> String {
    let v = if v.abs() < 1e-9 * step { 0.0 } else { v };
    let decimals = (-exponent(step * 1.000_001)).max(0);
    if largest >= 1e6 || decimals > 4 {
        let digits = exponent(v) - exponent(step * 1.000_001);
        return match v {
            0.0 => "0".to_owned(),
            v => format!("{v:.*e}", digits.clamp(0, 8) as usize),
        };
    }
    format!("{v:.*}", decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_uncertainty() {
        assert_eq!(beside(0.34127, 0.081), "0.341");
        assert_eq!(beside(1034.2, 410.0), "1034");
        assert_eq!(beside(2.0, 0.0), "2.000");
        assert_eq!(beside(-0.0001, 0.5), "0.00");
        assert_eq!(significant(1.23456, 3), "1.23");
        assert_eq!(significant(f64::NAN, 3), "n/a");
        assert_eq!(short(4.0, 3), "4");
        assert_eq!(short(41.3, 3), "41.3");
        assert_eq!(short(100.0, 3), "100");
        assert_eq!(significant(3.2e-9, 2), "3.2e-9");
    }

    #[test]
    fn a_small_p_is_never_zero() {
        assert_eq!(p_value(0.0004), "< 0.001");
        assert_eq!(p_value(0.004), "< 0.01");
        assert_eq!(p_value(0.014), "0.01");
    }

    #[cfg(feature = "cli")]
    #[test]
    fn a_share_has_an_interval_between_0_and_1() {
        // Newcombe 1998, table I, method 3, by its formula at 90 %.
        let (low, high) = share_interval(81, 263);
        assert!((low - 0.263).abs() < 1e-3 && (high - 0.357).abs() < 1e-3);
        assert_eq!(share_interval(4, 4).1, 1.0);
        assert_eq!(share_interval(0, 4).0, 0.0);
        assert!(share_interval(4, 4).0 > 0.5);
    }

    #[test]
    fn ticks_are_round() {
        let labels = |low, high| -> Vec<String> {
            ticks(low, high, 4).into_iter().map(|t| t.1).collect()
        };
        assert_eq!(labels(0.0, 20.0), ["0", "5", "10", "15", "20"]);
        assert_eq!(labels(-0.3, 0.3), ["-0.2", "0.0", "0.2"]);
        assert_eq!(labels(0.0, 3e-6), ["0", "1e-6", "2e-6", "3e-6"]);
        assert_eq!(labels(0.55, 1.35), ["0.6", "0.8", "1.0", "1.2"]);
        assert_eq!(labels(1.0, 1.0).len(), 1);
        assert_eq!(labels(1.0, 1.0 + 1e-16).len(), 1);
    }
}
