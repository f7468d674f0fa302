//! Missing physics: where simulation and recording differ, and what was left
//! out.

pub mod mechanisms;

mod attribute;
mod before_and_after;
mod diagnose;
mod diagnosis;
mod fit;
mod judge;
mod locate;
mod paste;
mod place;
mod together;

pub use attribute::{Attribution, attribute, pair};
pub use diagnose::{Options, diagnose};
pub use diagnosis::{
    Baseline, Corrected, Diagnosis, Improvement, Judged, Mismatch, Pair,
    Pictured, Told, Verdict,
};
pub use fit::{Fit, fit};
pub use judge::Odds;
pub use locate::{CELLS, FreeForce, locate};
pub use together::{PerEvent, Pooled, Sharing, Together};
