//! Missing physics: where simulation and recording differ, and what was left
//! out.

pub mod mechanisms;

mod attribute;
mod diagnosis;
mod fit;
mod locate;

pub use attribute::{Attribution, attribute, pair};
pub use diagnosis::{
    Baseline, Corrected, Diagnosis, Improvement, Judged, Mismatch, Pair,
    Pictured, Told, Verdict,
};
pub use fit::{Fit, fit};
pub use locate::{CELLS, FreeForce, locate};
