//! Whether the values of a recording can be what they are said to be.
//!
//! What no mass on a slope does is refused, with the line and the likely slip:
//! a mark for "not measured", another unit, another clock, the other sign.
//! What the scatter of a sensor explains stays, and what could be true is
//! warned of elsewhere (`doubtful.rs`).

use crate::draws::median;
use crate::observe::Quantity;

/// Numbers that stand for "not measured" in files of loggers and of terrain
/// models.
const MARKS: [f64; 5] = [-999.0, -9999.0, -99999.0, -32767.0, -32768.0];

/// Numbers that do so without their sign, too, and may be measured.
const UNSIGNED: [f64; 6] =
    [999.0, 9999.0, 99999.0, 999_999.0, 32767.0, 32768.0];

/// So many times the greatest of the other values is such a number where it
/// is a mark: of a place, which grows, and of a speed or an acceleration.
const ABOVE_OTHERS: (f64, f64) = (10.0, 2.0);

/// More than a mass on a slope has over half a recording \[m/s2\]: three
/// times what gravity gives.
const SUSTAINED: f64 = 30.0;

/// Values beyond what can be are strays where so many times the others do not
/// reach the least of them: between units there is no such gap.
const STRAY: f64 = 3.0;

/// The longest that a recording may last, and begin, after the release [s].
const LATEST: f64 = 3600.0;

/// Faster than any avalanche or rock fall that was measured [m/s].
pub(crate) const FASTEST: f64 = 120.0;

/// More than any sensor in a flow shows [m/s2].
const HARDEST: f64 = 500.0;

/// A value below 0 that no scatter explains: by as much as this, by as many
/// times the scatter, and by this share of the greatest value.
const BELOW: (f64, f64, f64) = (5.0, 10.0, 0.25);

/// What a file gives, with the lines that it stands in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Values<'v> {
    pub(super) quantity: Quantity,
    pub(super) times: &'v [f64],
    pub(super) values: &'v [f64],
    pub(super) lines: &'v [u64],
}

/// A line, and what is wrong with it.
type Wrong = (u64, String);

/// Whether a number is a mark for "not measured".
pub(crate) fn is_mark(value: f64) -> bool {
    MARKS.contains(&value)
}

/// Whether a number is such a mark, or may be one or a measured value.
pub(crate) fn may_be_mark(value: f64) -> bool {
    is_mark(value) || UNSIGNED.contains(&value)
}

/// How far a smooth recording scatters about itself, from the median second
/// difference, which a few wild values leave as it is; 0 below five values.
pub(super) fn scatter(values: &[f64]) -> f64 {
    if values.len() < 5 {
        return 0.0;
    }
    let bends: Vec<f64> =
        values.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).abs()).collect();
    // The median of |x| is 0.6745 sd; the second difference has 6 variances.
    median(&bends) / (0.6745 * 6.0_f64.sqrt())
}

impl Values<'_> {
    /// Refuses what no mass on a slope does.
    pub(super) fn check(&self) -> Result<(), Wrong> {
        self.marks()?;
        self.clock()?;
        self.size()?;
        self.sign()?;
        self.motion()
    }

    fn at(&self, i: usize, expected: &str) -> Wrong {
        let (quantity, value) = (self.quantity, self.values[i]);
        let message = format!("{quantity} = {value}; expected {expected}");
        (self.lines[i], message)
    }

    fn marks(&self) -> Result<(), Wrong> {
        let others = self.values.iter().filter(|v| !may_be_mark(**v));
        let top = others.fold(0.0, |top: f64, v| top.max(v.abs()));
        let least = match self.quantity {
            // One place alone may be any.
            Quantity::Position if top == 0.0 => f64::INFINITY,
            Quantity::Position => ABOVE_OTHERS.0 * top,
            _ => ABOVE_OTHERS.1 * top,
        };
        let marks = |v: &f64| is_mark(*v) || (may_be_mark(*v) && *v > least);
        match self.values.iter().position(marks) {
            None => Ok(()),
            Some(i) => Err(self.at(
                i,
                &format!(
                    "a measured value [{}], and this is a mark for none: drop \
                     the rows where nothing was measured",
                    self.quantity.unit()
                ),
            )),
        }
    }

    /// Refuses standard errors beyond what any value can be.
    pub(super) fn check_errors(&self, errors: &[f64]) -> Result<(), Wrong> {
        let limit = match self.quantity {
            Quantity::Velocity => FASTEST,
            Quantity::Acceleration => HARDEST,
            Quantity::Position => FASTEST * LATEST,
        };
        let Some(i) = errors.iter().position(|e| *e > limit) else {
            return Ok(());
        };
        let (quantity, unit) = (self.quantity, self.quantity.unit());
        let message = format!(
            "sigma = {}; expected the standard error of this {quantity} \
             [{unit}], no more than {limit}: drop the column sigma where the \
             errors are not known, or the rows where nothing was measured",
            errors[i]
        );
        Err((self.lines[i], message))
    }

    fn clock(&self) -> Result<(), Wrong> {
        let last = self.times.len() - 1;
        let (begin, end) = (self.times[0], self.times[last]);
        if end <= LATEST {
            return Ok(());
        }
        let (i, mend) = if begin > LATEST && end - begin <= LATEST {
            let mend = format!(
                "are these seconds of the day, or of another clock? subtract \
                 the moment of the release from all (about {begin})"
            );
            (0, mend)
        } else if begin > LATEST {
            let mend = "are these milliseconds of another clock? subtract \
                        the moment of the release from all, and divide by \
                        1000";
            (0, mend.to_owned())
        } else {
            let mend = "are these milliseconds? divide all by 1000";
            (last, mend.to_owned())
        };
        Err((
            self.lines[i],
            format!(
                "t = {}; expected seconds after the release, no more than \
                 {LATEST}: {mend}",
                self.times[i]
            ),
        ))
    }

    fn size(&self) -> Result<(), Wrong> {
        let (limit, unit) = match self.quantity {
            Quantity::Velocity => (FASTEST, "m/s"),
            Quantity::Acceleration => (HARDEST, "m/s2"),
            Quantity::Position => return Ok(()),
        };
        let beyond = |v: &f64| v.abs() > limit;
        let Some(i) = self.values.iter().position(beyond) else {
            return self.sustained();
        };
        let top = self.values.iter().fold(0.0, |top: f64, v| top.max(v.abs()));
        let mend = if self.are_strays(limit) {
            "drop the rows that are no measurement"
        } else if self.quantity == Quantity::Acceleration {
            "are these in another unit? convert them"
        } else if top <= 3.6 * limit {
            "are these km/h? divide all by 3.6"
        } else if top <= 100.0 * limit {
            "are these cm/s? divide all by 100"
        } else {
            "are these mm/s? divide all by 1000"
        };
        Err(self.at(
            i,
            &format!("{unit}, and nothing has {limit} of them: {mend}"),
        ))
    }

    /// Whether what is beyond a limit is a few values that the others do not
    /// lead to.
    fn are_strays(&self, limit: f64) -> bool {
        let sizes: Vec<f64> = self.values.iter().map(|v| v.abs()).collect();
        let beyond = || sizes.iter().copied().filter(|v| *v > limit);
        let few = beyond().count();
        let least = beyond().fold(f64::INFINITY, f64::min);
        let others = sizes.iter().copied().filter(|v| *v <= limit);
        let top = others.fold(0.0, f64::max);
        50 * few < sizes.len()
            || (3 * few <= sizes.len() && least > STRAY * top)
    }

    /// Refuses accelerations that no mass keeps up.
    fn sustained(&self) -> Result<(), Wrong> {
        let sizes: Vec<f64> = self.values.iter().map(|v| v.abs()).collect();
        let is_hard = self.quantity == Quantity::Acceleration
            && median(&sizes) > SUSTAINED;
        let hard = sizes.iter().position(|v| *v > SUSTAINED);
        let Some(i) = hard.filter(|_| is_hard) else { return Ok(()) };
        Err(self.at(
            i,
            &format!(
                "m/s2, and half of the values are above {SUSTAINED}, which no \
                 mass keeps up: are these cm/s2? divide all by 100; or \
                 thousandths of g? multiply all by 0.00981"
            ),
        ))
    }

    fn sign(&self) -> Result<(), Wrong> {
        if self.quantity == Quantity::Acceleration {
            return Ok(());
        }
        let scatter = scatter(self.values);
        let top = self.values.iter().fold(0.0, |top: f64, v| top.max(*v));
        let wild = BELOW.0.max(BELOW.1 * scatter).max(BELOW.2 * top);
        let turned = median(self.values) < -(3.0 * scatter).max(0.5);
        let limit = if turned { 0.0 } else { -wild };
        let Some(i) = self.values.iter().position(|v| *v < limit) else {
            return Ok(());
        };
        let mend = match turned {
            true => "change the sign of all",
            false => "drop the rows that are no measurement",
        };
        let what = match self.quantity {
            Quantity::Velocity => "m/s down the track",
            _ => "metres down the track since the release",
        };
        let expected = format!(
            "{what}, 0 or more but for a scatter of {scatter:.2}: {mend}"
        );
        Err(self.at(i, &expected))
    }

    /// Refuses a mass that never moves: nothing above 0, or a scatter about
    /// it, or one place.
    fn motion(&self) -> Result<(), Wrong> {
        let n = self.values.len();
        let mean = self.values.iter().sum::<f64>() / n as f64;
        let squares = self.values.iter().map(|v| (v - mean).powi(2));
        let error = squares.sum::<f64>().sqrt() / n as f64;
        let below = self.values.iter().filter(|v| **v < 0.0).count();
        let is_still = self.values.iter().all(|v| *v <= 0.0)
            || (3 * below >= n && mean < 3.0 * error);
        let is_one_place = self.quantity == Quantity::Position
            && n > 1
            && self.values.iter().all(|v| *v == self.values[0]);
        let moves = match self.quantity {
            Quantity::Velocity => !is_still,
            Quantity::Position => !is_still && !is_one_place,
            Quantity::Acceleration => true,
        };
        if moves {
            return Ok(());
        }
        let mend = "a mass that moves, and by these values it never does: \
                    take the part of the recording where it slides, or \
                    another column";
        Err(self.at(0, mend))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(quantity: Quantity, rows: &[(f64, f64)]) -> Option<String> {
        let times: Vec<f64> = rows.iter().map(|r| r.0).collect();
        let values: Vec<f64> = rows.iter().map(|r| r.1).collect();
        let lines: Vec<u64> = (2..).take(rows.len()).collect();
        let (times, values, lines) = (&times, &values, &lines);
        let all = Values { quantity, times, values, lines };
        all.check().err().map(|(line, text)| format!("{line}: {text}"))
    }

    /// A rise and a fall of so many metres a second over so many rows.
    fn rows(top: f64, step: f64) -> Vec<(f64, f64)> {
        let at = |i: u32| (step * f64::from(i), f64::from(i));
        let bump = |(t, i): (f64, f64)| (t, top * (0.1 * i).sin());
        (1..=30).map(at).map(bump).collect()
    }

    #[test]
    fn what_a_sensor_shows_near_rest_is_no_fault() {
        let mut near = rows(20.0, 1.0);
        near[0].1 = -0.02;
        near[29].1 = -0.6;
        assert_eq!(said(Quantity::Velocity, &near), None);
        // Errors of 1 m/s about a slow start.
        let noisy = rows(10.0, 1.0).into_iter().enumerate();
        let noisy = noisy.map(|(i, (t, v))| match i % 3 {
            0 => (t, v - 2.5),
            1 => (t, v + 1.5),
            _ => (t, v),
        });
        let noisy: Vec<_> = noisy.collect();
        assert!(noisy.iter().any(|row| row.1 < -1.0));
        assert_eq!(said(Quantity::Velocity, &noisy), None);
    }

    #[test]
    fn a_number_like_a_mark_may_be_measured() {
        // 9.99 m/s in cm/s is no mark among its like, and 999 m a place.
        let cm = rows(2000.0, 1.0).into_iter().map(|(t, v)| (t, v - 1.0));
        let mut cm: Vec<_> = cm.collect();
        cm[4].1 = 999.0;
        let text = said(Quantity::Velocity, &cm).unwrap();
        assert!(text.contains("cm/s? divide all by 100"), "{text}");
        let way = [(1.0, 250.0), (2.0, 600.0), (3.0, 999.0)];
        assert_eq!(said(Quantity::Position, &way), None);
        assert_eq!(said(Quantity::Position, &[(9.0, 999.0)]), None);
    }

    #[test]
    fn the_likely_slip_is_named() {
        use Quantity::{Acceleration, Position, Velocity};
        let km_h = rows(240.0, 1.0);
        let turned: Vec<_> =
            rows(20.0, 1.0).iter().map(|r| (r.0, -r.1)).collect();
        let mut clock = rows(20.0, 1.0);
        clock.iter_mut().for_each(|row| row.0 += 43_200.0);
        let still: Vec<_> = (1..=9)
            .map(|i| (f64::from(i), 0.02 * f64::from(i % 3 - 1)))
            .collect();
        let one = [(1.0, 5.0), (2.0, 5.0)];
        let marked = |mark| [(1.0, 3.0), (2.0, 7.0), (3.0, mark), (4.0, 9.0)];
        let hard: Vec<_> = (1..=9).map(|i| (f64::from(i), 98.1)).collect();
        type Case<'c> = (Quantity, &'c [(f64, f64)], &'c str);
        let cases: [Case; 16] = [
            (Velocity, &marked(999.0), "4: velocity = 999; expected a measu"),
            (Velocity, &marked(9999.0), "this is a mark for none: drop the"),
            (Velocity, &marked(99999.0), "this is a mark for none: drop the"),
            (Position, &marked(999.0), "4: position = 999; expected a measu"),
            (Velocity, &marked(400.0), "drop the rows that are no measure"),
            (Acceleration, &hard, "2: acceleration = 98.1"),
            (Velocity, &km_h[..], "km/h? divide all by 3.6"),
            (Velocity, &rows(9000.0, 1.0), "cm/s? divide all by 100"),
            (Velocity, &rows(20.0, 200.0), "milliseconds? divide all by 1000"),
            (Velocity, &clock, "2: t = 43201; expected seconds"),
            (Velocity, &turned, "2: velocity = -1.99"),
            (Velocity, &turned, "change the sign of all"),
            (Velocity, &still, "it never does"),
            (Position, &one, "it never does"),
            (Velocity, &[(1.0, 3.0), (2.0, -9999.0)], "3: velocity = -9999"),
            (Position, &[(1.0, 3.0), (2.0, -30.0)], "3: position = -30"),
        ];
        for (quantity, rows, part) in cases {
            let text = said(quantity, rows).unwrap_or_default();
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}
