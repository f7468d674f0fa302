//! What goes beside a long run: who hears how far it is, and what is kept of
//! it.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::checkpoint::Checkpoint;
use crate::error::Result;

/// Hears how far an inference has come, and keeps what it has computed.
pub trait Progress: Sync {
    /// A stretch of work begins, of so many steps where that is known.
    fn begin(&self, _what: &str, _steps: Option<u64>) {}
    /// So many steps are done.
    fn advance(&self, _steps: u64) {}
    /// Where parts of the work are kept, if they are.
    fn checkpoint(&self) -> Option<&Checkpoint> {
        None
    }
}

/// Progress that nobody listens to.
#[derive(Debug, Clone, Copy, Default)]
pub struct Quiet;

impl Progress for Quiet {}

/// A part of a run: as it was kept, or made now; see [`Checkpoint::part`].
///
/// ```
/// use couloir::infer::{Quiet, part};
/// assert_eq!(part(&Quiet, "series 3", || Ok(0.5))?, 0.5);
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// That of `make`.
pub fn part<T: Serialize + DeserializeOwned>(
    progress: &dyn Progress,
    name: &str,
    make: impl FnOnce() -> Result<T>,
) -> Result<T> {
    match progress.checkpoint() {
        Some(kept) => kept.part(name, make),
        None => make(),
    }
}
