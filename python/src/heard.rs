//! How far the work has come, heard in one thread and told in another; and
//! the other way round, that nobody waits for it any more.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use couloir::infer::Progress;

/// How far the work has come.
#[derive(Debug, Default)]
pub(crate) struct Heard {
    /// What is being done, of how many steps where that is known.
    work: Mutex<(String, Option<u64>)>,
    done: AtomicU64,
    stopped: AtomicBool,
}

/// What a worker is unwound with where it is to stop.
struct Stopped;

impl Heard {
    /// Lets the work end where it next tells how far it has come.
    pub(crate) fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// What is being done, of how many steps, and how many of them are done.
    pub(crate) fn now(&self) -> (String, Option<u64>, u64) {
        let work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        let (what, steps) = work.clone();
        (what, steps, self.done.load(Ordering::Relaxed))
    }

    /// The library has no way to be stopped, and needs none: like a panic,
    /// this unwinds to the thread's beginning, past every destructor and out
    /// of every pool, but nothing is printed. That thread alone sees it.
    fn end_if_stopped(&self) {
        if self.stopped.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }
}

impl Progress for Heard {
    fn begin(&self, what: &str, steps: Option<u64>) {
        self.end_if_stopped();
        let mut work =
            self.work.lock().unwrap_or_else(PoisonError::into_inner);
        *work = (what.to_owned(), steps);
        self.done.store(0, Ordering::Relaxed);
    }

    fn advance(&self, steps: u64) {
        self.end_if_stopped();
        self.done.fetch_add(steps, Ordering::Relaxed);
    }
}
