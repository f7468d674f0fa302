//! Recordings with fewer values a second.
//!
//! A recording that is denser than its errors forget tells little more than a
//! thinner one, and costs more. The mean of values in a bin is a mean of the
//! motion over a window, and is kept as one.

use std::fmt;

use super::event::Event;
use super::series::{Quantity, Series};
use crate::error::{Error, Result};
use crate::noise::Spacing;

/// How values are thinned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Thinning {
    /// The mean of the values in each of equal bins.
    #[default]
    Average,
    /// The last value in each of equal bins.
    Pick,
}

impl Thinning {
    /// What each is called.
    pub const NAMES: [&str; 2] = ["average", "pick"];

    /// The one of a name.
    ///
    /// ```
    /// use couloir::observe::Thinning;
    /// assert_eq!(Thinning::named("pick"), Some(Thinning::Pick));
    /// assert_eq!(Thinning::named("choose"), None);
    /// ```
    pub fn named(name: &str) -> Option<Self> {
        let all = [Self::Average, Self::Pick];
        Self::NAMES.iter().position(|n| *n == name).map(|i| all[i])
    }
}

/// What thinning did to a recording; as text one sentence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thinned {
    quantity: Quantity,
    /// How it was asked for, and how many values a second.
    asked: Thinning,
    rate: f64,
    /// How many values a second there were.
    own: f64,
    /// How many values a bin has, and the fewest where times are uneven.
    bin: usize,
    fewest: usize,
    /// How many values there were and are.
    from: usize,
    to: usize,
    /// Over how many seconds a value is now a mean \[s\].
    window: f64,
}

impl Thinned {
    /// Whether there are fewer values than there were.
    #[must_use]
    pub fn is_less(&self) -> bool {
        self.to < self.from
    }
}

impl fmt::Display for Thinned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { quantity, bin, fewest, from, to, window, .. } = self;
        let (own, rate) = (tidy(self.own), tidy(self.rate));
        if *bin == 1 {
            return write!(
                f,
                "The {quantity} recording is left as it is: it has {own} \
                 values a second, and bins of two or more would not come \
                 nearer to {rate}."
            );
        }
        write!(
            f,
            "The {quantity} recording is thinned from {from} values, {own} a \
             second, to {to}: "
        )?;
        match (how(*quantity, self.asked), self.asked) {
            (Thinning::Average, _) => write!(
                f,
                "each is the mean of {}{bin}, taken as the mean of the motion \
                 over {} s; parameters of the noise are those of the means.",
                if fewest < bin {
                    format!("{fewest} to ")
                } else {
                    String::new()
                },
                tidy(*window)
            ),
            (_, Thinning::Pick) => write!(f, "of each {bin} the last."),
            _ => write!(
                f,
                "of each {bin} the last, since a mean of positions is none \
                 of the motion."
            ),
        }
    }
}

/// A number with three digits, without zeros at its end.
fn tidy(x: f64) -> String {
    let places = (2.0 - x.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{x:.places$}");
    if !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// How a quantity is thinned where that was asked for.
fn how(quantity: Quantity, asked: Thinning) -> Thinning {
    match quantity {
        // The mean of positions over a window has no place in a model.
        Quantity::Position => Thinning::Pick,
        _ => asked,
    }
}

impl Event {
    /// The same event with about so many values a second in each of its
    /// recordings, and what was done to each. A recording that is no denser
    /// stays as it is.
    ///
    /// ```
    /// use couloir::observe::Thinning;
    /// use couloir::{Event, Series, physics::Track};
    /// let times = (1..=8).map(|i| 0.25 * f64::from(i)).collect();
    /// let speeds = (1..=8).map(f64::from).collect();
    /// let event = Event::on(Track::incline(35.0, 500.0)?)
    ///     .velocity(Series::velocity(times, speeds)?)
    ///     .build()?;
    /// let (thin, said) = event.thinned(1.0, Thinning::Average)?;
    /// assert_eq!(thin.velocity.values(), [2.5, 6.5]);
    /// assert!(said[0].is_less());
    /// assert!(said[0].to_string().contains("from 8 values"));
    /// # Ok::<(), couloir::Error>(())
    /// ```
    ///
    /// # Errors
    /// A rate that is not more than 0, or no bin without missing values.
    pub fn thinned(
        &self,
        rate: f64,
        asked: Thinning,
    ) -> Result<(Self, Vec<Thinned>)> {
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(Error::input(format!(
                "the rate is {rate}; expected values a second, more than 0"
            )));
        }
        let (mut event, mut done) = (self.clone(), Vec::new());
        for series in self.recordings() {
            let own = series.rate();
            let bin = (own / rate).round().clamp(1.0, 1e9) as usize;
            let thin = series.in_bins(bin, asked)?;
            let (quantity, window) = (series.quantity(), thin.window());
            let (from, to) = (series.len(), thin.len());
            let fewest = series.fewest(bin, asked);
            let said = Thinned {
                quantity,
                asked,
                rate,
                own,
                bin,
                fewest,
                from,
                to,
                window,
            };
            event = event.with_recording(thin)?;
            done.push(said);
        }
        Ok((event, done))
    }
}

impl Series {
    /// How many values it has a second, where none is missing.
    pub fn rate(&self) -> f64 {
        self.grid().step().recip()
    }

    /// The fewest values in any bin of so many steps.
    fn fewest(&self, bin: usize, asked: Thinning) -> usize {
        let bins = self.bins(bin, how(self.quantity(), asked)).into_iter();
        bins.map(|[from, to]| to - from).min().unwrap_or(bin)
    }

    /// The series in bins of so many steps; itself in bins of one.
    fn in_bins(&self, bin: usize, asked: Thinning) -> Result<Self> {
        if bin == 1 {
            return Ok(self.clone());
        }
        let bins = self.bins(bin, how(self.quantity(), asked));
        if bins.is_empty() {
            return Err(Error::input(format!(
                "the {} recording of {} values has no {bin} after one another \
                 without one missing; ask for a higher rate",
                self.quantity(),
                self.len()
            )));
        }
        match how(self.quantity(), asked) {
            Thinning::Average => self.averaged(bin, &bins),
            Thinning::Pick => self.picked(&bins),
        }
    }

    /// The values in each bin, as ranges of their numbers. A value at the
    /// release only says how the mass starts, and is in none. On a grid a mean
    /// needs a full bin, since that of others would be of another moment and
    /// of other errors, and a value is picked where it is on the coarser grid.
    /// Of uneven times half a bin is enough for a mean, and any value to pick.
    fn bins(&self, bin: usize, how: Thinning) -> Vec<[usize; 2]> {
        let (times, step) = (self.times(), self.grid().step());
        let first = usize::from(times[0] == 0.0 && times.len() > 1);
        let uneven = *self.grid().spacing() == Spacing::Uneven;
        let slot = |t: f64| ((t - times[first]) / step).round() as usize;
        let counts = |[from, to]: [usize; 2]| match (how, uneven) {
            (Thinning::Average, false) => to - from == bin,
            (Thinning::Average, true) => 2 * (to - from) >= bin,
            (Thinning::Pick, false) => slot(times[to - 1]) % bin == bin - 1,
            (Thinning::Pick, true) => true,
        };
        let (mut bins, mut from) = (Vec::new(), first);
        while from < times.len() {
            let own = slot(times[from]) / bin;
            let inside = |t: &&f64| slot(**t) / bin == own;
            let to = from + times[from..].iter().take_while(inside).count();
            if counts([from, to]) {
                bins.push([from, to]);
            }
            from = to;
        }
        bins
    }

    /// The means of bins. Each is the motion's mean over a window which has
    /// the centre and the spread of what went into it: values that are means
    /// over w themselves and m steps d make w^2 + d^2 (m^2 - 1), whose root
    /// is m d where their windows touch.
    fn averaged(&self, bin: usize, bins: &[[usize; 2]]) -> Result<Self> {
        let (own, step) = (self.window(), self.grid().step());
        let count = bin as f64;
        let steps = step * step * (count * count - 1.0);
        let window = (own * own + steps).sqrt();
        // Before the release a window is cut.
        let centre = |t: &f64| t - 0.5 * own.min(*t);
        let of = |values: &[f64], [from, to]: &[usize; 2]| {
            values[*from..*to].iter().sum::<f64>() / (to - from) as f64
        };
        let centres: Vec<f64> = self.times().iter().map(centre).collect();
        let end = |bin| {
            let centre = of(&centres, bin);
            centre + centre.min(0.5 * window)
        };
        let times = bins.iter().map(end).collect();
        let values = bins.iter().map(|bin| of(self.values(), bin)).collect();
        let series = Self::new(self.quantity(), times, values)?;
        let series = match self.grid().standard_errors() {
            None => series,
            Some(errors) => {
                let of_mean = |[from, to]: &[usize; 2]| {
                    let all = errors[*from..*to].iter().map(|s| s * s);
                    all.sum::<f64>().sqrt() / (to - from) as f64
                };
                let errors = bins.iter().map(of_mean).collect();
                series.with_standard_errors(errors)?
            }
        };
        series.with_window(window)
    }

    /// The last value of each bin.
    fn picked(&self, bins: &[[usize; 2]]) -> Result<Self> {
        let of =
            |all: &[f64]| bins.iter().map(|bin| all[bin[1] - 1]).collect();
        let (times, values) = (of(self.times()), of(self.values()));
        let series = Self::new(self.quantity(), times, values)?;
        let series = match self.grid().standard_errors() {
            None => series,
            Some(errors) => series.with_standard_errors(of(errors))?,
        };
        series.with_window(self.window())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(times: &[f64]) -> Series {
        let values = times.iter().map(|t| 2.0 * t).collect();
        Series::velocity(times.to_vec(), values).unwrap()
    }

    fn tenths(numbers: impl Iterator<Item = u32>) -> Vec<f64> {
        numbers.map(|i| f64::from(i) / 10.0).collect()
    }

    fn near(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        let pairs = found.iter().zip(expected);
        assert!(
            pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9),
            "{found:?} {expected:?}"
        );
    }

    /// Of speeds that grow steadily each mean is the speed in the middle of
    /// its window.
    #[test]
    fn a_mean_belongs_to_the_middle_of_its_window() {
        for (own, count) in [(0.0, 5), (0.1, 5), (0.07, 4), (0.0, 2)] {
            let all = series(&tenths(1..=41)).with_window(own).unwrap();
            let values = all.times().iter().map(|t| t - 0.5 * own).collect();
            let all = all.with_values(values).unwrap();
            let thin = all.in_bins(count, Thinning::Average).unwrap();
            assert_eq!(thin.len(), 41 / count);
            let middles: Vec<f64> = thin
                .times()
                .iter()
                .map(|t| t - 0.5 * thin.window().min(*t))
                .collect();
            near(thin.values(), &middles);
        }
        // Windows that touch make one that is as long as all.
        let all = series(&tenths(1..=40)).with_window(0.1).unwrap();
        let thin = all.in_bins(5, Thinning::Average).unwrap();
        assert!((thin.window() - 0.5).abs() < 1e-9);
        near(thin.times(), &tenths((5..=40).step_by(5)));
    }

    #[test]
    fn standard_errors_are_those_of_means() {
        let all = series(&tenths(1..=4));
        let all = all.with_standard_errors(vec![0.3, 0.4, 1.0, 1.0]).unwrap();
        let means = all.in_bins(2, Thinning::Average).unwrap();
        near(means.grid().standard_errors().unwrap(), &[0.25, 0.5f64.sqrt()]);
        let last = all.in_bins(2, Thinning::Pick).unwrap();
        near(last.grid().standard_errors().unwrap(), &[0.4, 1.0]);
    }

    /// The value at the release is in no bin, nor are values of a bin in
    /// which one is missing; picking takes what is there.
    #[test]
    fn bins_are_full() {
        let all = series(&tenths((0..=12).filter(|i| *i != 6)));
        let means = all.in_bins(4, Thinning::Average).unwrap();
        near(means.values(), &[2.0 * 0.25, 2.0 * 1.05]);
        assert!(all.in_bins(9, Thinning::Average).is_err());
        let last = all.in_bins(3, Thinning::Pick).unwrap();
        near(last.times(), &[0.3, 0.9, 1.2]);
        let uneven = series(&[0.1, 0.23, 0.3, 0.41, 0.52, 0.57, 0.71, 0.8]);
        assert_eq!(*uneven.grid().spacing(), Spacing::Uneven);
        let thin = uneven.in_bins(4, Thinning::Average).unwrap();
        assert_eq!(thin.len(), 2);
    }

    #[test]
    fn a_coarse_recording_stays_as_it_is() {
        let track = crate::physics::Track::incline(30.0, 900.0).unwrap();
        let all = series(&tenths(1..=40));
        let event = Event::on(track).velocity(all).build().unwrap();
        let (same, said) = event.thinned(20.0, Thinning::Average).unwrap();
        assert_eq!(same, event);
        assert!(
            said[0].to_string().contains("left as it is: it has 10 values")
        );
        let (_, said) = event.thinned(3.4, Thinning::Pick).unwrap();
        let text = said[0].to_string();
        assert!(text.contains("from 40 values, 10 a second, to 13"), "{text}");
        assert!(event.thinned(0.0, Thinning::Pick).is_err());
    }

    #[test]
    fn positions_are_picked() {
        let times = tenths(1..=6);
        let all = Series::position(times.clone(), times).unwrap();
        let thin = all.in_bins(3, Thinning::Average).unwrap();
        near(thin.times(), &[0.3, 0.6]);
        near(thin.values(), &[0.3, 0.6]);
        assert_eq!(thin.window(), 0.0);
    }
}
