//! Many events, each a task of its own: what is done is kept, and never done
//! again.
//!
//! A task is named by a checksum of all that its result follows from. Results
//! are lines of journals that are only ever appended to, one journal a
//! process: a run that is killed loses the tasks that were under way, and two
//! runs on one folder do each other no harm.

mod journal;
mod listed;
mod run;
mod shard;
mod summary;
mod task;

pub use journal::{Index, Outcome};
pub use listed::{Listed, listed};
pub use run::{Plan, Ran, cores, run};
pub use shard::Shard;
pub use summary::{Row, Summary};
pub use task::{Key, Task};
