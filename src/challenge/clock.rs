//! When a recording has its values.

use rand::RngExt;

use super::scatter::Errors;
use crate::seed::Rng;

/// How long and how dense recordings are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rates {
    /// Fewest and most values.
    pub(super) values: (usize, usize),
    /// Least and greatest time between values \[s/100\].
    pub(super) centiseconds: (u32, u32),
}

impl Rates {
    /// 10 to 4 values a second; or 10, as real sensors give them, and enough
    /// for what errors remember to show.
    pub(super) fn of(errors: Errors) -> Self {
        match errors {
            Errors::Simple => {
                Self { values: (60, 200), centiseconds: (10, 25) }
            }
            Errors::Real => {
                Self { values: (150, 220), centiseconds: (10, 10) }
            }
        }
    }
}

/// When a recording has its values: `count` of them, `step` apart.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    step: f64,
    count: usize,
    rates: Rates,
}

impl Clock {
    pub(super) fn draw(rates: Rates, rng: &mut Rng) -> Self {
        let (low, high) = rates.centiseconds;
        let step = f64::from(rng.random_range(low..=high)) / 100.0;
        let (fewest, most) = rates.values;
        Self { step, count: rng.random_range(fewest..=most), rates }
    }

    /// The times \[s\].
    pub(super) fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let Self { step, count, .. } = *self;
        // In hundredths, as the file has them.
        let at = move |i| (i as f64 * step * 100.0).round() / 100.0;
        (1..=count).map(at)
    }

    pub(super) fn duration(&self) -> f64 {
        self.step * self.count as f64
    }

    /// The same within so many seconds: fewer values, then denser ones;
    /// nothing where that is not enough.
    pub(super) fn within(self, seconds: f64) -> Option<Self> {
        let (fewest, most) = self.rates.values;
        let fits = |step: f64| (seconds / step + 1e-9).floor() as usize;
        let count = self.count.min(fits(self.step));
        if count >= fewest {
            return Some(Self { count, ..self });
        }
        let densest = f64::from(self.rates.centiseconds.0);
        let step = (100.0 * seconds / fewest as f64).floor();
        (step >= densest).then(|| {
            let step = step / 100.0;
            Self { step, count: fits(step).min(most), ..self }
        })
    }
}
