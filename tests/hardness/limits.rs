//! What every input has to keep to: no panic, a second, 256 MB.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use allocation_counter::measure;
use couloir::Error;

/// The longest that an input may take.
const LONGEST: Duration = Duration::from_secs(1);

/// The most memory that it may take \[bytes\].
const MOST: u64 = 256 << 20;

/// After this time an input is taken for one without an end.
const ENDLESS: Duration = Duration::from_secs(60);

/// The longest message of a refusal \[bytes\].
const LONGEST_MESSAGE: usize = 2000;

/// What a target does with an input that is in a file.
pub(crate) type Take = fn(&Path, &[u8]) -> Result<(), Error>;

/// What was seen so far.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) inputs: u64,
    /// Inputs that were good.
    pub(crate) taken: u64,
    pub(crate) slowest: Duration,
    pub(crate) most: u64,
}

/// Gives inputs to a target, and watches it.
pub(crate) struct Watched {
    take: Take,
    folder: PathBuf,
    begun: Arc<Mutex<Option<Instant>>>,
}

impl Watched {
    /// Inputs lie in `folder` while they are taken: where one ends the
    /// process, it is found there.
    pub(crate) fn new(take: Take, folder: PathBuf) -> Self {
        let begun = Arc::new(Mutex::new(None));
        watch(Arc::downgrade(&begun), folder.clone());
        Self { take, folder, begun }
    }

    /// One input; what is wrong with how it was taken.
    pub(crate) fn give(
        &self,
        input: &[u8],
        tally: &mut Tally,
    ) -> Result<(), String> {
        fs::write(self.folder.join("input"), input).unwrap();
        let mut time = Duration::MAX;
        // A machine with other work may be slow once.
        for _ in 0..3 {
            let (took, most) = self.once(input, tally)?;
            time = time.min(took);
            if most > MOST {
                return Err(format!("took {} MB", most >> 20));
            }
            tally.most = tally.most.max(most);
            if time <= LONGEST {
                break;
            }
        }
        tally.inputs += 1;
        tally.slowest = tally.slowest.max(time);
        match time <= LONGEST {
            true => Ok(()),
            false => Err(format!("took {:.1} s", time.as_secs_f64())),
        }
    }

    fn once(
        &self,
        input: &[u8],
        tally: &mut Tally,
    ) -> Result<(Duration, u64), String> {
        let begun = Instant::now();
        *self.begun.lock().unwrap() = Some(begun);
        let mut end = None;
        let memory = measure(|| {
            let take = || (self.take)(&self.folder, input);
            end = Some(catch_unwind(AssertUnwindSafe(take)));
        });
        let time = begun.elapsed();
        *self.begun.lock().unwrap() = None;
        match end {
            Some(Ok(Ok(()))) => tally.taken += 1,
            Some(Ok(Err(error))) => judge(&error)?,
            _ => return Err("panicked".to_owned()),
        }
        Ok((time, memory.bytes_max))
    }
}

/// Refusals are one short line that a terminal can print, and say that it is
/// the input which has to be mended.
fn judge(error: &Error) -> Result<(), String> {
    let text = error.to_string();
    if !error.is_input() {
        return Err(format!("refused as no fault of the input: {text}"));
    }
    let turns = |c: char| {
        matches!(
            c,
            '\u{200e}' | '\u{200f}' | '\u{202a}'
                ..='\u{202e}' | '\u{2028}' | '\u{2029}'
        )
    };
    if text.contains(|c: char| c.is_control() || turns(c)) {
        return Err(format!("refused with control characters: {text:?}"));
    }
    match text.len() <= LONGEST_MESSAGE {
        true => Ok(()),
        false => Err(format!("refused in {} bytes", text.len())),
    }
}

/// Ends the process where an input has no end.
fn watch(begun: std::sync::Weak<Mutex<Option<Instant>>>, folder: PathBuf) {
    thread::spawn(move || {
        while let Some(begun) = begun.upgrade() {
            let since = *begun.lock().unwrap();
            if since.is_some_and(|since| since.elapsed() > ENDLESS) {
                super::parsers::say(&format!(
                    "an input has no end: {}\n",
                    folder.join("input").display()
                ));
                std::process::abort();
            }
            drop(begun);
            thread::sleep(Duration::from_millis(500));
        }
    });
}
