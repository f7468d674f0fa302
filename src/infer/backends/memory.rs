//! How well particles remember where they were before their moves.
//!
//! Moves that reach everywhere leave no trace of where a particle was, and
//! the population is then right whatever the weights were. Where steps of one
//! length do not fit (the neck of a funnel), the particles in it stay: what
//! lies at the ends of a parameter holds the same particles as before. This
//! is the adaptation of Kantas, Beskos and Jasra (2014), "Sequential Monte
//! Carlo methods for high-dimensional inverse problems", who move until a
//! correlation with the start is small, with tails in the place of means:
//! the bulk forgets fast, and the mean did not tell of the neck.

/// The places of particles on the line before their moves.
#[derive(Debug)]
pub(in crate::infer) struct Memory {
    /// By parameter.
    before: Vec<Vec<f64>>,
}

/// The share of particles that is an end.
const END: f64 = 0.05;

impl Memory {
    pub(in crate::infer) fn of<'a>(
        places: impl Iterator<Item = &'a [f64]>,
    ) -> Self {
        Self { before: by_parameter(places) }
    }

    /// The parameter that is remembered best, and how well: the correlation
    /// of lying at one end now and before, 0 by chance, 1 without a move.
    pub(in crate::infer) fn left<'a>(
        &self,
        now: impl Iterator<Item = &'a [f64]>,
    ) -> (usize, f64) {
        let pairs = self.before.iter().zip(by_parameter(now));
        pairs
            .map(|(before, now)| kept(before, &now))
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, 0.0))
    }
}

fn by_parameter<'a>(places: impl Iterator<Item = &'a [f64]>) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for place in places {
        columns.resize(place.len(), Vec::new());
        for (column, z) in columns.iter_mut().zip(place) {
            column.push(*z);
        }
    }
    columns
}

/// The same of one parameter, at the end that is remembered better.
fn kept(before: &[f64], now: &[f64]) -> f64 {
    let (low, high) = ends(before);
    let (low_now, high_now) = ends(now);
    let (mut below, mut above) = (0, 0);
    for (then, now) in before.iter().zip(now) {
        below += usize::from(*then < low && *now < low_now);
        above += usize::from(*then > high && *now > high_now);
    }
    let share = below.max(above) as f64 / before.len() as f64;
    (share - END * END) / (END - END * END)
}

/// Below and above which the ends lie.
fn ends(values: &[f64]) -> (f64, f64) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let cut = (END * values.len() as f64) as usize;
    (sorted[cut], sorted[values.len() - 1 - cut])
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::seed::Seed;

    #[test]
    fn what_stays_is_remembered_and_what_goes_is_not() {
        let mut rng = Seed::new(1).rng();
        let mut drawn = || -> Vec<[f64; 2]> {
            (0..4000).map(|_| [rng.random(), rng.random()]).collect()
        };
        let (before, other) = (drawn(), drawn());
        let memory = Memory::of(before.iter().map(|z| &z[..]));
        let (_, same) = memory.left(before.iter().map(|z| &z[..]));
        assert!((same - 1.0).abs() < 1e-9, "{same}");
        // 10 particles by chance, give or take 3: 4 times of that over 190.
        let (_, gone) = memory.left(other.iter().map(|z| &z[..]));
        assert!(gone.abs() < 0.07, "{gone}");
        let half = before.iter().zip(&other).map(|(b, o)| [o[0], b[1]]);
        let half: Vec<[f64; 2]> = half.collect();
        let (which, much) = memory.left(half.iter().map(|z| &z[..]));
        assert!(which == 1 && much > 0.99, "{which} {much}");
    }
}
