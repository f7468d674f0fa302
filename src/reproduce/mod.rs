//! The study of Heredia, Eckert, Prieur and Thibert (2020) computed again, on
//! data made as the paper says: neither its recording nor its surveyed track
//! are published.
//!
//! The track is Lautaret-like, not the Lautaret's. Where the paper leaves two
//! readings, both are computed; nothing is tuned towards its figures.

mod case;
mod coverage;
mod experiment;
mod json;
mod page;
mod ranked;
mod readings;

pub use case::{Case, Sensitivity};
pub use coverage::{ModelStudy, PriorStudy, Reading};
pub use experiment::{PRINTED, Priors, WIDE, Which};
pub use json::reproduction_json;
pub use page::{page, words};

use crate::error::{Error, Result};
use crate::infer::Progress;
use crate::observe::Series;
use crate::report::Origin;
use crate::sbc::Ranks;
use crate::seed::Seed;

/// Everything that was computed again.
#[derive(Debug, Clone)]
pub struct Reproduction {
    /// Where it comes from.
    pub origin: Origin,
    /// How many synthetic series.
    pub samples: usize,
    /// How many more were left out, since their errors carry them off the
    /// track.
    pub left_out: usize,
    /// The seed.
    pub seed: u64,
    /// Table 5 and Figure 8 under each prior of xi: wide, then printed.
    pub priors: [PriorStudy; 2],
    /// Other readings of how the series were made.
    pub readings: Vec<Reading>,
    /// Equation 13's mean speeds, calibrated as such and as instantaneous.
    pub windows: [Reading; 2],
    /// Figures 4 to 7 on the first series.
    pub case: Case,
    /// Table 6 and Figure 9 on the first series.
    pub sensitivity: Vec<Sensitivity>,
    /// Simulation-based calibration of M0 and M1.
    pub ranks: [Ranks; 2],
}

/// The most series that another reading is tried on.
const FEW: usize = 30;

/// Computes the study again.
///
/// # Errors
/// No series asked for.
pub fn reproduce(
    samples: usize,
    seed: u64,
    progress: &dyn Progress,
) -> Result<Reproduction> {
    if samples == 0 {
        return Err(Error::input(
            "--samples 0: expected 1 or more synthetic series",
        ));
    }
    let root = Seed::new(seed);
    let few = samples.min(FEW);
    let seen = coverage::synthetic(samples, root.child(0))?;
    let steps = 4 * seen.len() + 6 * few;
    progress.begin("calibrating", Some(steps as u64));
    let study = |name, priors, place: u64| {
        coverage::study(name, priors, &seen, root.child(place), progress)
    };
    let wide = study("wide", WIDE, 1)?;
    let printed = study("printed", PRINTED, 2)?;
    let readings = readings::readings(few, root.child(3), progress)?;
    let windows = readings::windows(few, root.child(4), progress)?;
    let replications = 2 * samples;
    let both = Some(2 * replications as u64);
    progress.begin("simulation-based calibration", both);
    let ranks = ranked::ranked(replications, root.child(6), progress)?;
    progress.begin("one series in detail", None);
    let first =
        experiment::plan(1.0, 0.0)?.with_recording(first_of(&seen)?)?;
    Ok(Reproduction {
        origin: Origin::default(),
        samples: seen.len(),
        left_out: samples - seen.len(),
        seed,
        priors: [wide, printed],
        readings,
        windows,
        case: case::case(&first, seed)?,
        sensitivity: case::sensitivity(&first, root.child(5))?,
        ranks,
    })
}

fn first_of(seen: &[Series]) -> Result<Series> {
    let first = seen.first().cloned();
    first.ok_or_else(|| Error::inference("there is no synthetic series"))
}

/// The Monte Carlo standard error of a count of `samples`, in percent; never
/// that of a certainty, which a finite number of series does not give.
fn error_of(count: usize, samples: usize) -> f64 {
    let n = samples as f64;
    // With one success and one failure more (Agresti, Coull 1998, in brief).
    let share = (count as f64 + 1.0) / (n + 2.0);
    100.0 * (share * (1.0 - share) / n).sqrt()
}
