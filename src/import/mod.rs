//! Event folders from the files that people have: the log of a GNSS sensor, a
//! terrain model, a path.
//!
//! Each format is read in a file of its own (`table.rs`, `gpx_file.rs`,
//! `grid.rs`, `outline.rs`); `work.rs` goes from there to an event, step by
//! step, and says in sentences what it did. What it doubts is in `doubts.rs`.

mod case;
mod clock;
mod columns;
mod crs;
mod doubts;
mod event;
mod gpx_file;
mod grid;
mod ground;
mod imported;
mod line;
mod log;
mod options;
mod outline;
mod phase;
mod picture;
mod plane;
mod role;
mod smooth;
mod source;
mod table;
mod work;

pub use imported::{FILES, Imported, import};
pub use options::Options;
