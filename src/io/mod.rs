//! Files: events that are read, folders that are written.
//!
//! Everything a person wrote comes in here, so everything that can be wrong
//! with it is said here: each message is one line that names the file, the
//! line or key, what was found, what was expected, and the mend.

mod corrected;
mod csv_file;
mod document;
mod doubtful;
mod embedded;
mod event_file;
#[cfg(feature = "import")]
mod foreign;
#[cfg(feature = "cli")]
mod inputs;
mod lines;
mod outside;
mod plausible;
#[cfg(feature = "cli")]
mod run_folder;
mod source;
mod template;
mod words;
mod write;

pub use corrected::{Correction, corrected};
pub use csv_file::{MOST_ROWS, read_depth, read_recording, read_track};
pub use embedded::coastdown;
pub use event_file::{EventFile, load, parse_event};
#[cfg(feature = "import")]
pub(crate) use foreign::{read_any_text, read_bytes};
#[cfg(feature = "cli")]
pub(crate) use inputs::{inputs, sha256};
#[cfg(feature = "import")]
pub(crate) use plausible::{FASTEST, is_mark, may_be_mark};
#[cfg(feature = "cli")]
pub(crate) use run_folder::{prepare_run, write_run, write_run_of};
pub use template::new_event;
#[cfg(feature = "import")]
pub(crate) use words::either;
#[cfg(any(feature = "cli", feature = "import"))]
pub(crate) use words::{place, quoted};
#[cfg(feature = "cli")]
pub(crate) use write::Content;
pub use write::write_all;
