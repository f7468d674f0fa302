//! A calibration in a terminal: plain characters, no colour.

mod picture;
mod table;

pub use picture::picture;
pub use table::table;
