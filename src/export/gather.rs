//! From a posterior and its draws to the groups of an InferenceData.

use super::data::{Group, InferenceData, LeftOut, Values, Variable};
use super::heard::{Heard, Origin, hear};
use super::recorded::{Data, Recorded};
use super::table::{Places, Table, log_likelihoods};
use super::vector::{Named, variables};
use crate::draws::{Draws, loo_of_chains, relative_efficiency};
use crate::error::{Error, Result};
use crate::model::{Point, Posterior};
use crate::parallel;
use crate::seed::Seed;

/// The most numbers that a group has for each draw and datum: 80 MB.
pub const MOST_NUMBERS: usize = 10_000_000;

/// How many draws of the prior are made.
pub const PRIOR_DRAWS: usize = 1000;

/// What is gathered.
///
/// ```
/// use couloir::export::Scope;
/// let scope = Scope::default().of_events(vec!["A".into(), "B".into()]);
/// assert_eq!(scope.events.len(), 2);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Scope {
    /// What the parameters of each of several events begin with.
    pub events: Vec<String>,
    /// The most numbers for each draw and datum.
    pub most_numbers: usize,
    /// How many draws of the prior.
    pub prior_draws: usize,
}

impl Default for Scope {
    fn default() -> Self {
        Self {
            events: Vec::new(),
            most_numbers: MOST_NUMBERS,
            prior_draws: PRIOR_DRAWS,
        }
    }
}

impl Scope {
    /// The same for several events, whose parameters begin with these labels.
    #[must_use]
    pub fn of_events(self, events: Vec<String>) -> Self {
        Self { events, ..self }
    }
}

/// The posterior draws alone, as the group `posterior`.
///
/// # Errors
/// Where there is no draw, or a parameter is called as a dimension is.
pub fn of_draws(draws: &Draws, events: &[String]) -> Result<InferenceData> {
    if draws.total() == 0 {
        return Err(Error::inference("there is no draw to be written"));
    }
    let taken = |name: &&String| ["chain", "draw"].contains(&name.as_str());
    if let Some(name) = draws.names().iter().find(taken) {
        return Err(Error::input(format!(
            "a parameter is called {name}, as is a dimension of its draws; \
             expected another name: rename it, or write csv"
        )));
    }
    let rows: Vec<&[f64]> = draws.rows().collect();
    let places = Places::every(draws, 1);
    let named = Named { names: draws.names(), units: draws.units(), events };
    let mut all = variables(&named, places.shape(), &rows)?;
    all.extend(places.coordinates()?);
    let groups = vec![Group::new("posterior", all)];
    let data = InferenceData { groups, ..InferenceData::default() };
    let library = ["couloir", env!("CARGO_PKG_VERSION")];
    Ok(data
        .with("inference_library", library[0])
        .with("inference_library_version", library[1])
        .with("sampling", sampling(draws)))
}

/// Whether draws are of chains, in words.
fn sampling(draws: &Draws) -> &'static str {
    match draws.chains() {
        1 if draws.acceptance()[0].is_nan() => {
            "even draws in one chain, their order without a meaning"
        }
        _ => "draws of Markov chains",
    }
}

/// Everything that a posterior and its draws say: the draws (`posterior`), how
/// likely each makes each datum given those before it (`log_likelihood`), what
/// might have been recorded instead (`posterior_predictive`), the log density
/// in the parameters as named and the chains' acceptance rates
/// (`sample_stats`), the same from the prior where that is proper (`prior`,
/// `prior_predictive`), and the data (`observed_data`, and `constant_data`
/// with their standard errors).
///
/// All draws are in `posterior`. The other groups have every k-th of each
/// chain where all would be more than [`Scope::most_numbers`]; their
/// coordinate `draw` says which. A draw that the model rejects makes all data
/// impossible (minus infinity), and its replicate is not a number.
///
/// # Errors
/// No draws, or none that the model accepts; a model that fails.
pub fn gather(
    posterior: &Posterior<'_>,
    draws: &Draws,
    scope: &Scope,
    seed: Seed,
) -> Result<InferenceData> {
    let mut data = of_draws(draws, &scope.events)?;
    let recorded = recorded(posterior, draws)?;
    let values: usize = recorded.iter().map(Recorded::len).sum();
    let numbers = draws.total().saturating_mul(values);
    let step = numbers.div_ceil(scope.most_numbers.max(1)).max(1);
    let used = draws.every(step)?;
    let rows: Vec<&[f64]> = used.rows().collect();
    let heard = at_each(posterior, &rows, seed.child(0))?;
    let places = Places::every(draws, step);
    let table = Table { recorded: &recorded, places: &places };
    data.left_out = left_out(&heard, values, &used);
    data.groups.extend([
        table.log_likelihood(&heard, values)?,
        table.predictive("posterior_predictive", &heard, values)?,
        sample_stats(&heard, &places, draws)?,
    ]);
    if posterior.is_proper() {
        let prior = from_prior(posterior, &recorded, scope, seed.child(1))?;
        data.groups.extend(prior);
    }
    data.groups.extend(observed(&recorded)?);
    Ok(data)
}

/// The data that the model is compared with.
fn recorded(
    posterior: &Posterior<'_>,
    draws: &Draws,
) -> Result<Vec<Recorded>> {
    for row in draws.rows() {
        let mut heard = Data::default();
        let point = Point::Natural(row);
        let density = posterior.hear(point, &mut heard)?;
        if density.rejected.is_none() {
            return Ok(heard.all());
        }
    }
    Err(Error::inference("no draw has a flow to predict with"))
}

/// What the model says at each posterior draw; nothing where it rejects one.
fn at_each(
    posterior: &Posterior<'_>,
    rows: &[&[f64]],
    seed: Seed,
) -> Result<Vec<Option<Heard>>> {
    parallel::try_map((0..).zip(rows), |(i, row)| {
        hear(posterior, Origin::Row(row), seed.child(i))
    })
}

fn left_out(
    heard: &[Option<Heard>],
    values: usize,
    used: &Draws,
) -> Option<LeftOut> {
    let never = vec![f64::NEG_INFINITY; values];
    let efficiency = relative_efficiency(used);
    let loo = loo_of_chains(&log_likelihoods(heard, &never), efficiency)?;
    Some(LeftOut::new(loo, used.total(), efficiency))
}

fn sample_stats(
    heard: &[Option<Heard>],
    places: &Places,
    draws: &Draws,
) -> Result<Group> {
    let [chains, iterations] = places.shape();
    let log = |one: &Option<Heard>| {
        one.as_ref().map_or(f64::NEG_INFINITY, |heard| heard.log_posterior)
    };
    let logs = Values::Real(heard.iter().map(log).collect());
    let shape = [("chain", chains), ("draw", iterations)];
    let lp = Variable::new("lp", "1", &shape, logs)?;
    let about = "ln(prior x likelihood), in the parameters as named";
    let mut all = vec![lp.about(about)];
    if draws.acceptance().iter().any(|rate| rate.is_finite()) {
        let rates = Values::Real(draws.acceptance().to_vec());
        let shape = [("chain", chains)];
        let rates = Variable::new("acceptance_rate", "1", &shape, rates)?;
        all.push(rates.about("share of accepted proposals of each chain"));
    }
    all.extend(places.coordinates()?);
    Ok(Group::new("sample_stats", all))
}

/// Draws of the prior that the model accepts, and what might then have been
/// recorded; nothing where it accepts none.
fn from_prior(
    posterior: &Posterior<'_>,
    recorded: &[Recorded],
    scope: &Scope,
    seed: Seed,
) -> Result<Vec<Group>> {
    let values = recorded.iter().map(Recorded::len).sum::<usize>();
    let most = scope.most_numbers / values.max(1);
    let asked = scope.prior_draws.min(most) as u64;
    let one = |i: u64| hear(posterior, Origin::Prior, seed.child(i));
    let heard: Vec<Option<Heard>> = parallel::try_map(0..asked, one)?;
    let heard: Vec<_> = heard.into_iter().filter(Option::is_some).collect();
    if heard.is_empty() {
        return Ok(Vec::new());
    }
    let draws = (0..heard.len() as i64).collect();
    let places = Places { chains: 1, draws };
    let parameters = posterior.parameters().iter();
    let (names, units): (Vec<String>, Vec<String>) =
        parameters.map(|p| (p.name.clone(), p.unit.clone())).unzip();
    let named = Named { names: &names, units: &units, events: &scope.events };
    let rows = heard.iter().flatten();
    let rows: Vec<&[f64]> = rows.map(|h| h.parameters.as_slice()).collect();
    let mut all = variables(&named, places.shape(), &rows)?;
    all.extend(places.coordinates()?);
    let table = Table { recorded, places: &places };
    let rejected = (asked as usize - heard.len()).to_string();
    let mut groups = vec![
        Group::new("prior", all),
        table.predictive("prior_predictive", &heard, values)?,
    ];
    for group in &mut groups {
        group.attributes.push(("rejected".to_owned(), rejected.clone()));
    }
    Ok(groups)
}

/// The data, and their standard errors where some are known.
fn observed(recorded: &[Recorded]) -> Result<Vec<Group>> {
    let [mut values, mut errors] = [vec![], vec![]];
    for one in recorded {
        values.extend([one.observed()?, one.coordinate()?]);
        if let Some(found) = one.errors()? {
            errors.extend([found, one.coordinate()?]);
        }
    }
    let mut groups = vec![Group::new("observed_data", values)];
    if !errors.is_empty() {
        groups.push(Group::new("constant_data", errors));
    }
    Ok(groups)
}
