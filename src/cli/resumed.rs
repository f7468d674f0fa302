//! A run that goes on where it was stopped: what it has computed so far is in
//! a file beside its results, until they are there.

use std::path::Path;

use super::progress::Told;
use crate::checkpoint::Checkpoint;
use crate::error::Result;
use crate::infer::Progress;
use crate::report::PROGRAM;

/// What the file is called.
const FILE: &str = ".couloir-checkpoint";

/// The checkpoint of a run with results in a folder, which says whether it
/// goes on; none where there is no folder. `run` says all that the results
/// follow from beside the program.
pub(super) fn checkpoint(
    out: Option<&Path>,
    run: &str,
    told: &Told,
) -> Result<Option<Checkpoint>> {
    let Some(out) = out else { return Ok(None) };
    let run = format!("{PROGRAM} {run}");
    let checkpoint = Checkpoint::open(&out.join(FILE), &run)?;
    if checkpoint.parts() > 0 {
        told.say(&format!(
            "Going on where this run was stopped, with {} parts of it kept",
            checkpoint.parts()
        ));
    }
    Ok(Some(checkpoint))
}

/// Removes the checkpoint of a run whose results are written.
pub(super) fn conclude(checkpoint: Option<Checkpoint>, wrote: &Result<()>) {
    if let Some(checkpoint) = checkpoint.filter(|_| wrote.is_ok()) {
        checkpoint.remove();
    }
}

/// Progress of a run with a checkpoint.
pub(super) struct Resumed<'a> {
    pub(super) heard: &'a dyn Progress,
    pub(super) checkpoint: Option<&'a Checkpoint>,
}

impl Progress for Resumed<'_> {
    fn begin(&self, what: &str, steps: Option<u64>) {
        self.heard.begin(what, steps);
    }

    fn advance(&self, steps: u64) {
        self.heard.advance(steps);
    }

    fn checkpoint(&self) -> Option<&Checkpoint> {
        self.checkpoint
    }
}
