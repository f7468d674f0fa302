//! Missing physics: where simulation and recording differ, and what was left
//! out.

mod compare;
mod decide;
mod declarations;
mod diagnose;
mod evidence;
mod findings;
#[cfg(test)]
mod fixture;
mod hypothesis;
mod locate;
mod options;
mod rate;
mod tell;
// The page is one of the forms they look at.
#[cfg(test)]
#[cfg(feature = "pages")]
mod tests;
mod together;

pub use crate::model::Together;
pub use decide::judge::judge;
pub use decide::odds::{Odds, prior_probabilities};
pub use diagnose::{diagnose, diagnose_together};
pub use evidence::attribute::{Attribution, attribute};
pub use evidence::combination::pair;
pub use evidence::fit::{Fit, fit};
pub(crate) use evidence::noises::{Noises, Noisy, noises};
pub use findings::{
    Baseline, BeforeAfter, Corrected, Diagnosis, Improvement, Judged,
    JudgedNoise, LawParameters, Mismatch, ParameterSummary, Pictured, Rest,
    Rival, Variant, Verdict, Withheld,
};
pub use hypothesis::Hypothesis;
pub use locate::{Band, CELLS, FreeForce, locate};
pub(crate) use locate::{left_open, locate_all, no_density};
pub use options::Options;
#[cfg(feature = "pages")]
pub use tell::page::page;
pub use tell::pictures::pictures;
pub use tell::summary::summary;
pub use tell::words::in_words;
pub use together::Sharing;
