//! The paper's synthetic experiment: truth, track, priors, models, series.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::{Error, Result};
use crate::io::read_track;
use crate::model::Assembled;
use crate::noise;
use crate::observe::{Event, Series};
use crate::physics::Track;
use crate::physics::friction::Laws;
use crate::predict::simulate;
use crate::prior::AnyPrior;
use crate::seed::Seed;

/// Table 2: mu, xi \[m/s2\], phi, sigma2 \[m2/s2\].
pub(super) const TRUTH: [f64; 4] = [0.32, 495.73, 0.65, 8.07];

/// The mean flow depth h \[m\].
const DEPTH: f64 = 2.19;

/// How many values a series has, one a second.
const VALUES: usize = 21;

/// The two models: independent errors, and autocorrelated ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Which {
    /// Independent errors.
    M0,
    /// AR(1) errors.
    M1,
}

impl Which {
    /// Both, in the paper's order.
    pub const BOTH: [Self; 2] = [Self::M0, Self::M1];

    /// The paper's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::M0 => "M0",
            Self::M1 => "M1",
        }
    }

    fn noise(self) -> &'static str {
        match self {
            Self::M0 => "iid",
            Self::M1 => "ar(1)",
        }
    }

    /// The true values of the model's parameters, in its order. The errors'
    /// variance is held to that of the innovations under both models.
    pub(super) fn truth(self, truth: [f64; 4]) -> Vec<f64> {
        let [mu, xi, phi, sigma2] = truth;
        match self {
            Self::M0 => vec![mu, xi, sigma2],
            Self::M1 => vec![mu, xi, phi, sigma2],
        }
    }
}

/// The priors of a calibration, one text for each parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Priors {
    /// Of mu.
    pub mu: &'static str,
    /// Of xi.
    pub xi: &'static str,
    /// Of sigma2.
    pub sigma2: &'static str,
}

/// The reading of xi's prior that fits the paper's own posterior.
pub const WIDE: Priors = Priors {
    mu: "Gamma(9, 0.03)",
    xi: "Gamma(2.5, 400)",
    sigma2: "InverseGamma(3, 20)",
};

/// Table 3 as printed.
pub const PRINTED: Priors = Priors { xi: "Gamma(25, 40)", ..WIDE };

/// A Lautaret-like track: 450 m long, not the surveyed one, which was not
/// published.
fn track() -> Result<Track> {
    let text = include_str!("../../tests/data/voellmy-21/track.csv");
    read_track(text.as_bytes(), Path::new("voellmy-21/track.csv"))
}

/// The event with a series yet to be filled, its values spread over the
/// recording's 21 s by `step` \[s\].
pub(super) fn plan(step: f64, window: f64) -> Result<Event> {
    on(track()?, step, window)
}

/// The same on another track.
pub(super) fn on(track: Track, step: f64, window: f64) -> Result<Event> {
    let count = (VALUES as f64 / step).round() as usize;
    let times: Vec<f64> = (1..=count).map(|i| i as f64 * step).collect();
    let series = Series::velocity(times, vec![0.0; count])?;
    Event::on(track)
        .named("Lautaret-like, synthetic")
        .depth(DEPTH)
        .release(0.0, 0.0)
        .velocity(series.with_window(window)?)
        .build()
}

/// A model of an event.
pub(super) fn model(
    event: Event,
    which: Which,
    priors: &Priors,
) -> Result<Assembled> {
    let mut own = BTreeMap::new();
    for (name, text) in [
        ("mu", priors.mu),
        ("xi", priors.xi),
        ("sigma2", priors.sigma2),
        ("phi", "Uniform(-1, 1)"),
    ] {
        own.insert(name.to_owned(), AnyPrior::parse(text)?);
    }
    let law = Laws::default().parse("voellmy")?;
    Assembled::new(event, law, noise::parse(which.noise())?, &own)
}

/// How many times an error is drawn again while a speed is negative.
const REDRAWS: u64 = 100_000;

/// One synthetic series: Voellmy's flow with AR(1) errors, drawn again while
/// any of its speeds is negative.
pub(super) fn series(
    plan: &Event,
    truth: [f64; 4],
    seed: Seed,
) -> Result<Series> {
    let model = model(plan.clone(), Which::M1, &WIDE)?;
    for attempt in 0..REDRAWS {
        let seen = simulate(&model, &truth, seed.child(attempt))?;
        let Some(series) = seen.into_iter().next() else { break };
        if series.values().iter().all(|speed| *speed >= 0.0) {
            return Ok(series);
        }
    }
    Err(Error::inference("no synthetic series without a negative speed"))
}
