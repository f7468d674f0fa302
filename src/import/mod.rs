//! Event folders from the files that people have: the logs of GNSS sensors,
//! the places of a front, a terrain model, a path; or from a project of
//! AvaFrame, which has them all.
//!
//! Each format is read in a file of its own (`table.rs`, `gpx_file.rs`,
//! `esri_grid.rs`, `geotiff.rs`, `outline.rs`, `avaframe/`); `work.rs` goes from there to
//! events, step by step (`moving.rs`, `along.rs`, `elevations.rs`,
//! `together.rs`), and says in sentences what it did. What it doubts is in
//! `doubts.rs`.

mod along;
mod avaframe;
mod case;
mod clock;
mod columns;
mod crs;
mod doubts;
mod elevations;
mod esri_grid;
mod event;
mod front;
mod geotiff;
mod gpx_file;
mod grid;
mod ground;
mod imported;
mod line;
mod log;
mod moving;
mod options;
mod outline;
mod particle;
mod phase;
mod picture;
mod plane;
mod role;
mod shapes;
mod smooth;
mod source;
mod table;
mod tiff_tags;
mod together;
mod work;

pub use imported::{FILES, Imported, import, import_all};
pub use options::Options;
pub use particle::Particle;
