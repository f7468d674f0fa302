//! Missing physics: where simulation and recording differ, and what was left
//! out.

pub mod mechanisms;

mod attribute;
mod fit;
mod locate;

pub use attribute::{Attribution, attribute, pair};
pub use fit::{Fit, fit};
pub use locate::{CELLS, FreeForce, locate};
