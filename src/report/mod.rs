//! What a calibration found, as plain data, and how it is told: JSON,
//! sentences, a terminal table, pictures and one HTML page.
//!
//! This layer draws and writes text; it computes no inference. Whoever has
//! run one fills [`CalibrationReport`] and asks for the form they need. Every
//! function returns a `String` (or a JSON value) and accepts any numbers:
//! what is not finite is left out of pictures and is `n/a` in tables.

pub(crate) mod digits;
#[cfg(test)]
pub(crate) mod fixture;
mod json;
mod law;
mod misfit;
mod noises;
mod origin;
#[cfg(feature = "pages")]
mod page;
pub mod svg;
mod terminal;
pub(crate) mod text;
mod words;

pub use crate::predict::{Bands, Statistic};
pub use json::calibration_json;
pub(crate) use json::noise_json;
pub use law::LawReport;
pub use misfit::misfit;
pub use noises::{NoiseReport, noises};
pub(crate) use noises::{NoiseRow, noise_lines};
pub use origin::Origin;
#[cfg(feature = "pages")]
pub use page::page;
#[cfg(feature = "pages")]
pub(crate) use page::{drawn, figure, how_computed, noise_table, standalone};
pub use svg::{Picture, pictures};
pub use terminal::{picture, table};
pub use words::in_words;

/// The program, its version, and the commit that it was built from, as results
/// name it.
pub(crate) const PROGRAM: &str = concat!("couloir ", env!("COULOIR_VERSION"));

/// All that is told about one calibration.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct CalibrationReport {
    /// Where it comes from.
    pub origin: Origin,
    /// The event's name, as its file gives it.
    pub event: String,
    /// The friction law, as in `event.toml`: `voellmy`.
    pub friction: String,
    /// The error model, as in `event.toml`: `ar(1)`.
    pub noise: String,
    /// The mechanisms added to the model, as in `event.toml`.
    pub mechanisms: Vec<String>,
    /// The backend that ran: `mh`.
    pub backend: String,
    /// Why it did, where nobody asked for it.
    pub backend_why: Option<String>,
    /// The seed of every random draw.
    pub seed: u64,
    /// What was recorded: `velocity`, `position` or `acceleration`.
    pub quantity: String,
    /// The unit of the recording: `m/s`.
    pub unit: String,
    /// A value is the mean over that many seconds before its time; 0:
    /// instantaneous.
    pub window: f64,
    /// The unknowns, in the model's order.
    pub parameters: Vec<ParameterReport>,
    /// Times of the recording in s.
    pub times: Vec<f64>,
    /// The recording, in `unit`.
    pub values: Vec<f64>,
    /// How the recording was thinned beforehand, in sentences.
    pub notes: Vec<String>,
    /// Standard errors of the values, where the recording gives them.
    pub standard_errors: Option<Vec<f64>>,
    /// What the posterior predicts.
    pub bands: Bands,
    /// Figures of the recording beside those of its replicates.
    pub statistics: Vec<Statistic>,
    /// What the prior predicts.
    pub prior_bands: Option<Bands>,
    /// The terrain and the mass on it.
    pub track: TrackReport,
    /// Standardised innovations at the posterior median.
    pub innovations: Vec<f64>,
    /// The times of the innovations in s.
    pub innovation_times: Vec<f64>,
    /// Autocorrelation of the innovations at lags 1, 2, ...
    pub autocorrelation: Vec<f64>,
    /// The evidence, where the backend estimates it.
    pub evidence: Option<EvidenceReport>,
    /// The noises that it was averaged over, most probable first; empty where
    /// the noise was named. What is not of the motion is then of the first.
    pub noises: Vec<NoiseReport>,
    /// The law's parameters with the rest of the physics left open, where
    /// that was asked for.
    pub law: Option<LawReport>,
    /// Checks of the fit.
    pub checks: Checks,
    /// Acceptance rate of each chain; empty where none applies.
    pub acceptance: Vec<f64>,
    /// How often the flow was simulated.
    pub simulations: u64,
    /// Wall-clock time of the run in s.
    pub seconds: f64,
    /// What the reader has to know before trusting the result.
    pub warnings: Vec<String>,
    /// Those of the warnings for which the result should not be used.
    pub doubts: Vec<String>,
    /// Whether the recording was simulated, not measured.
    pub synthetic: bool,
}

impl CalibrationReport {
    /// What stands before "errors".
    pub(crate) fn errors_told(&self) -> &str {
        match self.noises.is_empty() {
            true => &self.noise,
            false => "inferred",
        }
    }

    /// The backend, and why it is the one where nobody asked for it.
    #[cfg(feature = "pages")]
    pub(crate) fn backend_told(&self) -> String {
        match &self.backend_why {
            Some(why) => format!("{} (picked since {why})", self.backend),
            None => self.backend.clone(),
        }
    }

    /// What stands behind "errors" where mechanisms were added.
    pub(crate) fn terms(&self) -> String {
        match self.mechanisms.is_empty() {
            true => String::new(),
            false => format!(" and {}", self.mechanisms.join(" and ")),
        }
    }
}

/// One unknown: its prior, its posterior and how well it was sampled.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct ParameterReport {
    /// Its name, as the model has it: `mu` or `friction.mu`.
    pub name: String,
    /// Its unit; `1` for a number without one.
    pub unit: String,
    /// Whether it belongs to the error model rather than to the motion.
    pub of_errors: bool,
    /// Its value at the posterior mode.
    pub map: Option<f64>,
    /// Posterior mean.
    pub mean: f64,
    /// Posterior standard deviation.
    pub sd: f64,
    /// 2.5 % quantile.
    pub q025: f64,
    /// 5 % quantile.
    pub q05: f64,
    /// Median.
    pub q50: f64,
    /// 95 % quantile.
    pub q95: f64,
    /// 97.5 % quantile.
    pub q975: f64,
    /// Rank-normalised split R-hat.
    pub rhat: f64,
    /// Bulk effective sample size.
    pub ess_bulk: f64,
    /// Tail effective sample size.
    pub ess_tail: f64,
    /// Monte Carlo standard error of the mean.
    pub mcse_mean: f64,
    /// The prior in words of `event.toml`: `Gamma(9, 0.03)`.
    pub prior_text: String,
    /// The prior density at some values.
    pub prior_density: Vec<(f64, f64)>,
    /// The posterior density at some values.
    pub posterior_density: Vec<(f64, f64)>,
    /// The draws chain by chain, thinned, for traces.
    pub chains: Vec<Vec<f64>>,
    /// The draws of all chains, thinned, in the same order for every
    /// parameter, for pairs.
    pub pooled: Vec<f64>,
}

/// The terrain and where the mass of the median flow is on it.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct TrackReport {
    /// Horizontal distance of the surveyed points in m.
    pub x: Vec<f64>,
    /// Elevation of the surveyed points in m.
    pub z: Vec<f64>,
    /// Time in s, horizontal distance in m and elevation in m of the mass.
    pub positions: Vec<(f64, f64, f64)>,
    /// The same where the mass comes to rest, if it does.
    pub rest: Option<(f64, f64, f64)>,
}

/// An estimate of the log evidence.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct EvidenceReport {
    /// ln p(recording | model).
    pub value: f64,
    /// Its Monte Carlo standard error.
    pub se: f64,
    /// How it was estimated.
    pub method: String,
}

/// Checks of the fit; NaN where one is not available.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Checks {
    /// p-value of the Ljung-Box test of the innovations.
    pub ljung_box_p: f64,
    /// p-value of the Shapiro-Wilk test of the innovations.
    pub shapiro_wilk_p: f64,
    /// The smallest p-value, over parameters, of Kolmogorov-Smirnov tests
    /// between chains.
    pub kolmogorov_smirnov_p: f64,
    /// Share of the values inside the 90 % predictive band.
    pub coverage90: f64,
    /// Root mean square of recording minus median flow.
    pub rmse: f64,
}

impl Default for Checks {
    fn default() -> Self {
        Self {
            ljung_box_p: f64::NAN,
            shapiro_wilk_p: f64::NAN,
            kolmogorov_smirnov_p: f64::NAN,
            coverage90: f64::NAN,
            rmse: f64::NAN,
        }
    }
}

impl ParameterReport {
    /// The unit to print: empty for a number without one.
    fn unit_shown(&self) -> String {
        text::unit(&self.unit)
    }
}

// The page is one of the forms they look at.
#[cfg(test)]
#[cfg(feature = "pages")]
mod tests;
