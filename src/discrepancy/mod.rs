//! Missing physics: where simulation and recording differ, and what was left
//! out.

pub mod mechanisms;
