//! Moments as logs write them: numbers, times of the day, dates with times.

/// A moment that was read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    /// Seconds on the log's own clock; since 1970 where there is a date.
    pub(super) seconds: f64,
    /// Whether the cell was a clock's time, and not a plain number.
    pub(super) is_clock: bool,
    /// By how much the cell's clock is ahead of these seconds \[s\].
    pub(super) ahead: f64,
}

impl Moment {
    /// A plain number's.
    pub(super) fn number(seconds: f64) -> Self {
        Self { seconds, is_clock: false, ahead: 0.0 }
    }

    /// Whether it has a date.
    pub(super) fn is_dated(&self) -> bool {
        self.is_clock && self.seconds > 2.0 * DAY
    }
}

/// Seconds of a day.
pub(super) const DAY: f64 = 86_400.0;

/// Reads a number of `unit` seconds, `hh:mm:ss.s`, a date with a time as in
/// `2022-02-22T07:51:22.8Z`, or a u-blox `2022:2:22:7:51:22:800`.
pub(super) fn moment(cell: &str, unit: f64) -> Option<Moment> {
    let cell = cell.trim();
    if let Ok(number) = cell.parse::<f64>() {
        let seconds = number * unit;
        return seconds.is_finite().then_some(Moment::number(seconds));
    }
    let mut ahead = 0.0;
    let seconds = match cell.split_once(['T', ' ']) {
        Some((date, time)) => {
            let (seconds, off) = dated(date.trim(), time.trim())?;
            ahead = -off;
            seconds
        }
        None => match numbers(cell, ':')?[..] {
            [h, m, s] => of_day(h, m, s)?,
            [h, m] => of_day(h, m, 0.0)?,
            [y, mo, d, h, m, s] => days(y, mo, d)? * DAY + of_day(h, m, s)?,
            [y, mo, d, h, m, s, ms] if (0.0..1000.0).contains(&ms) => {
                days(y, mo, d)? * DAY + of_day(h, m, s)? + 1e-3 * ms
            }
            _ => return None,
        },
    };
    Some(Moment { seconds, is_clock: true, ahead })
}

/// A date and a time, which may end in its distance from Greenwich; with what
/// that distance adds.
fn dated(date: &str, time: &str) -> Option<(f64, f64)> {
    let day = match date {
        _ if date.contains('-') => numbers(date, '-')?,
        _ if date.contains('/') => numbers(date, '/')?,
        _ => numbers(date, '.')?.into_iter().rev().collect(),
    };
    let [y, m, d] = day[..] else { return None };
    let time = time.strip_suffix("UTC").unwrap_or(time).trim();
    let time = time.strip_suffix(['Z', 'z']).unwrap_or(time);
    let (time, off) = match time.rfind(['+', '-']) {
        None => (time, 0.0),
        Some(at) => {
            let sign = if time[at..].starts_with('-') { 1.0 } else { -1.0 };
            (&time[..at], sign * zone(&time[at + 1..])?)
        }
    };
    let [h, min, s] = numbers(time, ':')?[..] else { return None };
    Some((days(y, m, d)? * DAY + of_day(h, min, s)? + off, off))
}

fn zone(text: &str) -> Option<f64> {
    match numbers(text, ':')?[..] {
        [h, m] => of_day(h, m, 0.0),
        [h] if h < 24.0 => Some(3600.0 * h),
        [hm] => of_day((hm / 100.0).floor(), hm % 100.0, 0.0),
        _ => None,
    }
}

/// The plain numbers, 0 or more, between the separators.
fn numbers(text: &str, separator: char) -> Option<Vec<f64>> {
    let number = |part: &str| {
        let plain = part.bytes().all(|b| b.is_ascii_digit() || b == b'.');
        part.parse::<f64>().ok().filter(|_| plain)
    };
    text.split(separator).map(|part| number(part.trim())).collect()
}

fn of_day(hours: f64, minutes: f64, seconds: f64) -> Option<f64> {
    let fits = hours <= 24.0 && minutes < 60.0 && seconds < 61.0;
    fits.then_some(3600.0 * hours + 60.0 * minutes + seconds)
}

/// Days from 1970-01-01 to a date of the Gregorian calendar.
fn days(year: f64, month: f64, day: f64) -> Option<f64> {
    let whole = [year, month, day].iter().all(|x| x.fract() == 0.0);
    let fits = (1.0..=9999.0).contains(&year)
        && (1.0..=12.0).contains(&month)
        && (1.0..=31.0).contains(&day);
    if !(whole && fits) {
        return None;
    }
    // The year begins in March, so that the leap day is its last.
    let year = if month > 2.0 { year } else { year - 1.0 };
    let month = (month + 9.0) % 12.0;
    let of_year = ((153.0 * month + 2.0) / 5.0).floor() + day - 1.0;
    let leaps =
        (year / 4.0).floor() - (year / 100.0).floor() + (year / 400.0).floor();
    Some(365.0 * year + leaps + of_year - 719_468.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(cell: &str) -> Option<f64> {
        moment(cell, 0.001).map(|m| m.seconds)
    }

    #[test]
    fn moments_are_read_as_logs_write_them() {
        assert!((at("201100800").unwrap() - 201_100.8).abs() < 1e-6);
        assert_eq!(at("07:51:22.5"), Some(28_282.5));
        assert_eq!(at("1970-01-02 00:00:01"), Some(DAY + 1.0));
        assert_eq!(at("02.01.1970 00:00:01"), Some(DAY + 1.0));
        // `date -u -d 2022-02-22T07:51:22Z +%s`
        let known = Some(1_645_516_282.0);
        for text in [
            "2022-02-22T07:51:22Z",
            "2022-02-22T08:51:22+01:00",
            "2022-02-22 05:51:22-0200",
            "2022:2:22:7:51:22",
            "2022:2:22:7:51:22:0",
        ] {
            assert_eq!(at(text), known, "{text}");
        }
    }

    #[test]
    fn what_is_no_moment_is_none() {
        for text in [
            "",
            "noon",
            "1:2:3:4",
            "25:00:00",
            "2022-13-01T00:00:00",
            "T",
            "nan",
            "inf",
            "1:-2",
            "2022-02-22T",
            "ä:ö",
            "-:+",
            "1e400",
        ] {
            assert_eq!(at(text), None, "{text:?}");
        }
    }
}
