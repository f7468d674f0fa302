//! Missing physics: where simulation and recording differ, and what was left
//! out.

pub mod mechanisms;

mod attribute;
mod diagnosis;
mod fit;
#[cfg(test)]
mod fixture;
mod locate;
mod page;
mod phrases;
mod pictures;
mod summary;
#[cfg(test)]
mod tests;
mod words;

pub use attribute::{Attribution, attribute, pair};
pub use diagnosis::{
    Baseline, Corrected, Diagnosis, Improvement, Judged, Mismatch, Pair,
    Pictured, Told, Verdict,
};
pub use fit::{Fit, fit};
pub use locate::{CELLS, FreeForce, locate};
pub use page::page;
pub use summary::summary;
pub use words::in_words;
