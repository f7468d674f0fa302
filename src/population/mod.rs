//! What events have in common: parameters that each event has its own value
//! of, drawn from one population, inferred from the events' own posteriors.
//!
//! Calibrating a thousand events together is one posterior of thousands of
//! dimensions. Calibrating each alone is a thousand small ones, and they are
//! there already. With phi_ij the draws of event i under its own prior pi_i,
//! the likelihood of a population with the parameters lambda is
//!
//! ```text
//! p(all data | lambda) = prod_i Z_i mean_j p(phi_ij | lambda) / pi_i(phi_ij)
//! ```
//!
//! (Hogg, Myers, Bovy 2010, arXiv 1008.4146, equation 9), since the draws of
//! an event stand for its likelihood times its prior; the Z_i do not depend on
//! lambda. The population is normal in each parameter, in its logarithm where
//! it is positive: lambda is a mean and a spread of each. An event's own
//! parameters, given all events, are its draws weighted by the same ratios.
//!
//! The method stands on draws that reach where the population is. Three
//! figures tell: how many draws of an event its weights are worth, what half
//! of the draws says of the population beside the other half, and R-hat of
//! lambda. A population much narrower than what each event knows leaves few
//! draws, and more have to be kept.
//!
//! ```
//! use couloir::draws::Draws;
//! use couloir::infer::Quiet;
//! use couloir::population::{Member, pool};
//! use couloir::prior::AnyPrior;
//! use couloir::rand::RngExt;
//! use couloir::Seed;
//! let mut rng = Seed::new(1).rng();
//! let mut member = |centre: f64| {
//!     let mut draws = Draws::new(vec!["mu".into()], vec!["1".into()])?;
//!     let draw = |_| centre + 0.02 * (rng.random::<f64>() - 0.5);
//!     draws.push_chain((0..200).map(draw).collect(), None)?;
//!     let priors = vec![AnyPrior::parse("Uniform(0, 1)")?];
//!     Ok(Member { name: format!("{centre}"), draws, priors })
//! };
//! let members = [0.25, 0.3, 0.35].map(|centre| member(centre));
//! let members: couloir::Result<Vec<_>> = members.into_iter().collect();
//! let found = pool(&members?, Seed::new(2), &Quiet)?;
//! let [low, half, high] = found.parameters[0].median;
//! assert!(low < 0.3 && 0.25 < half && half < 0.35 && 0.3 < high);
//! # Ok::<(), couloir::Error>(())
//! ```

mod check;
mod hyper;
mod member;
mod pooled;

pub use member::Member;
pub use pooled::{Pooled, Shared};

use crate::draws::Draws;
use crate::error::{Error, Result};
use crate::infer::{Effort, MetropolisHastings, Progress, infer};
use crate::model::Posterior;
use crate::seed::Seed;

use hyper::Hyper;

/// A population, and its members given all of them.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Population {
    /// What the population says of each parameter.
    pub parameters: Vec<Shared>,
    /// Every member, in the order given.
    pub members: Vec<Pooled>,
    /// Draws of the population's own parameters, `mean_NAME` and
    /// `spread_NAME`, in the logarithm where the parameter is positive.
    pub draws: Draws,
    /// Why the result should not be used as it is.
    pub warnings: Vec<String>,
}

/// The fewest draws of a chain and the most: enough for two figures of a mean
/// and a spread of a few parameters. Each costs a pass over all draws of all
/// events, and few events, which tell little, leave long tails.
const FEWEST: usize = 2_500;
const MOST: usize = 20_000;
/// Draws of a chain times events.
const PASSES: usize = 100_000;

/// How long the walk is with so many events.
fn effort(members: usize) -> Effort {
    let draws = (PASSES / members).clamp(FEWEST, MOST);
    Effort { chains: 4, draws, warmup: 2 * draws / 5 }
}

/// Infers the population that members were drawn from.
///
/// The mean of a parameter has a normal prior about the middle of the
/// members' priors, as wide as they are; the spread half a normal one of that
/// width. Neither is from the data.
///
/// # Errors
/// Fewer than two members, members with other parameters than the first, with
/// too few draws, or with an improper prior.
pub fn pool(
    members: &[Member],
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Population> {
    if members.len() < 2 {
        return Err(Error::input(format!(
            "a population of {} members; expected 2 or more events that were \
             calibrated under the same law",
            members.len()
        )));
    }
    let hyper = Hyper::of(members)?;
    let posterior = Posterior::new(&hyper)?;
    let walk = MetropolisHastings::adaptive(&effort(members.len()));
    progress.begin("population", None);
    let found = infer(&walk, &posterior, seed.child(0), progress)?;
    let draws = found
        .draws
        .ok_or_else(|| Error::inference("the walk left no draws"))?;
    let mut warnings = found.warnings;
    let parameters = pooled::parameters(&hyper, &draws, seed.child(1));
    let parameters = check::with_errors(&hyper, &draws, parameters);
    let members = pooled::members(&hyper, members, &draws);
    warnings.extend(check::warnings(&parameters, &members));
    Ok(Population { parameters, members, draws, warnings })
}
