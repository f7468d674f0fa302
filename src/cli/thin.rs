//! `--rate` and `--thin`: an event with fewer values a second.

use clap::Args;

use crate::error::Result;
use crate::observe::{Event, Thinned, Thinning};

/// How many values, about, are few: a diagnosis of so many takes a second.
const FEW: usize = 64;

/// How to thin recordings.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct Thin {
    /// Thin the recording to about R values a second; one that has no more
    /// stays as it is
    #[arg(long, value_name = "R", value_parser = rate)]
    rate: Option<f64>,
    /// How to thin it: by the average of each of equal bins, kept as a mean
    /// over a window (positions are picked), or by picking the last value of
    /// each; average if left out
    #[arg(long, value_name = "average|pick", value_parser = thinning,
          requires = "rate")]
    thin: Option<Thinning>,
    /// To half the rate that is left after that.
    #[arg(skip)]
    halved: bool,
    /// To few values, where no rate was given.
    #[arg(skip)]
    quick: bool,
}

fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if rate > 0.0 && f64::is_finite(rate) => Ok(rate),
        _ => Err("expected values a second, more than 0".into()),
    }
}

fn thinning(text: &str) -> Result<Thinning, String> {
    let expected = || format!("expected {}", Thinning::NAMES.join(" or "));
    Thinning::named(text).ok_or_else(expected)
}

impl Thin {
    /// The same, and then half as many values.
    pub(super) fn halved(&self) -> Self {
        Self { halved: true, ..self.clone() }
    }

    /// The same, to few values where that is wanted and no rate was given.
    pub(super) fn quickly(&self, quick: bool) -> Self {
        Self { quick: quick && self.rate.is_none(), ..self.clone() }
    }

    /// Whether recordings stay as they are.
    pub(super) fn is_none(&self) -> bool {
        self.rate.is_none() && !self.halved && !self.quick
    }

    /// The event with thinner recordings, and a sentence for each.
    pub(super) fn apply(&self, event: &Event) -> Result<(Event, Vec<String>)> {
        let how = self.thin.unwrap_or_default();
        let (mut event, mut said) = (event.clone(), Vec::new());
        let few = event.recordings().next().map(|series| {
            series.rate() * FEW as f64 / series.len().max(FEW) as f64
        });
        let thinned = match (self.rate, few) {
            (Some(rate), _) => Some(event.thinned(rate, how)?),
            // With gaps all over there may be no means of so many.
            (None, Some(few)) if self.quick => event
                .thinned(few, how)
                .ok()
                .filter(|(_, done)| done.iter().any(Thinned::is_less)),
            _ => None,
        };
        if let Some((thin, done)) = thinned {
            said.extend(done.iter().map(ToString::to_string));
            event = thin;
        }
        let own = event.recordings().next().map(|series| series.rate());
        if let (true, Some(own)) = (self.halved, own) {
            event = event.thinned(0.5 * own, how)?.0;
        }
        Ok((event, said))
    }
}
