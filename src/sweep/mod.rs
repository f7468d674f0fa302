//! Many events, each a task of its own: what is done is kept, and never done
//! again.
//!
//! A task is named by a checksum of all that its result follows from. Results
//! are lines of journals that are only ever appended to, one journal a
//! process: a run that is killed loses the tasks that were under way, and two
//! runs on one folder do each other no harm.

mod files;
mod journal;
mod listed;
mod listing;
mod page;
#[cfg(feature = "export")]
mod parquet;
mod row;
mod run;
mod shard;
mod summary;
mod table;
mod task;

pub use files::{Rows, summed, write_csv, write_json};
pub use journal::{Index, Outcome};
pub use listed::{Listed, listed};
pub(crate) use listing::calibrated;
pub use page::page;
#[cfg(feature = "export")]
pub use parquet::write_parquet;
pub(crate) use row::csv_cell;
pub use row::{DRAWS, Row};
pub use run::{Plan, Ran, cores, run};
pub use shard::Shard;
pub use summary::Summary;
pub use task::{Key, Task, without_path};
