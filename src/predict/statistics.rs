//! Figures of a recording beside those of its replicates: a posterior
//! predictive check (Gelman et al. 2013, Bayesian Data Analysis, 6.3).

use crate::draws::quantile;

/// One figure of a recording, and of recordings that the model might have
/// led to instead.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Statistic {
    /// What it is of the recording: `largest value`.
    pub name: &'static str,
    /// Its unit.
    pub unit: String,
    /// That of the recording.
    pub recorded: f64,
    /// Those of the replicates, in ascending order.
    pub replicated: Vec<f64>,
}

/// Times \[s\] and values, and what a figure of them is.
type Figure = fn(&[f64], &[f64]) -> f64;

/// The figures, with their names; `None` for the unit of the values.
const FIGURES: [(&str, Option<&str>, Figure); 5] = [
    ("largest value", None, |_, values| values[largest(values)]),
    ("time of the largest value", Some("s"), |t, values| t[largest(values)]),
    ("mean", None, |_, values| mean(values.iter().copied())),
    ("last value", None, |_, values| values[values.len() - 1]),
    ("step between neighbours", None, |_, values| {
        let steps = values.windows(2).map(|w| (w[1] - w[0]).powi(2));
        mean(steps).sqrt()
    }),
];

fn largest(values: &[f64]) -> usize {
    let all = values.iter().enumerate();
    all.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(i, _)| i)
}

fn mean(numbers: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = numbers.len() as f64;
    numbers.sum::<f64>() / count
}

/// The figures of a recording and of its replicates, which have as many
/// values; none of a recording of fewer than two.
pub(super) fn statistics<'a>(
    times: &[f64],
    values: &[f64],
    unit: &str,
    replicates: &(impl Iterator<Item = &'a [f64]> + Clone),
) -> Vec<Statistic> {
    if values.len() < 2 {
        return Vec::new();
    }
    let of = |(name, own, figure): (&'static str, Option<&str>, Figure)| {
        let all = replicates.clone().map(|made| figure(times, made));
        let mut replicated: Vec<f64> = all.collect();
        replicated.sort_by(f64::total_cmp);
        let unit = own.unwrap_or(unit).to_owned();
        Statistic { name, unit, recorded: figure(times, values), replicated }
    };
    FIGURES.into_iter().map(of).collect()
}

impl Statistic {
    /// The share of the replicates that are larger, equal ones counted half:
    /// near 0 or 1 where the model does not lead to such recordings.
    pub fn p(&self) -> f64 {
        let count = self.replicated.len() as f64;
        let below = |bound: &dyn Fn(f64) -> bool| {
            self.replicated.partition_point(|x| bound(*x)) as f64
        };
        let less = below(&|x| x < self.recorded);
        let not_more = below(&|x| x <= self.recorded);
        1.0 - 0.5 * (less + not_more) / count
    }

    /// A quantile of the replicates.
    pub fn quantile(&self, p: f64) -> f64 {
        quantile(&self.replicated, p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_the_values() {
        let times = [1.0, 2.0, 4.0];
        let found = statistics(
            &times,
            &[1.0, 5.0, 3.0],
            "m/s",
            &[[1.0, 2.0, 6.0].as_slice(), &[9.0, 5.0, 1.0]].into_iter(),
        );
        let told: Vec<_> =
            found.iter().map(|s| (s.recorded, &s.replicated[..])).collect();
        let step = |a: f64, b: f64| ((a * a + b * b) / 2.0).sqrt();
        let expected = [
            (5.0, [6.0, 9.0].as_slice()),
            (2.0, &[1.0, 4.0]),
            (3.0, &[3.0, 5.0]),
            (3.0, &[1.0, 6.0]),
            (step(4.0, -2.0), &[step(1.0, 4.0), step(-4.0, -4.0)]),
        ];
        assert_eq!(told, expected);
        assert_eq!(found[1].unit, "s");
        let p: Vec<f64> = found.iter().map(Statistic::p).collect();
        assert_eq!(p, [1.0, 0.5, 0.75, 0.5, 0.5]);
        let none = statistics(&[1.0], &[1.0], "m", &[].into_iter());
        assert!(none.is_empty());
    }
}
