//! Arrays with the dimensions chain, draw and time, of what a model says of
//! the data at each draw.

use super::data::{Group, Values, Variable};
use super::heard::Heard;
use super::recorded::Recorded;
use crate::draws::Draws;
use crate::error::Result;

/// Which draws of each chain a group has.
pub(super) struct Places {
    pub(super) chains: usize,
    pub(super) draws: Vec<i64>,
}

impl Places {
    pub(super) fn every(draws: &Draws, step: usize) -> Self {
        let draw = (0..draws.iterations() as i64).step_by(step);
        Self { chains: draws.chains(), draws: draw.collect() }
    }

    pub(super) fn shape(&self) -> [usize; 2] {
        [self.chains, self.draws.len()]
    }

    pub(super) fn coordinates(&self) -> Result<[Variable; 2]> {
        let draws = Values::Whole(self.draws.clone());
        let shape = [("draw", self.draws.len())];
        Ok([
            Variable::counted("chain", self.chains)?,
            Variable::new("draw", "1", &shape, draws)?,
        ])
    }
}

/// The data at the draws of a group.
pub(super) struct Table<'a> {
    pub(super) recorded: &'a [Recorded],
    pub(super) places: &'a Places,
}

impl Table<'_> {
    /// A variable for each of the data, of what each draw says of them.
    fn group(
        &self,
        name: &'static str,
        about: &str,
        unit: Option<&str>,
        rows: &[&[f64]],
    ) -> Result<Group> {
        let [chains, draws] = self.places.shape();
        let mut all = Vec::new();
        let mut from = 0;
        for one in self.recorded {
            let part = from..from + one.len();
            from = part.end;
            let values = rows.iter().flat_map(|row| &row[part.clone()]);
            let values = Values::Real(values.copied().collect());
            let shape = [
                ("chain", chains),
                ("draw", draws),
                (one.dimension.as_str(), one.len()),
            ];
            let unit = unit.unwrap_or(&one.unit);
            let made = Variable::new(&one.name, unit, &shape, values)?;
            all.extend([made.about(about), one.coordinate()?]);
        }
        all.extend(self.places.coordinates()?);
        Ok(Group::new(name, all))
    }

    pub(super) fn log_likelihood(
        &self,
        heard: &[Option<Heard>],
        values: usize,
    ) -> Result<Group> {
        let never = vec![f64::NEG_INFINITY; values];
        let rows = log_likelihoods(heard, &never);
        let about = "ln of the density given the values before";
        self.group("log_likelihood", about, Some("1"), &rows)
    }

    pub(super) fn predictive(
        &self,
        name: &'static str,
        heard: &[Option<Heard>],
        values: usize,
    ) -> Result<Group> {
        let none = vec![f64::NAN; values];
        let rows = at_draws(heard, &none, |heard| &heard.replicate);
        let about = "what might have been recorded: flow and errors";
        self.group(name, about, None, &rows)
    }
}

/// The log likelihood of each datum at each draw.
pub(super) fn log_likelihoods<'a>(
    heard: &'a [Option<Heard>],
    never: &'a [f64],
) -> Vec<&'a [f64]> {
    at_draws(heard, never, |heard| &heard.log_likelihood)
}

/// A row for each draw; `rejected` where the model rejects it.
fn at_draws<'a>(
    heard: &'a [Option<Heard>],
    rejected: &'a [f64],
    row: fn(&Heard) -> &Vec<f64>,
) -> Vec<&'a [f64]> {
    let one = |heard: &'a Option<Heard>| -> &'a [f64] {
        heard.as_ref().map_or(rejected, |heard| row(heard))
    };
    heard.iter().map(one).collect()
}
