//! What an inference found.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use crate::draws::{Draws, Summary};
use crate::model::Cost;

/// What an inference found; `{}` prints it as a short table.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Inference {
    /// Draws from the posterior, of the parameters as named.
    pub draws: Option<Draws>,
    /// What the model keeps beside its parameters (`keep` in `model!`), at
    /// each of the draws; `None` where it keeps nothing.
    pub kept: Option<Draws>,
    /// The figures of each parameter, where the draws are of chains: what
    /// the warnings about those were read off.
    pub summaries: Vec<Summary>,
    /// The posterior mode.
    pub mode: Option<Mode>,
    /// Each parameter's posterior without Monte Carlo error, where the backend
    /// integrates.
    pub marginals: Vec<Marginal>,
    /// The evidence.
    pub evidence: Option<Evidence>,
    /// What it cost.
    pub cost: Cost,
    /// Why the result should not be used as it is.
    pub warnings: Vec<String>,
    /// What would have made a better run; nothing against using this one.
    pub hints: Vec<String>,
}

impl Inference {
    /// An inference that found draws; the other fields can be set after.
    pub fn of_draws(draws: Draws) -> Self {
        Self { draws: Some(draws), ..Self::default() }
    }
}

/// The evidence, p(data), with its Monte Carlo error.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// Its natural logarithm.
    pub log: f64,
    /// The standard error of that.
    pub se: f64,
    /// How it was estimated.
    pub method: String,
}

/// The posterior mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// The parameters as named.
    pub natural: Vec<f64>,
    /// Their places on the real line.
    pub line: Vec<f64>,
    /// ln(prior x likelihood) there, in the parameters as named.
    pub log_density: f64,
    /// The inverse of the negative Hessian on the real line, from exact
    /// gradients: the covariance of a normal approximation. `None` where the
    /// Hessian is not negative definite, as it may be at a kink.
    pub covariance: Option<DMatrix<f64>>,
    /// The log density that each start led to, best first.
    pub reached: Vec<f64>,
}

/// The levels of a [`Marginal`]'s quantiles.
pub const LEVELS: [f64; 7] = [0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975];

/// One parameter's posterior, integrated over the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Marginal {
    /// The parameter's name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: f64,
    /// Its quantiles at [`LEVELS`].
    pub quantiles: [f64; 7],
}

impl Marginal {
    /// Whether the 90 % interval holds a value.
    pub fn covers(&self, value: f64) -> bool {
        (self.quantiles[1]..=self.quantiles[5]).contains(&value)
    }
}
