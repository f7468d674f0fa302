//! Where the model's own parameters begin when a mechanism is looked for.

use statrs::statistics::Statistics;

use super::fit::Fit;
use crate::diagnosis::locate::FreeForce;
use crate::error::Result;
use crate::model::{AnyProgram, Posterior, With};

/// Where the model's own parameters begin.
#[derive(Debug)]
pub(super) struct Owns {
    /// At their best with nothing added, where errors may explain what is
    /// missing, and at their best with a force of free form, where it does.
    pub(super) best: Vec<Vec<f64>>,
    /// In the middle of what they are with the force along each axis: between
    /// its peaks, where a mechanism that is like the force at neither has its
    /// own.
    pub(super) between: Vec<Vec<f64>>,
    /// In the tails of each, with nothing added: the memory of the errors,
    /// above all, decides which stretches they hide.
    pub(super) tails: Vec<Vec<f64>>,
    /// Where mechanisms of few unknowns have them.
    pub(super) met: Vec<Vec<f64>>,
    /// The standard deviation of each coordinate, with nothing added.
    widths: Vec<f64>,
}

/// How many places of the own parameters that mechanisms of few unknowns have
/// are begun from, and from how many widths on these are places of their own.
const MET: usize = 4;
const ELSEWHERE: f64 = 2.0;

impl Owns {
    /// Of a model as it is, and of forces of free form.
    ///
    /// # Errors
    /// A model that fails.
    pub(super) fn of(
        program: &dyn AnyProgram,
        none: &Fit,
        forces: &[FreeForce],
    ) -> Result<Self> {
        let with = With::new(program, &[]);
        let posterior = Posterior::new(&with)?;
        let likely = forces
            .iter()
            .max_by(|a, b| a.log_bayes_factor.total_cmp(&b.log_bayes_factor));
        let open = likely.and_then(FreeForce::likeliest_own);
        let rows = none.draws.thinned(DRAWN).into_iter();
        let drawn: Vec<Vec<f64>> =
            rows.map(|row| posterior.line(row)).collect::<Result<_>>()?;
        let best = [none.own()].into_iter().chain(open);
        let best = best.map(<[f64]>::to_vec).collect();
        let between = forces.iter().map(FreeForce::middle_of_own).collect();
        let (met, widths) = (Vec::new(), widths(&drawn));
        Ok(Self { best, between, tails: tails(drawn), met, widths })
    }

    /// Takes in where mechanisms have them, each with ln of what it holds: the
    /// likeliest first, as far as these are places of their own.
    pub(super) fn meet<'p>(
        &mut self,
        places: impl Iterator<Item = (f64, &'p [f64])>,
    ) {
        let mut places: Vec<(f64, &[f64])> = places.collect();
        places.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, own) in places {
            if self.met.len() < MET && self.is_elsewhere(own) {
                self.met.push(own.to_vec());
            }
        }
    }

    /// Whether no place that is begun from is near.
    fn is_elsewhere(&self, own: &[f64]) -> bool {
        let is_far = |known: &Vec<f64>| {
            let off = own.iter().zip(known).zip(&self.widths);
            off.into_iter()
                .any(|((a, b), width)| (a - b).abs() > ELSEWHERE * width)
        };
        self.best.iter().chain(&self.met).all(is_far)
    }
}

/// Of how many draws of the model as it is those in the tails are taken.
const DRAWN: usize = 400;

/// The standard deviation of each coordinate.
fn widths(drawn: &[Vec<f64>]) -> Vec<f64> {
    let count = drawn.first().map_or(0, Vec::len);
    let of = |i: usize| drawn.iter().map(|line| line[i]).collect::<Vec<_>>();
    (0..count).map(|i| of(i).std_dev()).collect()
}

/// The draws near the ends of each coordinate's middle 95 %.
fn tails(mut drawn: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let coordinates = drawn.first().map_or(0, Vec::len);
    let low = drawn.len() / 40;
    let high = drawn.len().saturating_sub(1 + low);
    (0..coordinates)
        .flat_map(|i| {
            drawn.sort_by(|a, b| a[i].total_cmp(&b[i]));
            [drawn[low].clone(), drawn[high].clone()]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_their_own_are_taken_in_the_likeliest_first() {
        let mut owns = Owns {
            best: vec![vec![0.0, 0.0]],
            between: Vec::new(),
            tails: Vec::new(),
            met: Vec::new(),
            widths: vec![1.0, 0.1],
        };
        // Near the best, far in the narrow coordinate, next to that, and five
        // more apart from all.
        let places = [[1.9, 0.1], [0.0, 0.5], [0.5, 0.6]];
        let far = (1..=5).map(|i| [10.0 * f64::from(i), 0.0]);
        let places: Vec<[f64; 2]> = places.into_iter().chain(far).collect();
        let logs = [9.0, 5.0, 6.0, 1.0, 2.0, 3.0, 4.0, 0.0];
        owns.meet(logs.into_iter().zip(places.iter().map(|p| &p[..])));
        let likeliest = [[0.5, 0.6], [40.0, 0.0], [30.0, 0.0], [20.0, 0.0]];
        assert_eq!(owns.met, likeliest.map(|p| p.to_vec()));
    }

    #[test]
    fn tails_are_draws_and_widths_standard_deviations() {
        let drawn: Vec<Vec<f64>> = (0..=400)
            .map(|i| vec![f64::from(i), -2.0 * f64::from(i)])
            .collect();
        // Of 0 to n the standard deviation is sqrt((n + 1)(n + 2)/12).
        let sd = (401.0 * 402.0 / 12.0_f64).sqrt();
        let found = widths(&drawn);
        assert!((found[0] - sd).abs() < 1e-9 * sd);
        assert!((found[1] - 2.0 * sd).abs() < 1e-9 * sd);
        let [low, high] = [vec![10.0, -20.0], vec![390.0, -780.0]];
        assert_eq!(tails(drawn), [low.clone(), high.clone(), high, low]);
    }
}
