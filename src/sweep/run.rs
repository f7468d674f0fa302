//! Doing what is not done yet, on the cores of this machine.

use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use rand::seq::SliceRandom as _;
use serde_json::Value;

use super::journal::{Index, Journal, Others, Outcome, nonce};
use super::listed::Listed;
use super::shard::Shard;
use super::task::{Key, Task};
use crate::error::{Error, Result};
use crate::io::sha256;
use crate::seed::Seed;

/// How a sweep is run.
#[derive(Debug, Clone)]
pub struct Plan<'a> {
    /// The sweep's folder.
    pub folder: &'a Path,
    /// How many tasks at a time.
    pub jobs: usize,
    /// Whether to try again what failed.
    pub retry: bool,
    /// Which part of the list the tasks are.
    pub shard: Shard,
    /// The list. Its shards hold different tasks, but where the list has an
    /// event twice: that is then done by each of them, to the same result.
    pub list: &'a [Listed],
}

/// What a run did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Ran {
    /// Tasks that had been done before.
    pub before: usize,
    /// Tasks that stand in the list again, as another event with the same
    /// files.
    pub again: usize,
    /// Tasks that this run did.
    pub done: usize,
    /// Tasks of this run that failed.
    pub failed: usize,
    /// Tasks that there were to do when it began.
    pub to_do: usize,
}

/// How long results of other processes may stay unseen.
const UNSEEN: Duration = Duration::from_secs(10);

/// Does the tasks that have no result in the sweep's folder, several at a
/// time, and keeps what comes of each. `told` hears of every task.
///
/// Tasks are begun in an order that differs from process to process: two that
/// run on one folder rarely do the same, and the time that is left can be
/// told from that of those done.
///
/// # Errors
/// A folder that cannot be read or written; a task's own error, or a panic,
/// is what came of it.
pub fn run(
    tasks: &[Task],
    plan: &Plan<'_>,
    work: &(dyn Fn(&Task) -> Result<Value> + Sync),
    told: &mut dyn FnMut(&Ran),
) -> Result<Ran> {
    let index = Index::without(plan.folder, plan.others())?;
    let (mut open, mut ran) = left(tasks, &index, plan.retry);
    told(&ran);
    if open.is_empty() {
        return Ok(ran);
    }
    open.shuffle(&mut Seed::new(0).called(&nonce()).rng());
    let mut journal = Journal::create(plan.folder, &plan.part())?;
    let queue = Queue {
        open,
        next: AtomicUsize::new(0),
        stopped: AtomicBool::new(false),
        index: Mutex::new((index, Instant::now())),
        retry: plan.retry,
    };
    let jobs = plan.jobs.clamp(1, ran.to_do);
    let (sender, receiver) = sync_channel(jobs);
    thread::scope(|scope| {
        for _ in 0..jobs {
            let (queue, sender) = (&queue, sender.clone());
            scope.spawn(move || queue.work(jobs, work, &sender));
        }
        drop(sender);
        let kept = keep(&receiver, &mut journal, &mut ran, told);
        // Whoever still has something to hand over finds nobody there.
        queue.stopped.store(true, Ordering::Relaxed);
        drop(receiver);
        kept
    })?;
    ran.before = tasks.len() - ran.again - ran.done - ran.failed;
    Ok(ran)
}

/// The tasks that are to do, each once, and what there is beside them.
fn left<'t>(
    tasks: &'t [Task],
    index: &Index,
    retry: bool,
) -> (Vec<&'t Task>, Ran) {
    let mut seen = HashSet::new();
    let each = tasks.iter().filter(|task| seen.insert(task.key));
    let is_open =
        |task: &&Task| index.has_failed(&task.key).is_none_or(|f| f && retry);
    let open: Vec<&Task> = each.filter(is_open).collect();
    let (to_do, again) = (open.len(), tasks.len() - seen.len());
    let before = tasks.len() - again - to_do;
    (open, Ran { to_do, again, before, ..Ran::default() })
}

impl Plan<'_> {
    /// How journals of the list begin.
    fn begin(&self) -> String {
        let names: Vec<String> = self.list.iter().map(Listed::name).collect();
        format!("{}-", &sha256(names.join("\n").as_bytes())[..8])
    }

    /// How journals of this part of the list begin.
    fn part(&self) -> String {
        let shard = self.shard.to_string().replace('/', "-of-");
        format!("{}{shard}", self.begin())
    }

    /// The journals of the other shards, of which none holds a task of this
    /// one: it need not read what a thousand others wrote.
    fn others(&self) -> Option<Others> {
        let of = self.shard.of();
        let names = || Others {
            list: self.begin(),
            of: format!("-of-{of}-"),
            own: format!("{}-", self.part()),
        };
        (of > 1).then(names)
    }
}

/// What there is to do, for several threads.
struct Queue<'t> {
    open: Vec<&'t Task>,
    next: AtomicUsize,
    stopped: AtomicBool,
    index: Mutex<(Index, Instant)>,
    retry: bool,
}

impl<'t> Queue<'t> {
    /// Does tasks until there is none left, or nobody takes what came of them.
    fn work(
        &self,
        jobs: usize,
        work: &(dyn Fn(&Task) -> Result<Value> + Sync),
        sender: &SyncSender<(Key, Outcome)>,
    ) {
        // Threads of its own for each: a task that waits for its parts would
        // otherwise begin another one within itself, and memory would grow.
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let threads = (cores / jobs).max(1);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build();
        while let Some(task) = self.take() {
            let outcome = match &pool {
                Ok(pool) => pool.install(|| outcome(task, work)),
                Err(_) => outcome(task, work),
            };
            if sender.send((task.key, outcome)).is_err() {
                return;
            }
        }
    }

    /// The next task that nobody has done.
    fn take(&self) -> Option<&'t Task> {
        loop {
            if self.stopped.load(Ordering::Relaxed) {
                return None;
            }
            let at = self.next.fetch_add(1, Ordering::Relaxed);
            let task = self.open.get(at)?;
            if !self.is_done_elsewhere(&task.key) {
                return Some(task);
            }
        }
    }

    fn is_done_elsewhere(&self, key: &Key) -> bool {
        let lock = self.index.lock();
        let mut seen = lock.unwrap_or_else(PoisonError::into_inner);
        let (index, at) = &mut *seen;
        if at.elapsed() > UNSEEN {
            // What cannot be read now is done again, which does no harm.
            let _ = index.refresh();
            *at = Instant::now();
        }
        index.has_failed(key).is_some_and(|failed| !(failed && self.retry))
    }
}

/// What comes of a task; a panic is told as the fault of the program it is.
fn outcome(
    task: &Task,
    work: &(dyn Fn(&Task) -> Result<Value> + Sync),
) -> Outcome {
    match catch_unwind(AssertUnwindSafe(|| work(task))) {
        Ok(Ok(result)) => Outcome::Done(result),
        Ok(Err(error)) => Outcome::Failed(error.to_string()),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            let text = text.unwrap_or("no message");
            Outcome::Failed(format!("a fault of couloir itself: {text}"))
        }
    }
}

/// Writes what comes, all that is there at a time, until nothing more does.
fn keep(
    receiver: &Receiver<(Key, Outcome)>,
    journal: &mut Journal,
    ran: &mut Ran,
    told: &mut dyn FnMut(&Ran),
) -> Result<()> {
    while let Ok(first) = receiver.recv() {
        let all: Vec<_> =
            std::iter::once(first).chain(receiver.try_iter()).collect();
        journal.append(&all)?;
        for (_, outcome) in &all {
            match outcome.has_failed() {
                true => ran.failed += 1,
                false => ran.done += 1,
            }
            told(ran);
        }
    }
    Ok(())
}

/// How many tasks this machine does at a time.
///
/// # Errors
/// A machine that does not say how many cores it has.
pub fn cores() -> Result<usize> {
    let cores = thread::available_parallelism();
    cores.map(usize::from).map_err(|error| Error::system(error.to_string()))
}
