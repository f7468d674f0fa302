//! Missing physics: where simulation and recording differ, and what was left
//! out.

pub mod mechanisms;

mod apart;
mod attribute;
mod before_and_after;
mod check;
mod choose;
mod diagnose;
mod diagnosis;
mod fit;
#[cfg(test)]
mod fixture;
mod judge;
mod least_squares;
mod locate;
mod options;
mod page;
mod paste;
mod phrases;
mod pictures;
mod place;
mod ridges;
mod signs;
mod summary;
#[cfg(test)]
mod tests;
mod together;
mod words;

pub use attribute::{Attribution, attribute, pair};
pub use diagnose::{diagnose, diagnose_together};
pub use diagnosis::{
    Baseline, Corrected, Diagnosis, Improvement, Judged, Mismatch, Pair,
    Pictured, Rival, Told, Verdict,
};
pub use fit::{Fit, fit};
pub use judge::Odds;
pub use locate::{CELLS, FreeForce, locate};
pub use options::Options;
pub use page::page;
pub use pictures::pictures;
pub use summary::summary;
pub use together::{PerEvent, Pooled, Sharing, Together};
pub use words::in_words;
